"""A store for a run that uses no stored result."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

from nodegraph.execute.recall import AUDITED
from nodegraph.store import Store


class Afresh(Store):
    """A store without results, which knows what audits found as another one does.

    Parameters
    ----------
    folder
        An empty one.
    known
        Knows what audits found.
    say
        As that of any store.
    """

    def __init__(self, folder: Path, known: Store, say: Callable[[str], None]) -> None:
        super().__init__(folder, known.packer, say)
        self._known = known

    def recall(self, name: str) -> dict[str, Any]:
        """Return what was remembered here; of audits, there."""
        return self._known.recall(name) if name.startswith(AUDITED) else super().recall(name)
