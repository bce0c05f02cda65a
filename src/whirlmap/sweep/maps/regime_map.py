"""Regime maps and random draws: every point of a grid, or of a sample, labelled."""

from collections.abc import Mapping
from typing import Any, Unpack

import xarray as xr
from numpy.typing import ArrayLike

from whirlmap.errors import RangeError
from whirlmap.integrate.own_units import refuse_input, refuse_unknown
from whirlmap.integrate.system import System
from whirlmap.options.computed import LABELLING, Labelling
from whirlmap.options.execution import EXECUTION, Execution
from whirlmap.options.storage import STORAGE, Storage
from whirlmap.options.taking import MapParts, takes_options
from whirlmap.progress import tell
from whirlmap.sweep.maps.run_sweep import ChunkReport, OnChunk, run_sweep
from whirlmap.sweep.parameters.random_draws import Tolerance
from whirlmap.sweep.parameters.space import space_of


@takes_options("map", unit="points", rate_unit="points/s")
def regime_map(
    system: System,
    vary: Mapping[str, ArrayLike],
    *,
    refine: bool = False,
    sections: bool = False,
    on_chunk: OnChunk | None = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    storage: Storage = STORAGE,
    **_given: Unpack[MapParts],
) -> xr.Dataset:
    """Label every point of a grid over one or more parameters.

    Parameters
    ----------
    system : System
        Its values and start states count.
    vary : mapping of str to array
        Ascending values of each varied parameter or dimensional input, as of `bifurcation_diagram`:
        ``{"c": "40um:80um:50"}``. They become the dimensions, in this order.
    refine : bool
        Compute a coarse lattice, then only the points near differing labels; the others take the label of their
        surroundings, and ``evaluation`` says so. Wants two parameters.
    sections : bool
        Keep ``section(..., period, state)`` of every point, once per T, as a bifurcation diagram has it.
    on_chunk : callable, optional
        Called with `whirlmap.sweep.maps.run_sweep.ChunkReport` after every chunk.
    labelling : Labelling, optional
        How points are measured; or its parts as keywords, ``settling``, ``lyapunov``, ``method``, ``steps``, ``accuracy``.
    execution : Execution, optional
        How it is run, which changes no number; or its parts as keywords, ``workers`` (threads with a
        chunk each), ``progress`` (told of points), ``cluster``.
    storage : Storage, optional
        Where it is kept; or its parts as keywords, ``store``, ``resume``, ``force``, ``share``, ``chunk``.

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
    told, space = counting(on_chunk, execution.progress), space_of(system, vary)
    return run_sweep(system, space, labelling, execution, storage, refine=refine, sections=sections, on_chunk=told)


@takes_options("draws", unit="points", rate_unit="points/s")
def tolerance_sweep(
    system: System,
    tolerances: Mapping[str, Tolerance | str],
    draws: int,
    *,
    seed: int = 0,
    vary: Mapping[str, ArrayLike] | None = None,
    on_chunk: OnChunk | None = None,
    labelling: Labelling = LABELLING,
    execution: Execution = EXECUTION,
    storage: Storage = STORAGE,
    **_given: Unpack[MapParts],
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
    on_chunk, labelling, execution, storage
        As in `regime_map`, also by their parts.

    Returns
    -------
    xr.Dataset
        As `regime_map`.

    Raises
    ------
    RangeError
        No tolerance, one that cannot be read, or names and values that are not the model's: dimensional inputs are drawn by
        ``whirlmap speeds --input-tolerance``.
    OutputError
        As `regime_map`.

    Notes
    -----
    Draws are independent and come from a counter-based generator (Philox), so that draw 17 is the same in every run and
    every share. Shares over the draws have the error of a sample: 1000 draws know a share of 5 % to 0.7 %.
    """
    found = {}
    for name, given in tolerances.items():
        refuse_input(system, name, "tolerances")
        refuse_unknown(system, name, "tolerances")
        found[name] = given if isinstance(given, Tolerance) else Tolerance.parse(given, float(system.values[name]))
    if not found:
        raise RangeError("found no tolerance, expected at least one, as in {'s': 'normal:3%'}")
    told, space = counting(on_chunk, execution.progress), space_of(system, vary or {}, found, draws, seed)
    return run_sweep(system, space, labelling, execution, storage, on_chunk=told)


def counting(on_chunk: OnChunk | None, progress: Any) -> OnChunk | None:
    """Have what takes the standing after every chunk count the points for ``progress`` too."""
    if progress is None:
        return on_chunk
    counted = 0

    def told(now: ChunkReport) -> None:
        nonlocal counted
        tell(progress, "expect", now.points_total - now.points_done + now.points)
        progress(now.points - counted)
        counted = now.points
        if on_chunk:
            on_chunk(now)

    return told
