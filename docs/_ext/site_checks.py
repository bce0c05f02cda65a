"""Checks of the built site: links inside it lead somewhere, and no page fetches anything from outside of it."""

from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote, urlsplit

from sphinx.errors import ExtensionError

#: Elements that a browser fetches by itself, and the attribute that says from where; `a` waits for a click.
FETCHED = {
    "script": "src", "link": "href", "img": "src", "iframe": "src", "source": "src", "video": "src", "audio": "src",
    "object": "data", "embed": "src",
}  # fmt: skip


class Page(HTMLParser):
    """The links of a page, what it fetches, and the anchors that links to it may name."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.links: list[str] = []
        self.fetched: list[str] = []
        self.anchors: set[str] = {"", "top"}
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        """Note one element."""
        given = {name: value or "" for name, value in attrs}
        self.anchors |= {given[name] for name in ("id", "name") if name in given}
        if tag == "a" and "href" in given:
            self.links.append(given["href"])
        if (target := given.get(FETCHED.get(tag, ""))) is not None:
            self.fetched.append(target)


@cache
def page(path: Path) -> Page:
    """A page, read once."""
    return Page(path.read_text(encoding="utf-8"))


def faults(root: Path) -> list[str]:
    """What is wrong with the site in a folder."""
    found = []
    for path in sorted(p for p in root.rglob("*.html") if "_static" not in p.parts):
        where = path.relative_to(root)
        for target in page(path).fetched:
            parts = urlsplit(target)
            if parts.scheme not in ("", "data") or parts.netloc:
                found.append(f"{where} fetches {target} from outside")
        for target in (*page(path).links, *page(path).fetched):
            parts = urlsplit(target)
            if parts.scheme or parts.netloc or target == "#":
                continue
            file = (path.parent / unquote(parts.path)).resolve() if parts.path else path
            if not file.is_file():
                found.append(f"{where} links to {target}, which is not there")
            elif file.suffix == ".html" and unquote(parts.fragment) not in page(file).anchors:
                found.append(f"{where} links to {target}, which has no such anchor")
    return found


def check(app: Any, exception: Exception | None) -> None:
    """Stop where the built site has a fault."""
    if exception is None and app.builder.format == "html" and (found := faults(Path(app.outdir))):
        raise ExtensionError("\n".join(dict.fromkeys(found)))


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx, to run when all is written."""
    app.connect("build-finished", check, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
