"""``whirlmap identify``: the paper's claims, judged for every plausible set of the parameters that it does not give."""

import time
from os.path import relpath
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from whirlmap.cli.common import report
from whirlmap.cli.common.messages import say
from whirlmap.cli.common.progress import Progress, clock
from whirlmap.errors import RangeError, counted
from whirlmap.options.execution import Execution
from whirlmap.results.files import check_writable
from whirlmap.studies.gear_psfd.search.answer import answer, edition_share, exclusions, regimes, shares
from whirlmap.studies.gear_psfd.search.answer_pages import around, fill, write_answer, write_picture
from whirlmap.studies.gear_psfd.search.answer_pages import page as tables
from whirlmap.studies.gear_psfd.search.blocks import open_blocks
from whirlmap.studies.gear_psfd.search.coarse_diagrams import Settings
from whirlmap.studies.gear_psfd.search.identify import judged_so_far, pilot, plan, search, sets_finished, spans_of
from whirlmap.studies.gear_psfd.search.refine import LEAST, POPULATION, best_starts, refine
from whirlmap.studies.gear_psfd.search.stability_pages import draw_threshold, linear, linear_page
from whirlmap.studies.gear_psfd.search.variants import chosen
from whirlmap.sweep.maps.executors import connected

if TYPE_CHECKING:
    from whirlmap.studies.gear_psfd.search.answer import Answer
    from whirlmap.studies.gear_psfd.search.blocks import Blocks
    from whirlmap.studies.gear_psfd.search.identify import Cost
    from whirlmap.studies.gear_psfd.search.variants import Variant


def identify(
    *, sets: int, edition: list[str] | None, variant: list[str] | None, seed: int, refine: int, minutes: float | None,
    store: Path | None, resume: bool, share: str, dask: str | None, no_pilot: bool, workers: int | None, out: Path | None,
    linear: int, page: Path | None, force: bool, json: bool, quiet: bool,
) -> None:  # fmt: skip
    """Do what `whirlmap.cli.declared.identify` says."""
    i, n = _share(share)
    if page is not None and out is None:
        raise RangeError("--page needs --out, where its pictures are")
    if n > 1 and store is None:
        raise RangeError("--share needs --store, which the shares have in common")
    if resume and store is None:
        raise RangeError("--resume continues the search in --store: give one")
    if refine and n > 1:
        raise RangeError("--generations needs all blocks: when all shares are finished, run it without --share")
    if refine and sets < LEAST:
        raise RangeError(f"--generations needs at least {LEAST} sets of a variant, and --sets is {sets}")
    if dask is not None and workers is not None:
        raise RangeError("--workers are threads of this process, and a cluster has its own: give one of them")
    variants = chosen(tuple(edition or ()), tuple(variant or ()))
    settings = Settings(seed=seed)
    if out is not None:
        check_writable(out, force=force)
    if page is not None:
        around(page)
    blocks = open_blocks(store, settings.identity(), resume=resume)
    begun = time.monotonic()
    deadline = None if minutes is None else begun + 60 * minutes
    interrupted = False
    if minutes != 0:
        try:
            with connected(dask) as client:
                _compute(
                    variants, settings, blocks, sets, refine, deadline, (i, n), not no_pilot, client, workers, quiet
                )
        except KeyboardInterrupt:
            interrupted = True
            kept = f"kept; continue with --store {store} --resume" if store else "reported, and then lost: use --store"
            say(f"interrupted: what was finished is {kept}")
    found = answer(variants, settings, blocks)
    if found is None:
        waiting = sum(len(spans_of(blocks, v)) for v in variants)
        say(
            f"finished blocks: {waiting}, but not the first of any variant, so there is nothing to report yet"
            if waiting
            else "no block is finished, so there is nothing to report"
        )
        if json:
            nothing: dict[str, Any] = {"variants": {}, "editions": {}, "excluded": {}, "best": {}, "files": []}
            missing = [v.name for v in variants]
            report.print_json({"seed": seed, "missing": missing, **nothing, "interrupted": interrupted})
        raise typer.Exit(130 if interrupted else 0)
    files = _write(found, blocks, out, page, linear, workers, force)
    if json:
        report.print_json({**found.summary(), "files": files, "interrupted": interrupted})
    else:
        _print(found)
        report.print_written(files)
    if interrupted:
        raise typer.Exit(130)


def _share(text: str) -> tuple[int, int]:
    try:
        i, n = (int(part) for part in text.split("/"))
    except ValueError:
        i, n = 0, 0
    if not 1 <= i <= n:
        raise RangeError(f"--share: found {text!r}, expected I/N with I from 1 to N, as 3/12")
    return i, n


