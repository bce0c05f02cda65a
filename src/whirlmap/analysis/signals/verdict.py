"""The regime of a signal from the votes of its indicators, and the sentences that state it."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from whirlmap.results.regime import Regime

#: Share of the power in slow drift from which it is named as the reason that nothing is said.
DRIFT = 0.01
#: Power outside of lines up to which the 0-1 test has no say: there is no room for chaos in it.
CLEAN = 1e-3
#: Factor by which the rms of the middle third is beyond both others where the level turns.
TURNS = 1.1


def decide(votes: Mapping[str, Any]) -> tuple[Regime, float]:
    """Combine the votes; one against, and it is undecided. Returns the regime and the share of votes for it."""
    if votes["steadiness"]["changes"]:
        return Regime.not_steady, 1.0
    wanders = votes["zero_one"]["vote"]
    lines, broad = votes["spectrum"]["vote"], votes["spectrum"]["broadband_fraction"]
    grows = [votes.get(name, {}).get("vote") for name in ("rosenstein", "kantz")]
    structure = [*(g == "positive" for g in grows), votes.get("dimension", {}).get("vote") == "ok"]
    if wanders == "chaotic" and any(structure[:2]) and sum(structure) >= 2 and lines not in ("periodic", "quasi-periodic"):
        speaks = [True, *structure, lines == "broadband"]
        return Regime.chaotic, sum(speaks) / len(speaks)
    if lines == "periodic":  # it was compared with itself a period later
        return Regime.periodic, (1 + (wanders != "chaotic")) / 2
    # On a torus whole neighbourhoods shear apart for a while, so that Kantz's curve alone is no veto.
    if lines == "quasi-periodic" and (broad < CLEAN or (wanders != "chaotic" and grows[0] != "positive")):
        speaks = [True, wanders == "regular", grows[1] != "positive"]
        return Regime.quasi_periodic, sum(speaks) / len(speaks)
    return Regime.undecided, 0.0


def reason(label: Regime, votes: Mapping[str, Any]) -> str:
    """Why a signal has no one regime, or is undecided, in some words; nothing for other regimes."""
    if label == Regime.not_steady:
        changes = [{"level": "rms"}.get(change, change) for change in votes["steadiness"]["changes"]]
        return f"{' and '.join(changes)} change{'s' if len(changes) == 1 else ''}"
    if label != Regime.undecided:
        return ""
    known = _reasons(votes)
    return known[0][0] if known else "the indicators do not agree"


def sentences(label: Regime, votes: Mapping[str, Any], *, rate: float, unit: str, period: float | None, thinned: int) -> str:
    """Say in plain words what the signal is, and why."""
    spectrum, zero_one, steady = votes["spectrum"], votes["zero_one"], votes["steadiness"]
    share = 100 * (1 - spectrum["broadband_fraction"])
    per = f"per {unit}" if unit != "1" else "per unit of time"
    said = {
        Regime.chaotic: "The signal is chaotic.",
        Regime.periodic: "The signal is periodic.",
        Regime.quasi_periodic: "The signal is quasi-periodic.",
        Regime.undecided: "The indicators do not agree on what the signal is.",
        Regime.not_steady: "The motion changes within the record, so that it has no one regime.",
    }[label]
    text = [said, *_changes(steady, per)]
    if period is not None and label == Regime.periodic:
        lasts = f"{period / rate:.7g}" + (f" {unit}" if unit != "1" else "")
        text.append(
            f"It returns after {period:.7g} samples, {lasts}, with a distance of"
            f" {votes['return']['distance']:.2g} (0: exactly, 1: not at all)."
        )
    count = spectrum["lines"]
    many = f"{count} spectral line{' holds' if count == 1 else 's hold'} {share:.4g} % of its power."
    text.append(many if count else "No spectral line stands out of the rest.")
    if label == Regime.undecided:
        text += [sentence for _, sentence in _reasons(votes)]
    if zero_one["value"] is not None and label != Regime.not_steady:
        text.append(f"The 0-1 test gives {zero_one['value']:.2f} (0 regular, 1 chaotic).")
    if votes["neighbours"]["vote"] == "no-dimension":
        text.append("No embedding dimension up to 8 unfolds it: noise, or motion of many dimensions.")
    if thinned > 1 and "dimension" in votes:
        text.append(f"Every {thinned}th sample, after a filter, serves for exponents and dimension.")
    for name in ("rosenstein", "kantz"):
        v = votes.get(name)
        if v and v["vote"] not in ("neighbours-coincide", "not-steady", "lines-hold-all"):
            text.append(
                f"The exponent after {name.capitalize()} is {v['value']:.3g} +- {v['error']:.2g} {per}."
                if v["value"] is not None
                else f"After {name.capitalize()} neighbours do not diverge exponentially ({v['vote']})."
            )
    d = votes.get("dimension")
    if d:
        has = d["value"] is not None
        text.append(f"D2 is {d['value']:.3g} +- {d['error']:.2g}." if has else f"It has no dimension ({d['vote']}).")
    return " ".join(text)


def _changes(steady: Mapping[str, Any], per: str) -> list[str]:
    rms, frequency, mean = (steady[key] for key in ("rms", "frequency", "mean"))
    of = (
        "The frequency of its strongest line"
        if steady["frequency_of"] == "strongest line"
        else "The mean frequency of its whole spectrum, noise included,"
    )
    words = {
        "level": f"Its rms in the three thirds is {rms[0]:.4g}, {rms[1]:.4g}, {rms[2]:.4g}"
        + _course(rms),
        "frequency": f"{of} in the three thirds is {frequency[0]:.6g}, {frequency[1]:.6g}, {frequency[2]:.6g} "
        f"{per}.",
        "mean": f"Its mean drifts: {mean[0]:.4g}, {mean[1]:.4g}, {mean[2]:.4g} in the three thirds.",
    }
    return [words[change] for change in steady["changes"]]


def _course(rms: list[float]) -> str:
    """How the rms of the thirds goes, where the middle one may be the largest or the smallest."""
    first, middle, last = rms
    if middle > TURNS * max(first, last):
        return ": it rises, then falls."
    if TURNS * middle < min(first, last):
        return ": it falls, then rises."
    if min(first, last) <= 0:
        return "."
    return f": it {'grows' if last > first else 'falls'} by a factor of {max(first, last) / min(first, last):.3g}."


def _reasons(votes: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Why a signal is undecided that might be regular: in some words, and as a sentence."""
    spectrum, grid = votes["spectrum"], votes["grid"]["vote"]
    out = []
    if spectrum["slow_fraction"] > DRIFT:
        held = f"{100 * spectrum['slow_fraction']:.3g} % of the power"
        out.append(("slow drift", f"Slow drift holds {held}: remove it, or judge a shorter part."))
    elif 0.02 < spectrum["broadband_fraction"] < 0.5:
        decibel = 10 * np.log10((1 - spectrum["broadband_fraction"]) / spectrum["broadband_fraction"])
        out.append(
            (
                f"lines {decibel:.3g} dB above the rest, 17 needed",
                f"The lines are {decibel:.3g} dB above the rest: the labels periodic and quasi-periodic need 17 dB.",
            )
        )
    if grid == "chance":
        out.append(
            (
                "too short: any lines might fit a common fundamental",
                "The lines fit a common fundamental that any lines might fit by chance in a record of this length.",
            )
        )
    elif grid == "none" and spectrum["vote"] == "none":
        out.append(
            ("too short: two lines too close", "Two lines lie so close that the record holds too few of their beats.")
        )
    elif grid == "grid" and spectrum["vote"] == "none":
        out.append(
            (
                "does not return after the period of its lines",
                "The lines have a common fundamental, but the signal does not return after its period"
                f" (distance {votes['return']['distance']:.2g}).",
            )
        )
    return out
