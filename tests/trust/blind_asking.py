"""Asks whirlmap for the labels of the blind points, one process each, and holds them against the truth.

python -m tests.trust.blind_asking [--by diagnose] [--limit 120] [--seed 1] [NAME ...]
"""

import argparse
import multiprocessing
import resource
import time
from pathlib import Path

from tests.trust.asking import Refused, asked, diagram, label, load
from tests.trust.blind_fresh import drawn
from tests.trust.blind_models import MODELS
from tests.trust.blind_points import POINTS

import whirlmap

#: Labels by which it is said that nothing is known.
OPEN = ("undecided", "not-settled", "not-steady", "unresolved", "locked 0")


def said(point, by="diagram"):
    """What whirlmap calls the point: as `Point.truth`, or why it does not."""
    system = load(MODELS[point.system], point.values, point.start)
    if by == "diagram":
        ds, at = asked(diagram, system, lyapunov=None), (0,)
    else:
        ds, at = asked(whirlmap.diagnose, system), ()
    if isinstance(ds, Refused):
        return f"refused: {ds.sentence}"
    name = label(ds, at)
    return f"locked {int(ds['period_T'][at])}" if name == "locked" else name


def judged(point, name):
    """``right``, ``open`` or ``wrong``."""
    if name == point.truth:
        return "right"
    return "open" if name in OPEN or name.startswith(("refused", "longer than")) else "wrong"


def _child(point, by, limit, pipe):
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 5))
    name = said(point, by)
    pipe.send((name, time.process_time()))


def ask(point, by="diagram", limit=120):
    """Label and seconds of processor time, of a process that may take ``limit`` of them."""
    here, there = multiprocessing.Pipe(False)
    child = multiprocessing.Process(target=_child, args=(point, by, limit, there))
    child.start()
    there.close()
    try:
        return here.recv()
    except EOFError:
        return f"longer than {limit} s", float(limit)
    finally:
        child.join()


def main():
    """Print a table, one line a point, and what is wrong or open again at the end."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--by", choices=["diagram", "diagnose"], default="diagram")
    parser.add_argument("--limit", type=int, default=120)
    parser.add_argument("--out")
    parser.add_argument("--seed", type=int, help="points of `blind_fresh` instead")
    parser.add_argument("names", nargs="*", help="beginnings of names")
    options = parser.parse_args()
    rows = []
    for point in POINTS if options.seed is None else drawn(options.seed):
        if options.names and not point.name.startswith(tuple(options.names)):
            continue
        name, seconds = ask(point, options.by, options.limit)
        rows.append((judged(point, name), f"{point.name:24s} {point.truth:15s} {seconds:7.1f} s  {name[:110]}"))
        print(f"{rows[-1][0]:6s} {rows[-1][1]}", flush=True)
    text = [f"{sum(kind == k for k, _ in rows)} {kind}" for kind in ("right", "open", "wrong")]
    lines = [", ".join(text), *(f"{k:6s} {row}" for wanted in ("wrong", "open") for k, row in rows if k == wanted)]
    print("\n".join(lines))
    if options.out:
        Path(options.out).write_text("\n".join([lines[0], *(f"{k:6s} {row}" for k, row in rows)]) + "\n")


if __name__ == "__main__":
    main()
