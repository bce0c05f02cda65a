"""A machine whose names say nothing, as docs/your_own_model.md declares it: its roles give what a stock machine has."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from typer.testing import CliRunner

import whirlmap
from whirlmap.assumptions.violations import violations
from whirlmap.cli.main import app
from whirlmap.errors import CaseError, RangeError
from whirlmap.plot.common.diagnosis_parts import journal_of
from whirlmap.plot.common.labels import axis_label, velocity_of

PAGE = (Path(__file__).parents[2] / "docs" / "your_own_model.md").read_text(encoding="utf-8")
SECTION = PAGE[PAGE.index("## Roles") : PAGE.index("## What expressions may hold")]
#: What the declaration of a role looks like, for a model without any.
ROLES = r', role="(eccentricity|load)", bearing="\w+"|^    (bodies|speed|journals|unbalances)=.*\n'


def block(language):
    (found,) = re.findall(rf"^```{language}\n(.*?)^```", SECTION, re.MULTILINE | re.DOTALL)
    return found


def written(folder, model):
    (folder / "spool.py").write_text(model, encoding="utf-8")
    (folder / "spool.toml").write_text(block("toml"), encoding="utf-8")
    return str(folder / "spool.toml")


@pytest.fixture(scope="module")
def case(tmp_path_factory):
    return written(tmp_path_factory.mktemp("spool"), block("python"))


@pytest.fixture(scope="module")
def plain(tmp_path_factory):
    """The same equations without a role."""
    return written(tmp_path_factory.mktemp("plain"), re.sub(ROLES, "", block("python"), flags=re.MULTILINE))


@pytest.fixture(scope="module")
def system(case):
    return whirlmap.load(case)


@pytest.fixture(scope="module")
def motion(system):
    return whirlmap.simulate(system, periods=40, transient=60, every=1)


def run(*words, error=0):
    result = CliRunner(env={"COLUMNS": "200", "NO_COLOR": "1"}).invoke(app, list(words))
    assert result.exit_code == error, (result.output, result.exception)
    return result


def answer(*words):
    return json.loads(run(*words, "--json").stdout)


def test_modes_are_named_by_their_bodies_and_whirl_both_ways(system):
    ds = whirlmap.campbell(system, "spin", [0.8, 1.0, 1.2])
    names = set(ds["mode_name"].values.tolist())
    assert names == {"axle overdamped", "spool forward", "spool backward"}
    assert set(ds["whirl"].values[ds["frequency"].values > 0].tolist()) == {1, -1}
    # frequencies are over the speed at which spin = 1: the shaft's own line is spin itself
    np.testing.assert_array_equal(ds["line"].sel(clock="shaft"), ds["spin"])
    assert whirlmap.in_units(system, ds)["spin"].attrs["units"] == "rpm"


def test_unbalance_whirls_forward_in_the_full_spectrum_of_each_body(motion):
    for x, y in json.loads(motion.attrs["roles"])["bodies"].values():
        pair = (motion["x"].sel(state=name).values[:-1] for name in (x, y))
        per_turn = (motion.sizes["time"] - 1) / 40
        ds = whirlmap.full_spectrum(*pair, rate=per_turn)
        at = np.abs(ds["whirl_frequency"].values - 1) < 0.01
        assert ds["forward"].values[at].max() > 3 * ds["backward"].values[at].max() > 0


def test_films_and_loads_are_those_of_the_declared_outputs(system, motion):
    """Of each bearing, in its declared order: extremes of the outputs, which the recorded motion shows too."""
    ds = whirlmap.bifurcation_diagram(system, "spin", [float(system.values["spin"]), 1.5], lyapunov=0)
    assert ds["bearing"].values.tolist() == ["axle", "spool"]
    for bearing, thick, load in (("axle", "off_centre", "push"), ("spool", "pressed", "grip")):
        one = ds.sel(bearing=bearing)
        largest = ds["maximum"].sel(quantity=[thick, load]).squeeze()
        np.testing.assert_array_equal(one["max_eccentricity"].squeeze(), largest.sel(quantity=thick))
        np.testing.assert_array_equal(one["min_film"].squeeze(), 1 - largest.sel(quantity=thick))
        np.testing.assert_array_equal(one["max_load"].squeeze(), largest.sel(quantity=load))
        record = motion["outputs"].sel(output=thick).values
        assert one["max_eccentricity"].squeeze().values[0] == pytest.approx(record.max(), rel=1e-2)
    shown = whirlmap.in_units(system, ds)
    assert (shown["min_film"].attrs["units"], shown["max_load"].attrs["units"]) == ("um", "N")
    np.testing.assert_allclose(shown["min_film"], 100 * ds["min_film"])


def test_pictures_know_the_journal_the_velocities_and_the_symbol(motion, system):
    assert journal_of(motion) == ("axle_x", "axle_y")
    assert velocity_of(motion, "spool_x") == "spool_dx"
    ds = whirlmap.bifurcation_diagram(system, "spin", [1.0, 1.1], lyapunov=0)
    assert axis_label(ds, "spin") == r"$\Omega$ [–]"
    assert axis_label(motion, "axle_x").startswith(r"$\mathrm{axle}_{x}$")  # no symbol is declared


def test_assumptions_of_its_journals_and_its_unbalance_are_judged(system):
    heavy = {s.name: s for s in violations(system.replace(b=1.5, oil=0.02))}
    assert heavy["unbalance_b"].sentence.startswith("The centre of mass of the spool is 1.5 clearances")
    assert heavy["rest_eccentricity_axle"].sentence.startswith("Journal axle rests")
    fast = {s.name: s for s in violations(system.at_speed(3.0))}
    assert fast["speed_max"].value == pytest.approx(3.0 * np.sqrt(9.81 / 1e-4), rel=1e-12)


def test_speeds_in_rpm_and_um_from_the_command_line(case):
    facts = answer("speeds", case, "--points", "4", "--no-follow", "--quiet")
    assert facts["speed"] == "spin" and facts["limit"] == pytest.approx(1.2)
    assert facts["rpm"][0] == pytest.approx(1500) and facts["rpm"][-1] == pytest.approx(6000)
    assert facts["operation"]["rpm"] == pytest.approx(3000)
    assert list(facts["min_film"]) == ["axle", "spool"] == list(facts["max_load"])
    assert facts["windows"][0]["min_film_um"] == pytest.approx(100 * facts["windows"][0]["min_film"])
    text = run("speeds", case, "--points", "2", "--no-follow", "--quiet", "--limit", "5 um").stdout
    assert "speed [rpm]" in text and "spin" in text


def test_diagnose_modes_and_pictures_from_the_command_line(case, tmp_path):
    facts = answer("diagnose", case, "--quiet", "--max-periods", "40", "--out", str(tmp_path / "sheet.svg"))
    assert (facts["regime"], facts["period"]) == ("periodic", 1)
    assert list(facts["max_eccentricity"]) == ["off_centre", "pressed"] == list(facts["min_film"])
    assert 'id="clearance"' in (tmp_path / "sheet.svg").read_text(encoding="utf-8")
    modes = answer("campbell", case, "--vary", "drive=1500 rpm:4500 rpm:4")
    assert {"spool forward", "spool backward"} <= set(modes["modes"]) and modes["varied"] == "spin"
    assert modes["dimensional"]["values"][0] == pytest.approx(1500)
    assert {mode["whirl"] for mode in answer("linear", case)["eigenvalues"]} == {"forward", "backward", "none"}
    refused = run("campbell", case, "--vary", "drive=1500 rpm:4500 rpm:4", "--set", "spin=1", error=2)
    assert "drive" in refused.stderr or "spin" in refused.stderr
    assert 'as in "drive=500 rpm' in run("campbell", case, "--vary", "drive=1:2:4", error=2).stderr


def test_the_same_model_without_roles_runs_and_says_what_is_missing(plain, system):
    bare = whirlmap.load(plain)
    x = np.linspace(0.1, 0.2, len(bare.states))
    np.testing.assert_array_equal(bare.rhs(0.3, x), system.rhs(0.3, x))
    assert set(bare.model.not_declared()) == {"speed", "bodies", "journals", "eccentricity", "load"}
    assert system.model.not_declared() == {}
    said = run("show", plain).stdout
    assert "not declared: speed (no safe speeds), bodies (no names" in " ".join(said.split())
    assert "declares no bodies: no names and no sense of whirl" in run("linear", plain).stderr
    assert "not declared" not in run("show", str(Path(system.case))).stdout
    ds = whirlmap.bifurcation_diagram(bare, "spin", [1.0, 1.1], lyapunov=0)
    assert "min_film" not in ds and "max_load" not in ds
    with pytest.raises(RangeError, match="spool declares no speed"):
        whirlmap.safe_speeds(bare, [1.0, 2.0], 1.0)
    with pytest.raises(CaseError, match="declares none: expected an output with"):
        violations(bare)


def test_roles_are_no_part_of_what_a_model_is(plain, system):
    """Neither what is computed nor the hash by which results and kernels are found again depends on them."""
    from whirlmap.equations.identity import model_digest

    assert model_digest(whirlmap.load(plain).model) == model_digest(system.model)
