"""Regime maps and random draws: every point of a grid, or of a sample, labelled."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.analysis.labels.labelling import Labelling
from whirlmap.analysis.steady.settling import Settling
from whirlmap.errors import RangeError
from whirlmap.integrate.system import System
from whirlmap.progress import ProgressOption, shows_progress, tell
from whirlmap.sweep.maps.run_sweep import OnChunk, Progress, run_sweep
from whirlmap.sweep.parameters.random_draws import Tolerance
from whirlmap.sweep.parameters.space import Space


@shows_progress("map", unit="points", rate_unit="points/s")
def regime_map(
    system: System,
    vary: Mapping[str, ArrayLike],
    *,
    store: str | Path | None = None,
    resume: bool = False,
    force: bool = False,
    share: tuple[int, int] | None = None,
    cluster: Any = None,
    refine: bool = False,
    sections: bool = False,
    settling: Settling | None = None,
    lyapunov: int | None = None,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    workers: int | None = None,
    chunk: int | None = None,
    on_chunk: OnChunk | None = None,
    progress: ProgressOption = None,
) -> xr.Dataset:
    """Label every point of a grid over one or more parameters.

    Parameters
    ----------
    system : System
        Its values and start states count.
    vary : mapping of str to array
        Ascending values of each varied parameter; they become the dimensions, in this order.
    store : path, optional
        Folder of the Zarr store, which `xarray.open_zarr` opens; its parent exists. Where absent nothing is kept on disk.
    resume : bool
        Go on with what the store holds; begin it where it is absent, empty or half-made.
    force : bool
        Replace an existing store; with ``resume`` it has no meaning.
    share : (i, n), optional
        Work on share i of n of the chunks only, i from 1: the jobs of an array each take one, on one store.
    cluster : str, dask cluster or client, optional
        Where the chunks are computed: the address of a Dask scheduler, or an object; threads of this process where absent.
    refine : bool
        Compute a coarse lattice, then only the points near differing labels; the others take the label of their
        surroundings, and ``evaluation`` says so. Wants two parameters.
    sections : bool
        Keep ``section(..., period, state)`` of every point, once per T, as a bifurcation diagram has it.
    settling, lyapunov, steps, accuracy, method
        As in `label_points`.
    workers : int, optional
        Threads, each of which computes one chunk; all cores where absent.
    chunk : int, optional
        Points of a chunk; where absent such that one takes about 3 seconds.
    on_chunk : callable, optional
        Called with `whirlmap.sweep.maps.run_sweep.Progress` after every chunk.
    progress : callable or True, optional
        Called with the number of points done since the last call; True shows a bar.

    Returns
    -------
    xr.Dataset
        The variables of `label_points` over the varied parameters, and ``evaluation``: absent, computed, inferred or
        failed. Of a store, its arrays stay on the disk until they are read.

    Raises
    ------
    OutputError
        The store exists and neither resume nor force was asked for, belongs to another sweep, program or processor, or
        cannot be written.
    RangeError
        Names or values are not the model's.

    Notes
    -----
    Bits do not depend on workers, chunks, order, shares, the executor, or on where the run was interrupted.
    """
    axes = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in vary.items()}
    labelling = Labelling(settling or Settling(), lyapunov, steps, accuracy, method, workers=1)
    return run_sweep(
        system, Space(axes), labelling, store=store, resume=resume, force=force, share=share, cluster=cluster,
        refine=refine, sections=sections, workers=workers, chunk=chunk, on_chunk=counting(on_chunk, progress),
    )  # fmt: skip


@shows_progress("draws", unit="points", rate_unit="points/s")
def tolerance_sweep(
    system: System,
    tolerances: Mapping[str, Tolerance | str],
    draws: int,
    *,
    seed: int = 0,
    vary: Mapping[str, ArrayLike] | None = None,
    settling: Settling | None = None,
    lyapunov: int | None = None,
    steps: int | None = None,
    accuracy: float | None = None,
    method: str | None = None,
    on_chunk: OnChunk | None = None,
    progress: ProgressOption = None,
    **options: Any,
) -> xr.Dataset:
    """Label random draws of parameters within their tolerances, alone or at every point of a grid.

    Parameters
    ----------
    system : System
        Its values and start states count.
    tolerances : mapping of str to Tolerance or str
        Of each drawn parameter, as ``Tolerance("uniform", 0.9, 1.1)`` or ``"normal:3%"`` about the system's value.
    draws : int
        How many; they are the dimension ``draw``, with the parameters' values as coordinates.
    seed : int
        Master seed: a draw follows from it, the parameter's name and the number of the draw alone.
    vary : mapping of str to array, optional
        Grid over further parameters; the same draws are taken at each of its points.
    **options
        Those of `regime_map`, as ``on_chunk`` and ``progress`` are.

    Returns
    -------
    xr.Dataset
        As `regime_map`.

    Raises
    ------
    RangeError
        No tolerance, one that cannot be read, or names and values that are not the model's.
    OutputError
        As `regime_map`.

    Notes
    -----
    Draws are independent and come from a counter-based generator (Philox), so that draw 17 is the same in every run and
    every share. Shares over the draws have the error of a sample: 1000 draws know a share of 5 % to 0.7 %.
    """
    found = {
        name: t if isinstance(t, Tolerance) else Tolerance.parse(t, float(system.values.get(name, np.nan)))
        for name, t in tolerances.items()
    }
    if not found:
        raise RangeError("found no tolerance, expected at least one, as in {'s': 'normal:3%'}")
    axes = {name: np.atleast_1d(np.asarray(values, dtype=float)) for name, values in (vary or {}).items()}
    labelling = Labelling(settling or Settling(), lyapunov, steps, accuracy, method, workers=1)
    return run_sweep(
        system, Space(axes, found, draws, seed), labelling, on_chunk=counting(on_chunk, progress), **options
    )  # fmt: skip


def counting(on_chunk: OnChunk | None, progress: ProgressOption) -> OnChunk | None:
    """Have what takes the standing after every chunk count the points for ``progress`` too."""
    if progress is None:
        return on_chunk
    counted = 0

    def told(now: Progress) -> None:
        nonlocal counted
        tell(progress, "expect", now.points_total - now.points_done + now.points)
        progress(now.points - counted)
        counted = now.points
        if on_chunk:
            on_chunk(now)

    return told
