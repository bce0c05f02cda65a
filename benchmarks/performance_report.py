"""docs/performance.md and its pictures from the numbers that performance.py measured."""

from pathlib import Path

from contest.report import figure, markdown, ratio_rows, work_precision
from whirlmap.plot.common.save import save

HEAD = """# Performance

Made by `python benchmarks/performance.py --json performance.json`; `--from performance.json` writes this page and its
pictures again from the numbers. The table of ratios and the first picture are those of `whirlmap bench`.

{machine}

How it is measured. Operating points: the gear pair (`gear-psfd/reference`) at 512 speed ratios from 0.3 to 4 (64 for SciPy
and on the other problems), from the static equilibrium (beside the clearance centre where none is found). An error is the
largest difference over all states after 8T from the end states of heyoka at a tolerance of 1e-15; median and worst are
over the speeds. An orbit that comes closer than 0.02 c to a bearing's centre, where the fixed half film is not smooth, is
reported apart. Times are processor times of one thread, without compilation, the shortest of several turns that all
contenders take in one run. A ratio is the peer's time over whirlmap's at equal median error, interpolated in log-log,
best method and batch of each side; above 1 whirlmap is faster. Nothing is extrapolated to smaller errors than were
measured; at larger ones the cheapest setting counts. "Steps by accuracy" is what every command does: each point's own
steps per T, chosen before the clock starts (two or three common periods, once for about a hundred
of transient and record).

Other processors. Numbers on this page are those of one machine. On an AMD Zen 4, with reciprocals and roots by estimates,
heyoka took 1.7 times our time at 1e-7 and plain C with RK4 0.98 times. Plain films divide there now, 3 to 6 % faster
(`kernels/running/root_choice.py`); the peers were not timed again.

What the peers are given:

- **heyoka**: batches of 1, 4 and 8 points of similar speed; parameters hoisted into `par`, integer powers as products, the
  film factored into the fewest products. The forcing as cosines and sines of its time, or as two more states for each
  harmonic: within 15 % of each other, neither always the faster. Its compact mode took two to three times as long,
  `force_avx512` made no difference. For psi = 1e-3 the mobilities are fitted in e^2 over the range that the orbits visit:
  Chebyshev polynomials (degree 4 to 10) for loose tolerances, quotients with one denominator (6/5 to 12/10) for tight ones,
  with an error of at most 0.3 of the tolerance against the film's quadrature. The fit is the cheapest that is accurate
  enough; polynomials at tight tolerances took a tenth longer. The closed form (complex roots and logarithms) and the rule
  with 24 to 48 constant nodes take hundreds of products where a fit takes 3 to 15, and were not timed. The film of the
  reference is a polynomial whose error is 3e-14.
- **SciPy**: `solve_ivp`, rtol = atol, with the Numba function of the lines that whirlmap's kernels are generated from.
- **Plain C**: RK4 of the same lines, `gcc -O3 -march=native -ffast-math`, 1, 8 and 32 points side by side, forcing from the
  same tables; held against whirlmap's RK4, whatever other methods there are.
- **JiTCODE** (DOP853) with shared terms and hoisted parameters; **pynamicalsys** with SciPy's Numba function.
"""


def write(result, docs: Path):
    """Write performance.md and performance*.svg into the folder of the documentation."""
    text = [HEAD.format(machine=_machine(result["machine"], result["methods"]))]
    if result.get("quick"):
        text.append(f"Taken with `--quick`, fewer settings and turns: {', '.join(result['quick'])}.\n")
    if "short" in result:
        save(figure(result["short"]), docs / "performance.svg")
        head = ["| peer | problem | median error | its time / ours |", "|---|---|---|---|"]
        text += ["## Ratios", "", *head, *(f"| {' | '.join(row)} |" for row in ratio_rows(result["short"])), ""]
        text += [f"{name}: {why}.\n" for name, why in result["short"]["missing"].items()]
        text += ["![Error against time on the gear pair](performance.svg)", ""]
    for part, title, function in (
        ("work_precision", "Other problems and peers", _problems),
        ("lanes", "Points", _lanes),
        ("cores", "Cores", _cores),
        ("memory", "Memory", _memory),
        ("labelled", "Labelled points", _labelled),
        ("settling", "Steady-state search", _settling),
        ("diagram", "A diagram against SciPy", _diagram),
    ):
        if part in result:
            text += [f"## {title}", "", *function(result[part], docs), ""]
    if "short" in result:
        table = markdown(result["short"]).split("\n\n")[-1]
        text += ["## All rows of the short comparison", "", table]
    (docs / "performance.md").write_text("\n".join(text).rstrip() + "\n", encoding="utf-8")


