"""Names in a message."""

from __future__ import annotations

from collections.abc import Sequence

_MOST = 10


def listed(names: Sequence[str]) -> str:
    """Return the names for a sentence, no more than can be read."""
    more = f" and {len(names) - _MOST} more" if len(names) > _MOST else ""
    return (", ".join(names[:_MOST]) or "none") + more
