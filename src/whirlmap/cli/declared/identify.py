"""Options and help of ``whirlmap identify``."""

from pathlib import Path
from typing import Annotated

import typer

from whirlmap.cli.common import options

SEARCH = "Search"

EXAMPLES = (
    "whirlmap identify --sets 32 --variant intended-porous-positive-shaft",
    "whirlmap identify --store search --minutes 120 --generations 20 --out answer",
    "whirlmap identify --store search --resume --minutes 0 --out answer --force",
    "whirlmap identify --store search --resume --share 3/12 --no-pilot",
)


def identify(
    sets: Annotated[
        int,
        typer.Option("--sets", metavar="N", min=1, max=1_000_000, rich_help_panel=SEARCH,
                     help="Most parameter sets of each variant, in blocks of 512; fewer where every claim's share is known"
                     " to 2 % already."),
    ] = 2560,
    edition: Annotated[
        list[str] | None,
        typer.Option("--edition", metavar="literal|intended", rich_help_panel=SEARCH,
                     help="Only this edition; may be repeated."),
    ] = None,
    variant: Annotated[
        list[str] | None,
        typer.Option("--variant", metavar="NAME", rich_help_panel=SEARCH,
                     help="Only this reading of the paper, as intended-porous-positive-shaft; may be repeated. A wrong name"
                     " is answered with the list."),
    ] = None,
    seed: Annotated[int, typer.Option("--seed", metavar="N", min=0, rich_help_panel=SEARCH, help="Seed of the design.")] = 1,
    refine: Annotated[
        int,
        typer.Option("--generations", metavar="N", min=0, max=10_000, rich_help_panel=SEARCH,
                     help="Generations of 64 sets of differential evolution from the best of each edition, when the blocks"
                     " are finished; not with --share."),
    ] = 0,
    minutes: Annotated[
        float | None,
        typer.Option("--minutes", metavar="M", min=0.0, rich_help_panel=SEARCH,
                     help="Begin no block that would end later, and no generation after that; 0: only read the store."),
    ] = None,
    store: Annotated[
        Path | None,
        typer.Option("--store", metavar="FOLDER", rich_help_panel=options.OUTPUT,
                     help="Keep what is finished, block by block; a killed search continues with --resume."),
    ] = None,
    resume: Annotated[
        bool, typer.Option("--resume", rich_help_panel=options.OUTPUT, help="Continue the search in --store.")
    ] = False,
    share: Annotated[
        str,
        typer.Option("--share", metavar="I/N", rich_help_panel=SEARCH,
                     help="Compute every N-th block from the I-th on, as one task of N with the same --store."),
    ] = "1/1",
    dask: Annotated[
        str | None,
        typer.Option("--dask", metavar="ADDRESS", rich_help_panel=SEARCH,
                     help="Compute on the workers of the Dask scheduler at this address, tcp://host:8786, a core for each of"
                     " their threads."),
    ] = None,
    no_pilot: Annotated[
        bool,
        typer.Option("--no-pilot", rich_help_panel=SEARCH,
                     help="Do not measure and print the cost before the start; --minutes then lets a begun block end."),
    ] = False,
    workers: options.Workers = None,
    out: Annotated[
        Path | None,
        typer.Option("--out", metavar="FOLDER", rich_help_panel=options.OUTPUT,
                     help="Write tables, pictures and the cases literal-best.toml and intended-best.toml to a folder."),
    ] = None,
    linear: Annotated[
        int,
        typer.Option("--linear", metavar="N", min=0, max=512, rich_help_panel=SEARCH,
                     help="With --out: sets of each variant whose linear stability is computed as well; 0: none."),
    ] = 256,
    page: Annotated[
        Path | None,
        typer.Option("--page", metavar="FILE.md", rich_help_panel=options.OUTPUT,
                     help="Put the tables into a page, between its marks; pictures are those of --out."),
    ] = None,
    force: options.Force = False,
    json: options.Json = False,
    quiet: options.Quiet = False,
) -> None:  # fmt: skip
    """Judge the paper's claims for every plausible set of its unpublished parameters.

    The paper gives no parameters but psi and s. This draws sets of all others from plausible ranges, computes a coarse
    labelled diagram of each for every reading of the equations that the text allows, and says how often each claim holds,
    which claims exclude each other, and which set comes closest.
    """
