"""A power says a torque at a speed of the reference shaft: which one is shown, and another shaft's speed is noticed."""

import pytest
from tests.machines.wrong_machines import BY_COEFFICIENTS, GOOD

import whirlmap
from whirlmap.assumptions.violations import repeated
from whirlmap.cli.common.machine_parts import transmitted

#: 20 N m at 9000 rpm of the pinion, which drives; the gear turns at 4390 rpm.
BY_POWER = GOOD.replace('T = "20 N*m"', 'P = "18849.555921538759 W"').replace(
    'speed = "9000 rpm"', 'speed = "9000 rpm"\nspeed_min = "5000 rpm"\nspeed_max = "9000 rpm"'
)


@pytest.fixture
def file(tmp_path):
    made = tmp_path / "machine.toml"
    made.write_text(BY_POWER, encoding="utf-8")
    return made


def said(system):
    return [text for text in repeated([system]) if text.startswith("mesh.teeth.speed_P")]


def test_a_speed_of_another_shaft_is_noticed(file):
    assert not said(whirlmap.load(file)) and not said(whirlmap.load(file, **{"mesh.teeth.speed_P": "6000 rpm"}))
    (text,) = said(whirlmap.load(file, **{"mesh.teeth.speed_P": "4390 rpm"}))
    for words in ("mesh.teeth.P", "4390 rpm", "5000 to 9000 rpm", "not of another shaft", "2.05 times"):
        assert words in text


def test_the_speed_that_the_file_gives_counts_where_it_gives_no_range(tmp_path):
    made = tmp_path / "machine.toml"
    made.write_text(BY_POWER.replace('speed_min = "5000 rpm"\nspeed_max = "9000 rpm"\n', "").replace(
        'P = "', 'speed_P = "9000 rpm"\nP = "'), encoding="utf-8")  # fmt: skip
    assert not said(whirlmap.load(made)) and not said(whirlmap.load(made, speed="3000 rpm"))
    assert said(whirlmap.load(made, **{"mesh.teeth.speed_P": "4390 rpm"}))


def test_it_is_noticed_without_any_film(tmp_path):
    """Bearings by coefficients have no assumptions of films, yet the same power."""
    text, at = BY_POWER.replace("[lubricant]\n" + 'mu = "0.015 Pa*s"\n', ""), 0
    while (at := text.find("[[bearing]]", at)) >= 0:
        radius = text.index("R = ", at)
        end = text.index("\n", text.index("c = ", radius))
        text = text[:radius] + BY_COEFFICIENTS + 'k_xx = "1e8 N/m"\nk_yy = "1e8 N/m"' + text[end:]
        at = radius
    made = tmp_path / "machine.toml"
    made.write_text(text.replace("at = 0\nkind", 'at = "1 mm"\nkind'), encoding="utf-8")
    assert said(whirlmap.load(made, **{"mesh.teeth.speed_P": "4390 rpm"})) and not said(whirlmap.load(made))


@pytest.mark.parametrize(
    ("changes", "power", "rpm"),
    [
        ({}, 18849.555921538759, 9000),
        ({"mesh.teeth.speed_P": "4500 rpm"}, 18849.555921538759, 4500),
        ({"speed": "6000 rpm", "speed_max": "12000 rpm"}, 18849.555921538759, 9000),
        ({"mesh.teeth.T": "30 N*m"}, None, None),
    ],
)
def test_show_says_power_torque_and_the_speed_used(file, changes, power, rpm):
    """The power counts at the speed_max of the file that gives it, not at the speed of the case."""
    system = whirlmap.load(file, **changes)
    mesh = transmitted(system, system.machine.case.parts.machine.meshes[0])
    if power is None:
        assert mesh["torque"] == 30.0 and mesh["power"] is mesh["speed_of_power"] is None
        return
    assert mesh["power"] == pytest.approx(power)
    assert mesh["speed_of_power"] == pytest.approx(rpm * 0.10471975511965977)
    assert mesh["torque"] * mesh["speed_of_power"] == pytest.approx(power, rel=1e-12)
