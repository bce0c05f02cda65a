"""Branches against closed forms and independent values: folds, doublings, grazing, Neimark-Sacker and Hopf points."""

import numpy as np
import pytest
from tests.sweep.branches.exact_systems import cubic_rotor, forced_hopf, squeeze_film_rotor

import whirlmap
from whirlmap.sweep.branches.branch_dataset import events_of, word

#: Relative error of values and states, and absolute error of multipliers.
VALUE, MULTIPLIER = 1e-9, 1e-8


def found(ds, kind):
    """Values of the parameter, states and multipliers of all events of a kind, in their order along the branch."""
    events, name = events_of(ds), str(ds.attrs["varied"])
    mine = [k for k, code in enumerate(events["kind"].values) if word(ds, "event_kind", code) == kind]
    multipliers = np.exp(events["log_modulus"].values + 1j * events["argument"].values)
    return events[name].values[mine], events["section"].values[mine], multipliers[mine]


def kinds(ds):
    """Kinds of all events, in their order."""
    return [word(ds, "event_kind", code) for code in ds["event_kind"].values]


def ends(ds):
    """The two words of each branch."""
    return [[word(ds, "end", code) for code in row] for row in ds["end"].values]


# --- the dead zone: exact piecewise flow, contacts to 1e-15 (zeta 0.05, F_m 0.1) -------------------------------------


@pytest.fixture(scope="module")
def dead_zone():
    """Branches of the dead zone at two amplitudes, from the linear motion on."""
    systems = {F: whirlmap.load("gear_backlash", zeta=0.05, F_m=0.1, F_ah=F) for F in (0.05, 0.1)}
    return {F: whirlmap.continue_orbit(system, "Omega", (0.5, 1.6)) for F, system in systems.items()}


@pytest.mark.parametrize(
    ("F", "kind", "value", "state"),
    [
        (0.05, "grazing", 0.820631087712087, None),
        (0.05, "grazing", 1.407088466022592, None),
        (0.05, "fold", 0.708031618721831, (1.00324104757065, 0.24671568685793)),
        (0.10, "grazing", 0.708881205008336, None),
        (0.10, "fold", 0.585331569642582, (0.84374965337766, 0.30296608241885)),
        (0.10, "period-doubling", 1.226700634663138, (0.88600814914236, 0.03139059894929)),
    ],
)
def test_events_of_the_dead_zone(dead_zone, F, kind, value, state, validate):
    """Grazing orbits, folds with loss of contact, and the first doubling; multipliers multiply to exp(-2 zeta T)."""
    values, states, multipliers = found(dead_zone[F], kind)
    k = int(np.abs(values - value).argmin())
    validate(f"dead-zone gear, zeta 0.05, F {F:g}: Omega of the {kind}", values[k], value, tier="exact",
             source="exact piecewise flow, contacts to 1e-15", rel=VALUE)  # fmt: skip
    if state is not None:
        np.testing.assert_allclose(states[k], state, rtol=VALUE)
    assert multipliers[k].prod().real == pytest.approx(np.exp(-2 * 0.05 * 2 * np.pi / values[k]), abs=MULTIPLIER)
    assert multipliers[k].prod().imag == pytest.approx(0, abs=MULTIPLIER)
    critical = {"fold": 1.0, "period-doubling": -1.0}.get(kind)
    if critical is not None:
        assert np.abs(multipliers[k] - critical).min() < MULTIPLIER


def test_the_dead_zone_is_stable_but_between_its_folds(dead_zone):
    """The tongue's upper branch is stable, the middle one unstable; both ends lie at the ends of the range."""
    ds = dead_zone[0.05]
    assert ends(ds) == [["range", "range"]]
    assert kinds(ds) == ["grazing", "fold", "fold", "grazing"]
    folds = ds["event_after"].values[[1, 2]]
    middle = np.zeros(ds.sizes["point"], dtype=bool)
    middle[folds[0] + 1 : folds[1] + 1] = True
    np.testing.assert_array_equal(ds["stable"].values == 0, middle)
    assert "doubts" not in ds.attrs


