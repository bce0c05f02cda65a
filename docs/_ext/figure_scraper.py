"""Pictures of the gallery: every new figure that a block of a script has made. whirlmap draws without pyplot."""

from collections.abc import Mapping
from typing import Any

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from sphinx_gallery.scrapers import figure_rst

#: Dots per inch: what a page has room for, on a screen with two dots per pixel.
DPI = 130


def drawn(variables: Mapping[str, Any]) -> list[Figure]:
    """Figures among the variables of a script: themselves, or those of Axes; each once, the first made first."""
    found = [v.figure if isinstance(v, Axes) else v for v in variables.values() if isinstance(v, Axes | Figure)]
    return list({id(figure): figure for figure in found if isinstance(figure, Figure)}.values())


def scrape(_block: Any, block_vars: Mapping[str, Any], gallery_conf: Mapping[str, Any]) -> str:
    """Save the figures that no earlier block has shown, and return what shows them."""
    shown = block_vars["example_globals"].setdefault("__shown__", [])
    paths = []
    for figure in drawn(block_vars["example_globals"]):
        if not any(figure is other for other in shown):
            path = next(block_vars["image_path_iterator"])
            figure.savefig(path, dpi=DPI)
            shown.append(figure)
            paths.append(path)
    return figure_rst(paths, gallery_conf["src_dir"])
