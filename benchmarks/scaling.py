"""What a map costs on one core and on many: measures, and writes the tables of docs/explanation/maps-on-disk.md.

    python benchmarks/scaling.py --json scaling.json      # measures, on a machine that does nothing else
    python benchmarks/scaling.py --from scaling.json --page docs/explanation/maps-on-disk.md  # writes its tables there
"""

import argparse
import json
import os
import platform
import resource
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import numpy as np

import whirlmap
from whirlmap.analysis.labels.labelling import measure as label
from whirlmap.integrate.division import cores
from whirlmap.integrate.ensemble import Ensemble
from whirlmap.options.computed import Labelling
from whirlmap.options.execution import Execution
from whirlmap.sweep.maps.regime_map import regime_map
from whirlmap.sweep.store.zarr_store import Store

#: The sweep that is timed: half of it below the onset of whirl, half of it above.
CASE, VARIED, FIRST, LAST, POINTS, CHUNK = "gear-psfd/machine", "s", 2.0, 4.0, 2048, 64
#: Lanes, periods and steps of the small benchmark that gives the time of one step of one lane.
LANES, PERIODS, STEPS = 256, 40, 16
#: How often each sweep is timed; the shortest counts, for other work on the machine only adds.
TIMES = 2
#: Marks in the page.
BEGIN, END = "<!-- begin measured -->", "<!-- end measured -->"


def system():
    return whirlmap.load(CASE)


def axis(points=POINTS):
    return {VARIED: np.linspace(FIRST, LAST, points)}


def timed(function, clock=time.perf_counter):
    begun = clock()
    out = function()
    return clock() - begun, out


def time_per_step():
    """Processor seconds of one step of one lane, without and with a tangent vector, in full blocks, one thread."""
    from whirlmap.analysis.motion.ensembles import make_ensemble

    out = {}
    for tangents in (0, 1):
        ensemble, _ = make_ensemble(system(), axis(LANES), steps=STEPS, tangents=tangents, workers=1)
        ensemble.advance(PERIODS)  # compiles, and leaves the start behind
        out[tangents] = min(timed(lambda e=ensemble: e.advance(PERIODS), time.process_time)[0] for _ in range(3))
        out[tangents] /= LANES * PERIODS * STEPS
    return {"plain": out[0], "tangent": out[1]}


def count_steps():
    """Steps of lanes that the sweep takes, by counting them as it runs in one thread, and its processor seconds."""
    counted, advance = {"plain": 0, "tangent": 0}, Ensemble.advance

    def counting(self, n_periods, *, members=None, **options):
        at = np.arange(self.points) if members is None else members
        at = at[self.running[at]]
        counted["tangent" if self.tangents else "plain"] += int(n_periods * self.point_steps[at].sum())
        return advance(self, n_periods, members=members, **options)

    labelling, alone = Labelling(lyapunov=256), Execution(workers=1)
    label(system(), {VARIED: np.array([FIRST, LAST])}, labelling, alone)
    Ensemble.advance = counting
    try:
        seconds, _ = timed(lambda: label(system(), axis(), labelling, alone), time.process_time)
    finally:
        Ensemble.advance = advance
    return {**counted, "seconds": seconds}


def sweep(place, **options):
    shutil.rmtree(place, ignore_errors=True)
    seconds, _ = timed(lambda: regime_map(system(), axis(), store=place, chunk=CHUNK, **options))
    return seconds


def throughput(folder):
    """Seconds of the sweep with threads and with Dask workers, in turn; all have loaded their kernels before."""
    from distributed import Client, LocalCluster

    out = {"threads": {}, "dask": {}}
    for n in sorted({1, cores()}):
        with LocalCluster(n_workers=n, threads_per_worker=1, dashboard_address=None) as cluster, Client(cluster) as client:
            kinds = {"threads": {"workers": n}, "dask": {"cluster": client}}
            sweep(folder / "map", cluster=client)
            rounds = [{kind: sweep(folder / "map", **options) for kind, options in kinds.items()} for _ in range(TIMES)]
            for kind in kinds:
                out[kind][n] = min(seconds[kind] for seconds in rounds)
            trivial, _ = timed(lambda c=client: c.gather(c.map(lambda k: k, range(1000))))
    out["tasks_per_second"] = 1000 / trivial
    return out


def storage(folder):
    """Bytes and files of a chunk, and the seconds that committing and checking one takes."""
    store = Store(folder / "map")
    files = [p for p in store.folder.rglob("*") if p.is_file() and p.name != "zarr.json"]
    data = {name: np.asarray(array[store.chunks.box(0)]) for name, array in store.arrays.items()}
    commit = min(timed(lambda: store.commit(0, data))[0] for _ in range(5))
    check = min(timed(lambda: store.checksum(0))[0] for _ in range(5))
    return {"bytes_per_point": sum(p.stat().st_size for p in files) / POINTS, "files_per_chunk": len(store.files(0)) + 1,
            "commit": commit, "check": check}  # fmt: skip


#: The peak is read from the process's own status: that of `getrusage` begins with the memory of the process that starts it.
MEMORY = """
import sys, tempfile
from pathlib import Path
import numpy as np, whirlmap
from whirlmap.analysis.steady.settling import Settling
with tempfile.TemporaryDirectory() as folder:
    whirlmap.regime_map(whirlmap.load("duffing"), {"gamma": np.linspace(0.2, 0.6, int(sys.argv[1]))}, workers=2,
                        store=Path(folder) / "map", chunk=256, settling=Settling(transient=20, most=8, keep=8), lyapunov=0)
print(next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM")) / 1024)
"""