def test_multipliers_keep_liouville(dead_zone, validate):
    """The sum of their logarithms is the mean divergence times the duration, at every point."""
    for F, ds in dead_zone.items():
        total = ds["log_modulus"].values.sum(axis=1)
        validate(f"dead-zone gear, F {F:g}, along its branch: sum of the logarithms of the multipliers", total,
                 -2 * 0.05 * 2 * np.pi / ds["Omega"].values, tier="invariant", source="Liouville", within=1e-9)


# --- smooth oscillators ----------------------------------------------------------------------------------------------


def test_folds_of_duffing_by_harmonic_balance(validate):
    """x'' + 0.05 x' + x + 0.1 x^3 = 0.18 cos(Omega t): from 7 to 11 harmonics the same to 1e-12."""
    system = whirlmap.load("duffing", delta=0.05, alpha=1, beta=0.1, gamma=0.18)
    ds = whirlmap.continue_orbit(system, "omega", (0.5, 2.0))
    validate("Duffing, delta 0.05, beta 0.1, gamma 0.18: omega of both folds", np.sort(found(ds, "fold")[0]),
             [1.115700251770920, 1.269601955545893], tier="independent", source="harmonic balance, 11 harmonics", rel=VALUE)
    assert kinds(ds) == ["fold", "fold"]


def test_folds_of_a_rotor_on_a_cubic_shaft(validate):
    """Circular orbits of the isotropic rotor: folds in closed form, amplitude included."""
    ds = whirlmap.continue_orbit(cubic_rotor(Omega=0.6), "Omega", (0.5, 2.0))
    values, states, _ = found(ds, "fold")
    order = np.argsort(values)
    says = {"tier": "exact", "source": "circular orbits in closed form"}
    validate("rotor on a cubic shaft: speeds of both folds", values[order], [1.154700538379252, 1.295061081428043],
             rel=VALUE, **says)  # fmt: skip
    radius = np.hypot(states[order, 0], states[order, 1])
    validate("rotor on a cubic shaft: amplitudes at both folds", radius, [1.154700538379252, 2.577673321654932],
             rel=VALUE, **says)  # fmt: skip


def test_jumps_of_a_squeeze_film_damper(validate):
    """Rigid rotor on a centred damper (short, pi film), B = 0.05, U = 0.2: jumps at both folds, eccentricity included."""
    near = (0.1107, -0.0082, 0.0049, 0.0664)
    ds = whirlmap.continue_orbit(squeeze_film_rotor(), "s", (0.5, 2.0), orbit=near, begin=0.6)
    values, states, _ = found(ds, "fold")
    order = np.argsort(values)
    says = {"tier": "exact", "source": "circular orbits in closed form"}
    validate("rigid rotor on a squeeze-film damper, B 0.05, U 0.2: speeds of both jumps", values[order],
             [1.3156616570355, 1.3840283363719], rel=VALUE, **says)  # fmt: skip
    radius = np.hypot(states[order, 0], states[order, 1])
    validate("rigid rotor on a squeeze-film damper, B 0.05, U 0.2: eccentricities at both jumps", radius,
             [0.62334391, 0.77733513], rel=1e-7, **says)  # fmt: skip


def test_above_an_unbalance_there_is_no_jump_down(validate):
    """At U = 0.3 there is one fold and no other above it: the rotor that has jumped up stays."""
    near = (0.166, -0.013, 0.008, 0.1)
    ds = whirlmap.continue_orbit(squeeze_film_rotor(U=0.3), "s", (0.6, 1.8), orbit=near, begin=0.6)
    assert len(found(ds, "fold")[0]) <= 1
    radius = np.hypot(ds["section"].values[:, 0, 0], ds["section"].values[:, 0, 1])
    s, k = ds["s"].values, 2 * 0.05 * ds["s"].values
    left = radius * (1 - s**2) + k * radius**2 / (1 - radius**2) ** 2
    right = np.pi * k * radius / (4 * (1 - radius**2) ** 1.5)
    validate("rigid rotor on a squeeze-film damper, U 0.3: balance of forces along the branch", left**2 + right**2,
             0.09 * s**4, tier="exact", source="circular orbits in closed form", rel=VALUE)  # fmt: skip