def _compute(
    variants: "tuple[Variant, ...]", settings: "Settings", blocks: "Blocks", sets: int, generations: int,
    deadline: float | None, share: tuple[int, int], measure: bool, client: Any, workers: int | None, quiet: bool,
) -> None:  # fmt: skip
    cost: Cost | None = None
    left = {v: sets - sets_finished(blocks, v) for v in variants}
    unfinished = tuple(v for v in variants if left[v] > 0)
    if measure and unfinished:
        say("pilot: a few sets of each variant, which also compiles")
        threads = sum(client.nthreads().values()) if client else 1
        cost = pilot(unfinished, settings, workers=1 if client else workers).shared(threads)
        most = sum(cost.of(v, left[v]) for v in unfinished) / share[1]
        block = plan(sets)[0][1]
        first = sum(cost.of(v, min(block, left[v])) for v in unfinished) / share[1]
        slow = max(unfinished, key=lambda v: cost.of(v, 1))
        more = f", and {counted(generations, 'generation')} of {POPULATION} sets for each edition" if generations else ""
        say(
            f"cost: {settings.points} points for each set; {clock(first)} for one more block of"
            f" {counted(len(unfinished), 'variant')},"
            f" at most {clock(most)} for {sets} sets of each{more}; slowest: {slow.name},"
            f" {settings.points / cost.of(slow, 1):.0f} points/s"
        )
    with Progress("identify", None, quiet=quiet) as progress:
        begun, done, execution = time.monotonic(), 0, Execution(workers, progress, client)
        for name in search(
            variants, settings, blocks, sets=sets, cost=cost, deadline=deadline, share=share,
            execution=execution, told=say,
        ):  # fmt: skip
            first_set, last_set = (int(part) for part in name.rpartition(".")[2].split("-"))
            done += last_set - first_set
            rate = done / (time.monotonic() - begun)
            say(f"{name}: finished; {done} sets so far, {rate:.3g} sets/s, {rate * settings.points:.3g} points/s")
        if generations:
            _refine(variants, settings, blocks, generations, deadline, execution)


def _refine(
    variants: "tuple[Variant, ...]", settings: "Settings", blocks: "Blocks", generations: int, deadline: float | None,
    execution: Execution,
) -> None:  # fmt: skip
    judged = [j for v in variants if (j := judged_so_far(blocks, v, settings)) is not None]
    for start in best_starts(judged):
        if start.total.size < LEAST:
            say(f"{start.variant.name}: not refined, for {start.total.size} sets are too few")
            continue
        before = float(start.total.max())
        found = refine(
            start, settings, blocks, generations=generations, execution=execution,
            more=lambda: deadline is None or time.monotonic() < deadline,
        )  # fmt: skip
        after = max(before, float(found.total.max()))
        say(f"{start.variant.name}: refined from a mean score of {before:.3f} to {after:.3f} in {found.total.size} sets")


def _write(
    found: "Answer", blocks: "Blocks", out: Path | None, page: Path | None, linear_sets: int, workers: int | None,
    force: bool,
) -> list[Path]:  # fmt: skip
    if out is None:
        return []

    more = "\n" + linear_page(linear(found, blocks, linear_sets)) if linear_sets else ""
    files = write_answer(found, out, more=more, force=force)
    if linear_sets:
        files.append(write_picture(draw_threshold(workers), out / "threshold.png", force=force))
    if page is not None:
        here = page.resolve().parent
        shown = {f.stem: Path(relpath(f.resolve(), here)).as_posix() for f in files if f.suffix == ".png"}
        fill(page, tables(found, shown) + more)
        files.append(page)
    return files


def _print(found: "Answer") -> None:
    if found.missing:
        say(f"no set finished yet: {', '.join(found.missing)}")
    for edition in found.editions:
        judged = found.of(edition)
        names = [j.variant.name.removeprefix(f"{edition}-") for j in judged]
        rows = [
            [c, *(f"{100 * s:.3g} ({100 * a:.3g}-{100 * b:.3g})"
                  for s, a, b in (edition_share(found, edition, c), *(shares(j, c) for j in judged)))]
            for c in found.claims
        ]
        sets = ", ".join(str(j.values.shape[1]) for j in judged)
        title = f"{edition}: claims, in percent of sets ({sets} sets), 95 %"
        report.show(report.table(title, ("claim", "all", *names), rows))
        kinds: dict[str, Any] = {name: [f"{100 * regimes(j)[name]:.3g}" for j in judged] for name in regimes(judged[0])}
        points = [[name, *cells] for name, cells in kinds.items()]
        report.show(report.table(f"{edition}: operating points, in percent", ("kind", *names), points))
        for pair in exclusions(found, edition):
            typer.echo(f"never together: {' and '.join(pair['claims'])} ({pair['expected']:.0f} sets expected)")
    for edition, best in found.best.items():
        missed = ", ".join(f"{c} ({w})" for c, w in best.missed.items()) or "none"
        typer.echo(
            f"best of {edition}: {best.variant.name}, {len(best.met)} of {len(best.words)} claims, mean score"
            f" {best.score:.3f}; missed: {missed}"
        )
