"""Checks of texts, of which one that takes long keeps nobody from editing."""

from __future__ import annotations

from collections.abc import Callable
from threading import Event, Thread

from nodegraph.editor.view import View

_PATIENCE = 3.0
"""Seconds after which a text is shown without its check."""
_MOST = 4
"""Checks at a time: none can be ended, and a pattern of files may walk through a whole disk."""


class Checking:
    """Checks the texts of one file, each in a thread of its own.

    Parameters
    ----------
    check
        Returns what is shown of a text.
    """

    def __init__(self, check: Callable[[str], View]) -> None:
        self._check = check
        self._running: dict[str, Event] = {}
        self._last: tuple[str, View] | None = None

    def view_of(self, text: str) -> View | None:
        """Return what is shown of a text; None while its check takes long, or waits for others.

        Called by one thread at a time.
        """
        if self._known(text) is None and text not in self._running and len(self._running) < _MOST:
            ended = self._running[text] = Event()
            Thread(target=self._run, args=(text, ended), daemon=True).start()
            ended.wait(_PATIENCE)
        return self._known(text)

    def _known(self, text: str) -> View | None:
        last = self._last
        return last[1] if last is not None and last[0] == text else None

    def _run(self, text: str, ended: Event) -> None:
        try:
            self._last = text, self._check(text)
        finally:
            del self._running[text]
            ended.set()