# --- Neimark-Sacker points, and curves in two parameters: the forced Hopf oscillator ---------------------------------


def test_neimark_sacker_point_and_multipliers_of_the_forced_hopf_oscillator(validate):
    """At rho = 1/2, g^2 = (d^2 + 1/4)/2; multipliers exp(lambda 2 pi/Omega) in closed form all along the branch."""
    ds = whirlmap.continue_orbit(forced_hopf(g=0.6, Omega=2.1), "Omega", (2.1, 4.0))
    assert kinds(ds) == ["neimark-sacker"]
    (value,), (state,), _ = found(ds, "neimark-sacker")
    says = {"tier": "exact", "source": "orbits of the normal form in closed form"}
    validate("forced Hopf oscillator, g 0.6: detuning of the Neimark-Sacker point", value - 2, np.sqrt(2 * 0.6**2 - 0.25),
             rel=VALUE, **says)  # fmt: skip
    assert state @ state == pytest.approx(0.5, rel=VALUE)
    d, rho = ds["Omega"].values - 2, (ds["section"].values[:, 0] ** 2).sum(axis=1)
    np.testing.assert_allclose(rho * ((1 - rho) ** 2 + d**2), 0.36, rtol=VALUE)
    root = np.sqrt((2 * rho - 1) ** 2 - (1 - 4 * rho + 3 * rho**2 + d**2) + 0j)
    truth = np.exp(np.stack([1 - 2 * rho + root, 1 - 2 * rho - root], axis=1) * (2 * np.pi / ds["Omega"].values)[:, None])
    ours = np.exp(ds["log_modulus"].values + 1j * ds["argument"].values)
    apart = [min(np.abs(a - b).max(), np.abs(a - b[::-1]).max()) for a, b in zip(ours, truth, strict=True)]
    validate("forced Hopf oscillator, along its branch: error of the multipliers", apart, 0, within=MULTIPLIER, **says)


def test_curve_of_neimark_sacker_points_ends_at_the_resonance_1_1(validate):
    """g^2 = (d^2 + 1/4)/2 from d = 1/2 on, where the pair of multipliers becomes one."""
    vary = {"Omega": (2.0, 4.0), "g": (0.3, 1.0)}
    ds = whirlmap.event_curve(forced_hopf(g=0.6), vary, "neimark-sacker", begin=2.1)
    d, g = ds["Omega"].values - 2, ds["g"].values
    validate("forced Hopf oscillator: squared forcing along the curve of Neimark-Sacker points", g**2, (d**2 + 0.25) / 2,
             tier="exact", source="orbits of the normal form in closed form", rel=VALUE)  # fmt: skip
    assert ends(ds)[0].count("closed") == 1
    first = kinds(ds).index("resonance-1-1")
    assert ds["event_Omega"].values[first] - 2 == pytest.approx(0.5, rel=VALUE)
    assert ds["event_g"].values[first] == pytest.approx(0.5, rel=VALUE)


def test_curve_of_folds_has_a_cusp_and_a_resonance(validate):
    """1 - 4 rho + 3 rho^2 + d^2 = 0; cusp d^2 = 1/3, g^2 = 8/27; 1:1 resonance d = g = 1/2."""
    z = 0.45 / (np.max(np.roots([1, -2, 1 + 0.05**2, -(0.45**2)]).real) - 1 + 0.05j)
    ds = whirlmap.event_curve(
        forced_hopf(g=0.45), {"Omega": (2.0, 3.0), "g": (0.3, 0.7)}, "fold", begin=2.05, orbit=(z.real, z.imag)
    )
    d, g, rho = ds["Omega"].values - 2, ds["g"].values, (ds["section"].values[:, 0] ** 2).sum(axis=1)
    np.testing.assert_allclose(1 - 4 * rho + 3 * rho**2, -(d**2), atol=VALUE)
    np.testing.assert_allclose(rho * ((1 - rho) ** 2 + d**2), g**2, rtol=VALUE)
    at = {kind: (ds["event_Omega"].values[k] - 2, ds["event_g"].values[k]) for k, kind in enumerate(kinds(ds))}
    says = {"tier": "exact", "source": "orbits of the normal form in closed form", "rel": VALUE}
    validate("forced Hopf oscillator: detuning and forcing at the cusp", at["cusp"],
             (np.sqrt(1 / 3), np.sqrt(8 / 27)), **says)  # fmt: skip
    validate("forced Hopf oscillator: detuning and forcing at the 1:1 resonance", at["resonance-1-1"], (0.5, 0.5), **says)


