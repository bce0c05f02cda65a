"""Writing of a figure to a file: complete or not at all, and with the same bytes for the same figure."""

import os
from io import BytesIO
from pathlib import Path
from typing import Any, Literal

import matplotlib as mpl
from matplotlib.figure import Figure

from whirlmap.errors import OutputError
from whirlmap.plot.common.style import house, set_by_user
from whirlmap.results.files import replace_file

Format = Literal["png", "svg", "pdf"]

#: Dots per inch of a saved picture.
PRINT_DPI = 200

#: What the files say about themselves: no date, nothing that differs between two runs.
_METADATA: dict[str, dict[str, Any]] = {
    "png": {"Software": "whirlmap"},
    "svg": {"Creator": "whirlmap", "Date": None},
    "pdf": {"Creator": "whirlmap", "Producer": None, "CreationDate": None},
}


def encode(fig: Figure, form: Format, *, dpi: float | None = None) -> bytes:
    """Give a figure as the bytes of a file; the same figure gives the same bytes.

    Parameters
    ----------
    fig : Figure
        As it is drawn; its own size counts.
    form : {"png", "svg", "pdf"}
        Format of the file.
    dpi : float, optional
        As in `save`.

    Returns
    -------
    bytes
        The whole file, without date and without names that differ between two runs.
    """
    settings: dict[Any, Any] = {
        **house(),
        "svg.hashsalt": "whirlmap",
        "svg.fonttype": "path",
        "pdf.fonttype": 42,
    }
    dots = dpi or set_by_user("savefig.dpi") or PRINT_DPI
    buffer = BytesIO()
    with mpl.rc_context(settings):
        fig.savefig(buffer, format=form, dpi=dots, metadata=_METADATA[form])
    return buffer.getvalue()


def save(fig: Figure, path: str | os.PathLike[str], *, dpi: float | None = None) -> Path:
    """Write a figure to ``path``, in the format that its suffix names.

    The picture is complete before the file appears: it is written under a temporary name in the same folder
    and then renamed. What was there is replaced; whether that is allowed is for the caller to ask first.

    Parameters
    ----------
    fig : Figure
        As it is drawn; its own size counts.
    path : path
        Ends in ``.png``, ``.svg`` or ``.pdf``; its folder exists.
    dpi : float, optional
        Dots per inch, also of the rasterised clouds of points in SVG and PDF. Where absent the ``savefig.dpi`` of the
        user's settings, else 200.

    Returns
    -------
    Path
        Of the file that was written.

    Raises
    ------
    OutputError
        The suffix names no format, the folder does not exist, or the file cannot be written.
    """
    target = Path(path)
    form = target.suffix.lower().lstrip(".")
    if form not in _METADATA:
        raise OutputError(f"{target}: a picture ends in .png, .svg or .pdf, not {target.suffix or 'nothing'!r}")
    if not target.parent.is_dir():
        raise OutputError(f"{target}: the folder {target.parent} does not exist; make it first")
    data = encode(fig, form, dpi=dpi)  # type: ignore[arg-type]
    return replace_file(target, lambda trial: trial.write_bytes(data), force=True)
