"""Links of the pages to files of the repository that are no pages: of the site they lead to the page that shows the file.

The pages are also read in the repository itself, so their links are those of files.
"""

import re
from pathlib import PurePosixPath
from typing import Any

from sphinx.errors import ExtensionError

#: File, from the root of the repository -> page of the site that shows it.
SHOWN = {"src/whirlmap/studies/gear_psfd/audit.md": "explanation/audit"}

_LINK = re.compile(r"\]\(((?:\.\./)+[^)\s#]+)(#[^)\s]*)?\)")


def rewrite(app: Any, docname: str, source: list[str]) -> None:
    """Point the links of a page at pages."""
    if app.env.doc2path(docname).suffix != ".md":
        return
    here = PurePosixPath("docs", docname).parent

    def page(found: re.Match[str]) -> str:
        parts = list(here.parts)
        for part in PurePosixPath(found[1]).parts:
            parts = parts[:-1] if part == ".." else [*parts, part]
        target = "/".join(parts)
        if parts[0] == "docs":
            return found[0]
        if target not in SHOWN:
            raise ExtensionError(f"{docname}: {found[1]} is no page of the site; name one in {__name__}.SHOWN")
        return f"](/{SHOWN[target]}.md{found[2] or ''})"

    source[0] = _LINK.sub(page, source[0])


def setup(app: Any) -> dict[str, bool]:
    """Register with Sphinx."""
    app.connect("source-read", rewrite)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