# --- doublings, cycles and equilibria --------------------------------------------------------------------------------


def test_doublings_of_the_double_well(validate):
    """Duffing, delta 0.3, omega 1.2: the first two doublings in gamma, each on the branch that doubled before."""
    ds = whirlmap.continue_orbit(whirlmap.load("duffing", delta=0.3, omega=1.2), "gamma", (0.2, 0.3), doublings=2)
    validate("Duffing, delta 0.3, omega 1.2: gamma of the first two period doublings", found(ds, "period-doubling")[0][:2],
             [0.265581786, 0.286693158], tier="independent", source="Newton's method on the stroboscopic map, other code",
             rel=2e-9)  # as many digits as are known
    assert ds["period_T"].values.tolist() == [1, 2, 4]
    assert ends(ds)[1][0] == ends(ds)[2][0] == "closed"


def test_roesslers_cycle_and_its_doubling(validate):
    """One-loop cycle at c = 5.7: T and multiplier (ChaosBook); its first doubling, and that of the doubled cycle."""
    system = whirlmap.load("roessler", a=0.2, b=0.2)
    ds = whirlmap.continue_orbit(system, "c", (2.6, 5.7), doublings=1)
    validate("Roessler a = b = 0.2: c of the first two period doublings", found(ds, "period-doubling")[0][:2],
             [2.83244502786, 3.83735816841], tier="independent", source="Newton's method, other code", rel=VALUE)
    at = np.flatnonzero((ds["branch_of"].values == 1) & (ds["c"].values == 5.7))[0]
    validate("Roessler, c 5.7: period of the one-loop cycle", ds["duration"].values[at], 5.88108845586, tier="published",
             source="ChaosBook", rel=VALUE)  # fmt: skip
    largest = np.exp(ds["log_modulus"].values[at, 0]) * np.cos(ds["argument"].values[at, 0])
    validate("Roessler, c 5.7: unstable multiplier of the one-loop cycle", largest, -2.403953527,
             tier="published", source="ChaosBook", within=MULTIPLIER)  # fmt: skip


def test_hopf_point_and_pitchfork_of_lorenz(validate):
    """rho = 470/19 with sigma 10 and beta 8/3; the branch of equilibria turns at rho = 1, where three of them meet."""
    system = whirlmap.load("lorenz")
    ds = whirlmap.continue_orbit(system, "rho", (0.5, 30.0), begin=14.0, orbit=(6, 6, 13))
    assert kinds(ds) == ["hopf", "branch-point", "hopf"]
    validate("Lorenz: rho of the Hopf points on the branch of equilibria", found(ds, "hopf")[0], 470 / 19, tier="exact",
             source="closed form", rel=VALUE)  # fmt: skip
    validate("Lorenz: rho of the pitchfork, seen from the other branch", found(ds, "branch-point")[0], 1, tier="exact",
             source="closed form", rel=1e-7)  # fmt: skip
    assert [word(ds, "kind", k) for k in ds["kind"].values] == ["equilibrium"]
    origin = whirlmap.continue_orbit(system, "rho", (0.5, 30.0), begin=14.0, orbit=(0, 0, 0))
    assert kinds(origin) == ["branch-point"]
    assert found(origin, "branch-point")[0][0] == pytest.approx(1, rel=VALUE)
