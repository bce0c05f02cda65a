"""The result of a benchmark as tables and as a picture of error against time."""

from collections.abc import Sequence
from typing import Any

from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from contest.ratios import front
from contest.run import PSI, SCIPY_ERROR

#: Colours and markers of those who are drawn; whirlmap's methods take shades of one colour, in their order.
PEERS = {"heyoka": "tab:orange", "scipy": "tab:green", "c_reference": "tab:purple", "jitcode": "tab:red",
         "pynamicalsys": "tab:brown"}  # fmt: skip
OURS = ("#08306b", "#2171b5", "#6baed6", "#17becf", "#1f77b4", "#000000")


def ratio_rows(result: dict[str, Any]) -> list[tuple[str, str, str, str]]:
    """Rows of the table of ratios: peer, problem, median error, their time over ours."""
    rows = [
        ("heyoka, best batch", f"gear pair, {psi}", error, _ratio(found))
        for psi, errors in result["heyoka"].items()
        for error, found in errors.items()
    ]
    asked = f"{SCIPY_ERROR:.0e}".replace("e-0", "e-")
    rows += [(f"SciPy {m}, Numba right-hand side", "gear pair, psi=0", asked, _ratio(r)) for m, r in result["scipy"].items()]
    return [*rows, ("plain C, RK4 against RK4", "gear pair, psi=0", asked, _ratio(result["c_reference"]))]


def _ratio(found: float | None) -> str:
    return "-" if found is None else f"{found:.2f}" if found < 10 else f"{found:.0f}"


def markdown(result: dict[str, Any]) -> str:
    """Ratios, and the fronts of all curves, as Markdown tables."""
    head = ("| peer | problem | median error | its time / ours |", "|---|---|---|---|")
    lines = [*head, *(f"| {' | '.join(row)} |" for row in ratio_rows(result)), ""]
    lines += [f"{name}: {reason}.\n" for name, reason in result["missing"].items()]
    lines += ["| problem | who | batch | tolerance or steps per T | median error | worst error | us per lane and T |",
              "|---|---|---|---|---|---|---|"]  # fmt: skip
    for row in result["raw"]:
        errors = (_error(row["median_error"]), _error(row["worst_error"]))
        cells = (f"psi={row['psi']:g}", row["who"], str(row["batch"]), f"{row['tol_or_steps']:g}", *errors)
        lines.append(f"| {' | '.join(cells)} | {row['us_per_lane_and_T']:.2f} |")
    return "\n".join(lines) + "\n"


def _error(value: float | None) -> str:
    return "-" if value is None else f"{value:.1e}"


def figure(result: dict[str, Any]) -> Figure:
    """Median error after 8T against the time of one core per lane and T, one panel for each permeability."""
    return work_precision(
        [(f"gear pair, {name}", [row for row in result["raw"] if row["psi"] == psi]) for name, psi in PSI.items()]
    )


def work_precision(panels: Sequence[tuple[str, Sequence[dict[str, Any]]]]) -> Figure:
    """Work-precision diagrams, one panel for each title and its rows; of every name the best batch at each setting."""
    across = min(len(panels), 2)
    down = -(-len(panels) // across)
    made = Figure(figsize=(5 * across, 4.4 * down + 0.8), layout="constrained")
    axes = made.subplots(down, across, squeeze=False).ravel()
    names = sorted({row["who"] for _, rows in panels for row in rows})
    ours = [name for name in names if name.startswith("whirlmap")]
    for ax, (title, rows) in zip(axes, panels, strict=False):
        for name in (*ours, *(n for n in names if n not in ours)):
            best: dict[float, tuple[float, float]] = {}  # of each setting; batches of one setting differ in rounding alone
            for r in (r for r in rows if r["who"] == name and r["median_error"]):
                one = (r["median_error"], r["us_per_lane_and_T"])
                best[r["tol_or_steps"]] = min(one, best.get(r["tol_or_steps"], one), key=lambda p: p[1])
            if best:
                error, taken = zip(*front(best.values()), strict=True)
                ax.plot(taken, error, label=name, **_style(name, ours))
        ax.set(xscale="log", yscale="log", title=title, xlabel="processor time per lane and T [us]")
        ax.set_ylabel("median error after 8T")
        ax.xaxis.set_major_locator(LogLocator(subs=(1, 2, 5)))
        ax.xaxis.set_major_formatter("{x:g}")
        ax.xaxis.set_minor_formatter(NullFormatter())
        ax.tick_params(axis="x", labelsize="small", labelrotation=60)
        ax.grid(alpha=0.3)
    drawn = {line.get_label(): line for ax in axes for line in ax.lines}
    made.legend(drawn.values(), drawn.keys(), fontsize="small", loc="outside lower center", ncols=2 * across)
    return made


def _style(name: str, ours: Sequence[str]) -> dict[str, Any]:
    if name in ours:
        return {"color": OURS[ours.index(name) % len(OURS)], "marker": "o", "linewidth": 2}
    colour = next(c for peer, c in PEERS.items() if name.startswith(peer))
    second = "," in name or "LSODA" in name or "lsoda" in name or name.endswith("pynamicalsys rk4")
    return {"color": colour, "marker": "s", "markersize": 4, "linestyle": "--" if second else "-"}
