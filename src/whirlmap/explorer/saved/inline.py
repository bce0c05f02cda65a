"""The explorer inside of a notebook, and as a file: `whirlmap.explore`."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Union

from whirlmap.errors import InputError
from whirlmap.explorer.exploration import Exploration, of_result
from whirlmap.explorer.saved.saved_page import saved_page
from whirlmap.explorer.with_branches import lay_over
from whirlmap.integrate.system import System
from whirlmap.results.files import replace_file

if TYPE_CHECKING:
    import xarray as xr

#: Height of the page in a notebook [pixel].
HEIGHT = 900


@dataclass(frozen=True)
class ExplorerPage:
    """A page that needs no server: a notebook shows it, and `save` writes it.

    Attributes
    ----------
    title : str
        What is explored.
    html : str
        The whole page.
    height : int
        Of its frame in a notebook [pixel].
    """

    title: str
    html: str = field(repr=False)
    height: int = HEIGHT

    def __repr__(self) -> str:
        size = len(self.html.encode()) / 1e6
        return f"Explorer of {self.title}, {size:.2g} MB: a notebook shows it, and .save('page.html') writes it as a file"

    def _repr_html_(self) -> str:
        """The page in a frame of its own, which can reach nothing of the notebook around it."""
        return (
            f'<iframe title="whirlmap explorer: {escape(self.title)}" srcdoc="{escape(self.html)}" width="100%"'
            f' height="{self.height}" sandbox="allow-scripts allow-downloads" style="border: 0"></iframe>'
        )

    def save(self, path: str | Path, *, force: bool = False) -> Path:
        """Write the page as one file, complete or not at all.

        Parameters
        ----------
        path : str or Path
            Its name; browsers expect it to end in ``.html``.
        force : bool
            Replace what exists.

        Returns
        -------
        Path
            The file.

        Raises
        ------
        OutputError
            The folder is missing or cannot be written; something exists and ``force`` is false.
        """
        return replace_file(Path(path), lambda trial: trial.write_text(self.html, encoding="utf-8"), force=force)


def explore(
    what: Union["xr.Dataset", System], *, case: str | None = None, branches: Sequence["xr.Dataset"] = (),
    height: int = HEIGHT,
) -> ExplorerPage:  # fmt: skip
    """Page on which one looks at a map or diagram, chooses a point, and sees its motion; shown inline in a notebook.

    Parameters
    ----------
    what : xr.Dataset or System
        Result of `bifurcation_diagram` or `regime_map`, in the model's own units; or a system, whose one motion is shown.
    case : str, optional
        Name or path of the case of a result, where that is no stock case and not where it was.
    branches : sequence of xr.Dataset
        Of `continue_orbit`, drawn over a diagram, or of `event_curve`, drawn over a map.
    height : int
        Height of the page in a notebook [pixel].

    Returns
    -------
    ExplorerPage
        A notebook shows it where it is the last line of a cell; ``.save("page.html")`` writes it.

    Raises
    ------
    InputError
        No labelled points over one or two quantities; branches of another system, or of other parameters.
    CaseError
        The case of a result cannot be loaded as it was.

    Notes
    -----
    The page needs no server and no network. Motions are computed in the browser by the model's own kernels, compiled to
    WebAssembly, from the start states and with the steps that the points have; a periodic motion agrees with `simulate` to
    1e-9 of its range over 20 T. Where a model cannot run in a browser the page says so, and shows motions that are stored
    in it. `whirlmap explore` serves a page that computes more: finer diagrams, votes, other parameters.
    """
    if height < 1:
        raise InputError(f"height: found {height}, expected at least one pixel")
    found = Exploration(what, {}, title=what.case) if isinstance(what, System) else of_result(what, "the Dataset", case)
    found = lay_over(found, {f"branches[{k}]": ds for k, ds in enumerate(branches)})
    return ExplorerPage(found.title or found.system.model.name, saved_page(found), height)