def _machine(machine, methods):
    packages = ", ".join(f"{k} {v}" for k, v in machine.items() if k not in {"cores", "vectors", "python"})
    return (
        f"Machine: {machine['cores']} cores of an x86-64 server with {machine['vectors']}; Python {machine['python']},"
        f" {packages}. Methods of whirlmap: {', '.join(methods)}."
    )


def _problems(part, docs):
    names = list(dict.fromkeys(row["problem"] for row in part["rows"]))
    panels = [(name, [row for row in part["rows"] if row["problem"] == name]) for name in names]
    save(work_precision(panels), docs / "performance-problems.svg")
    centre = [r for r in part["rows"] if r["centre"] is not None]
    return [
        "![Error against time on four problems](performance-problems.svg)",
        "",
        *(f"{name}: {why}.\n" for name, why in part["missing"].items()),
        f"Worst error of orbits through a bearing's centre: {max(r['centre'] for r in centre):.1e}." if centre
        else "No orbit passed a bearing's centre within 8T.",
    ]  # fmt: skip


def _lanes(part, _):
    rows = [f"| {r['points']} | {r['us_per_point_and_T']:.2f} |" for r in part]
    return ["One core, RK4 with 100 steps per T, wall time.", "", "| points | us per point and T |", "|---|---|", *rows]


def _cores(part, _):
    return ["| threads | times as fast as one |", "|---|---|", *(f"| {r['workers']} | {r['speed_up']:.2f} |" for r in part)]


def _memory(part, _):
    rows = [f"| {r['points']} | {r['transient']} | {r['MB']:.0f} |" for r in part]
    head = ["| points | common periods of transient | largest resident memory [MB] |", "|---|---|---|"]
    what = "A bifurcation diagram with 8 recorded T, in a process of its own; Python and its packages are in it."
    return [what, "", *head, *rows]


def _labelled(part, _):
    regimes = ", ".join(f"{n} x {name}" for name, n in part["regimes"].items())
    time = f"{part['ms_per_point']:.1f} ms of wall time per labelled point"
    return [f"{time}, {part['points']} speeds, all cores ({regimes})."]


def _settling(part, _):
    return [
        f"{part['points']} speeds of `gear-psfd/reference` take {part['ratio']:.2f} of the processor time of a fixed"
        f" transient of {part['fixed']} common periods: {part['waited']:.1f} of them on average. That includes the"
        f" extrapolation attempts of {part['accelerated']} points and the check of their multipliers. {part['same']} returns"
        " equal those without acceleration."
    ]


def _diagram(part, _):
    ours = part["whirlmap"]
    lines = [
        f"{part['points']} points x {part['periods']}T on {part['cores']} cores at a median error of 1e-7, wall times:"
        f" whirlmap with an accuracy of {ours['accuracy']:.0e} {ours['seconds']:.3f} s, and {ours['choosing']:.3f} s to"
        " choose the steps, once.", "",
        "| SciPy, two processes | tolerance | seconds | its time / ours |", "|---|---|---|---|",
    ]  # fmt: skip
    for name in ("DOP853", "LSODA"):
        r = part[name]
        lines.append(f"| {name} | {r['tolerance']:.0e} | {r['seconds']:.1f} | {r['ratio']:.0f} |")
    return lines