def memory():
    """Peak memory [MB] of maps of Duffing's oscillator, by their number of points."""
    out = {}
    for points in (1_024, 16_384):
        out[points] = float(subprocess.run([sys.executable, "-c", MEMORY, str(points)], capture_output=True, text=True,
                                           check=True).stdout)  # fmt: skip
    return out


def measure():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        load = os.getloadavg()[0]
        steps, counted = time_per_step(), count_steps()
        out = {"machine": f"{platform.machine()}, {cores()} cores, Python {platform.python_version()}", "case": CASE,
               "points": POINTS, "chunk": CHUNK, "range": [FIRST, LAST], "load": load, "step": steps, "counted": counted,
               "throughput": throughput(folder), "storage": storage(folder), "memory": memory()}  # fmt: skip
    out["peak_here"] = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return out


def clock(seconds):
    for size, word in ((86400 * 365.25, "years"), (86400, "days"), (3600, "h"), (60, "min")):
        if seconds >= size:
            return f"{seconds / size:.3g} {word}"
    return f"{seconds:.3g} s"


def page(m):
    """The tables, in Markdown."""
    t, c, through, s = m["step"], m["counted"], m["throughput"], m["storage"]
    model = c["plain"] * t["plain"] + c["tangent"] * t["tangent"]
    each = through["threads"]["1"] / m["points"]
    first, last = m["range"]
    lines = [
        f"{m['machine']}; {m['case']}, {m['points']} points from s = {first:g} to {last:g} in chunks of {m['chunk']};"
        f" the shortest of {TIMES} runs; load average {m['load']:.2g} before it began.", "",
        "| executor | workers | s | points/s | efficiency |", "|---|---|---|---|---|",
    ]  # fmt: skip
    for kind in ("threads", "dask"):
        for n, seconds in through[kind].items():
            efficiency = through[kind]["1"] / seconds / int(n)
            lines.append(f"| {kind} | {n} | {seconds:.3g} | {m['points'] / seconds:.3g} | {efficiency:.3g} |")
    chunks = -(-m["points"] // m["chunk"])
    extra = (through["dask"]["1"] - through["threads"]["1"]) / chunks
    lines += ["", f"Dask costs {extra:.3g} s per chunk of {through['threads']['1'] / chunks:.3g} s, or"
              f" {100 * extra / (through['threads']['1'] / chunks):.2g} %.", ""]  # fmt: skip
    lines += ["| cost model, one thread | steps of lanes | ns per step | processor s |", "|---|---|---|---|"]
    for name in ("plain", "tangent"):
        lines.append(f"| {name} | {c[name]:.4g} | {1e9 * t[name]:.4g} | {c[name] * t[name]:.3g} |")
    lines += [f"| model | | | {model:.3g} |", f"| measured | | | {c['seconds']:.3g} |", "",
              f"The model is {100 * (model / c['seconds'] - 1):+.2g} % off.", ""]  # fmt: skip
    lines += ["| what | on 2 cores | on 64 | on 10^4 |", "|---|---|---|---|"]
    for points in (1e6, 1e9):
        spent = [clock(points * each / n) for n in (2, 64, 10_000)]
        lines.append(f"| {points:.0e} points of {1e3 * each:.3g} ms | {' | '.join(spent)} |")
    rates = [n / 3.0 for n in (2, 64, 10_000)]
    lines.append(f"| chunks of 3 s, tasks per second | {' | '.join(f'{r:.3g}' for r in rates)} |")
    for points in (1e6, 1e9):
        files = points / (3.0 / each) * s["files_per_chunk"]
        lines += ["", f"{points:.0e} points: {points * s['bytes_per_point'] / 1e9:.3g} GB in {files:.2g} files."]
    lines += [
        "", f"The scheduler does {through['tasks_per_second']:.3g} trivial tasks per second. A chunk takes"
        f" {1e3 * s['commit']:.3g} ms to commit and {1e3 * s['check']:.3g} ms to check; it is {s['files_per_chunk']} files"
        f" of {s['bytes_per_point']:.3g} bytes per point together.", "",
    ]  # fmt: skip
    lines.append("Peak memory: " + ", ".join(f"{mb:.3g} MB for {n} points" for n, mb in m["memory"].items()) + ".")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--json", type=Path, help="where to write what was measured")
    parser.add_argument("--from", dest="read", type=Path, help="do not measure: read this")
    parser.add_argument("--page", type=Path, help="page whose tables are replaced, between its two marks")
    chosen = parser.parse_args()
    if chosen.read:
        found = json.loads(chosen.read.read_text())
    else:
        found = json.loads(json.dumps(measure()))
        if chosen.json:
            chosen.json.write_text(json.dumps(found, indent=1))
    print(page(found))
    if chosen.page:
        before, _, rest = chosen.page.read_text().partition(BEGIN)
        after = rest.partition(END)[2]
        chosen.page.write_text(f"{before}{BEGIN}\n\n{page(found)}\n\n{END}{after}")


if __name__ == "__main__":
    main()
