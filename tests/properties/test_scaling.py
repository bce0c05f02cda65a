"""Machines in any units, and of any size: the dimensionless groups know neither."""

import functools
from fractions import Fraction
from math import isclose

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from whirlmap.cases import names, read, resolve
from whirlmap.cases.entries import Given
from whirlmap.units import _root, factor

#: Every machine with dimensions, with as much of the physics as its numbers allow.
MACHINES = {
    "gear-psfd/machine": {},
    "machines/turbo-gearbox": {"stiffness": "rectangular", "backlash": "dead_zone"},
    "machines/jeffcott-rig": {},
    "machines/aero-damper": {},
}

#: Machines from parts: the elements of their shafts are no inputs, and would keep their size. They are not tested here.
FROM_PARTS = {
    "machines/two-shaft-gearbox", "machines/flexible-on-dampers", "machines/geared-turbo-set",
    "machines/integrally-geared-compressor",
}  # fmt: skip

UNITS = {
    "kg": ["g", "lb", "t", "mg"], "m": ["mm", "um", "in", "mil", "nm"], "m^2": ["mm^2", "um^2", "darcy"],
    "N/m": ["N/um", "kN/mm", "lbf/in"], "N/m^3": ["N/um^3", "kN/mm^3"], "N*s/m": ["kN*s/m", "N*s/mm", "lbf*s/in"],
    "Pa*s": ["mPa*s", "cP", "P"], "m/s^2": ["cm/s^2", "ft/s^2"], "rad/s": ["rpm", "turn/s", "deg/s"],
    "rad": ["deg", "turn"], "N*m": ["N*mm", "lbf*in"], "W": ["kW", "MW"], "kg*m^2": ["g*mm^2", "lb*in^2"],
    "N*m/rad": ["N*m/deg", "kN*m/rad"], "N*m*s/rad": ["N*mm*s/rad"], "kg*m": ["g*mm", "kg*mm"], "m/s": ["mm/s", "in/s"],
    "m^2/s": ["mm^2/s", "cSt"], "kg/m^3": ["g/cm^3", "lb/ft^3"], "degC": ["K", "degF"], "1": ["%"],
}  # fmt: skip


@functools.cache
def machine(name):
    return resolve(read(name), MACHINES[name])


def rewritten(value, unit, other):
    """The exact number in another unit."""
    if other == "K":
        return value + Fraction("273.15")
    if other == "degF":
        return value * Fraction(9, 5) + 32
    return value / factor(other, unit)


def given_in(name, units):
    """Inputs as the case gives them, written in the chosen units."""
    case = read(name)
    changes = dict(MACHINES[name])
    for symbol, here in case.given.items():
        parameter = case.family.groups.input(symbol)
        if parameter is None or parameter.order:
            continue
        from whirlmap.units import read as number

        exact = number(here.value, parameter.unit, given=here.unit)
        unit = units(parameter.unit)
        changes[symbol] = Given(symbol, rewritten(exact, parameter.unit, unit) if unit != parameter.unit else exact, unit)
    return resolve(case, changes)


def close(one, other, relative=1e-13):
    assert one.values.keys() == other.values.keys()
    for name, value in one.values.items():
        assert isclose(float(value), float(other.values[name]), rel_tol=relative, abs_tol=0.0), name


@pytest.mark.parametrize("name", MACHINES)
@settings(max_examples=8, deadline=None)
@given(data=st.data())
def test_the_same_machine_in_other_units_has_the_same_groups(name, data):
    close(machine(name), given_in(name, lambda unit: data.draw(st.sampled_from([unit, *UNITS[unit]]))))


def powers(unit):
    """Exponents of mass, length and time in a unit."""
    _, bases = _root(unit, unit)
    return [int(bases.get(base, 0)) for base in ("gram", "meter", "second")]


#: Inputs that mean something in absolute terms: an oil's grade knows its own unit.
ABSOLUTE = {"VG", "VI", "T_oil", "nu_40", "nu_100", "rho"}

scale = st.fractions(min_value=Fraction(1, 50), max_value=50, max_denominator=1000)


@pytest.mark.parametrize("name", MACHINES)
@settings(max_examples=8, deadline=None)
@given(mass=scale, length=scale, time=scale)
def test_groups_do_not_depend_on_the_size_of_the_machine(name, mass, length, time):
    """Mass, length and time scaled alike in every input, viscosity among them: all groups stay."""
    before = machine(name)
    changes = dict(MACHINES[name])
    for symbol, here in before.inputs.items():
        key = symbol.rpartition(".")[2]  # of a part: lubricant.T_oil
        if here.parameter.order or key in ABSOLUTE or (here.note.startswith("follows") and key != "mu"):
            continue
        m, l, t = powers(here.parameter.unit)
        exact = Fraction(here.value) if key == "mu" else number_of(before, symbol)
        changes[symbol] = Given(symbol, exact * mass**m * length**l * time**t, here.parameter.unit)
    # angles count in radians: rad/s scales as 1/s
    close(before, resolve(read(name), changes), relative=1e-12 if {"mu", "lubricant.mu"} & set(changes) else 1e-13)


def number_of(settled, symbol):
    from whirlmap.units import read as number

    here = settled.case.given[symbol]
    return number(here.value, settled.inputs[symbol].parameter.unit, given=here.unit)


def test_every_stock_machine_is_tested_here():
    """The editions of the paper's system write groups on top of the machine's inputs."""
    stock = {n for n in names() if resolve(read(n)).inputs}
    assert {n for n in stock if n == "gear-psfd/machine" or not n.startswith("gear-psfd/")} == {*MACHINES, *FROM_PARTS}


def test_provenance_hashes_what_is_written(tmp_path):
    """Equal numbers in other units: equal groups, other text, other digest; equal text, equal digest."""
    from whirlmap.integrate.loading import load, pieces

    texts = ['value = 50, unit = "um"', 'value = 0.05, unit = "mm"', 'value = 50, unit = "um"']
    systems = []
    for i, text in enumerate(texts):
        file = tmp_path / f"{i}.toml"
        file.write_text(f'extends = "gear-psfd/machine"\n[bearings]\nc = {{ {text}, assumed = "test" }}\n')
        systems.append(load(file))
    digests = [pieces(s).case_hash for s in systems]
    assert systems[0].values == systems[1].values
    assert digests[0] == digests[2] != digests[1]
