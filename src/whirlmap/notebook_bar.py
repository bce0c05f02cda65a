"""A bar of progress in a notebook: HTML that is shown once and then replaced, for which a notebook needs no other package.

rich shows its bars in a notebook only where ipywidgets is installed, and warns where it is not.
"""

import time
from html import escape
from typing import Any

#: Seconds between two drawings: every one of them is a message to the notebook.
DRAWN = 0.5


class NotebookBar:
    """One task, with the methods of rich's ``Progress`` that `whirlmap.progress` calls.

    Parameters
    ----------
    left : str
        What stands before the time that is left.
    """

    def __init__(self, left: str) -> None:
        self.left = left
        self.what, self.completed = "", 0.0
        self.total: float | None = None
        self.fields: dict[str, str] = {}
        self.handle: Any = None
        self.begun = self.drawn = 0.0
        self.ended = False

    def add_task(self, what: str, *, total: float | None, **fields: str) -> int:
        """Say what is done; there is one task."""
        self.what, self.total, self.fields = what, total, fields
        return 0

    def start(self) -> None:
        """Show the bar."""
        from IPython.display import display

        self.begun = time.monotonic()
        self.handle = display(self, display_id=True)

    def update(self, task: int, **changes: Any) -> None:  # noqa: ARG002 (there is one)
        """Change it: ``description``, ``total`` (None: unknown) and ``completed``, or other texts by name."""
        self.what = changes.pop("description", self.what)
        self.total = changes.pop("total", self.total)
        self.completed = changes.pop("completed", self.completed)
        self.fields |= changes
        if time.monotonic() - self.drawn >= DRAWN:
            self.draw()

    def draw(self) -> None:
        """Replace what the notebook shows."""
        self.drawn = time.monotonic()
        if self.handle is not None:
            self.handle.update(self)

    def stop(self) -> None:
        """Take it away."""
        self.ended = True
        self.draw()

    def _parts(self) -> list[str]:
        rest = f"{self.left} {self.fields['left']}" if self.fields.get("left") else ""
        seconds = f"{time.monotonic() - self.begun:.0f} s"
        share = "" if self.total is None else f"{100 * self.completed / self.total:.0f} %"
        return [part for part in (share, self.fields.get("rate", ""), seconds, rest) if part]

    def __repr__(self) -> str:
        return "" if self.ended else f"{self.what}: {', '.join(self._parts())}"

    def _repr_html_(self) -> str:
        if self.ended:
            return ""
        value = "" if self.total is None else f' value="{self.completed / self.total:.4f}"'
        return (
            f'<div>{escape(self.what)} <progress max="1"{value} style="vertical-align: middle"></progress>'
            f" {escape(', '.join(self._parts()))}</div>"
        )
