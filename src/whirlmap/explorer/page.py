"""The page as one HTML text: its style, the drawing library and its scripts stand in it."""

from importlib.resources import files

from whirlmap.explorer.encoding import json_text

#: Scripts in the order in which they are read; the source of motions comes before the last one.
SCRIPTS = (
    "explorer.js", "drawing.js", "cells.js", "branches.js", "overview.js", "panels.js", "controls.js",
    "address.js", "exports.js",
)  # fmt: skip
#: The source of motions of the local page.
SERVER = "server.js"


def page_html(*, nonce: str = "", source: str | None = None, data: object = None, embedded: bool = False) -> str:
    """The page.

    Parameters
    ----------
    nonce : str
        Of its scripts and style, where a content policy asks for one.
    source : str, optional
        Script that sets ``explorer.source``, where motions come from; that of the local server where absent.
    data : object, optional
        The page's data (`page_data.page_data`), where no server gives them.
    embedded : bool
        For a frame inside of another page: without the header, and as wide as low.
    """
    mark = f' nonce="{nonce}"' if nonce else ""
    scripts = [part("uPlot.iife.min.js"), *map(part, SCRIPTS), part(SERVER) if source is None else source, part("main.js")]
    if data is not None:
        scripts.insert(2, f"explorer.data = {_in_script(json_text(data))};")
    inlined = "\n".join(f"<script{mark}>{text}</script>" for text in scripts)
    sheets = ("uPlot.min.css", "explorer.css", *(("embedded.css",) if embedded else ()))
    style = "\n".join(f"<style{mark}>{part(name)}</style>" for name in sheets)
    html = part("explorer.html")
    return html.replace("<!-- style -->", style).replace("<!-- scripts -->", inlined)


def part(name: str) -> str:
    """A file of the page."""
    return (files("whirlmap.explorer") / "page" / name).read_text(encoding="utf-8")


def _in_script(text: str) -> str:
    """JSON that may stand inside of a script: it cannot end it."""
    return text.replace("<", "\\u003c").replace("\u2028", "\\u2028").replace("\u2029", "\\u2029")
