"""What commands say of differences between two runs."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence

MOST = 12
"""Things of a kind that are told one by one."""


def counted(counts: Counter[str]) -> str:
    """Return how many combinations of each node there are: ``fill (4), total (1)``."""
    return ", ".join(f"{node} ({count})" for node, count in counts.items() if count)


def first_and_more(first: str, count: int, whole: str) -> str:
    """Return the name of the first of some, and how many more of a whole there are."""
    return f"{first} and {count - 1} more of {whole}" if count > 1 else first


def few(lines: Sequence[str], what: str = "") -> Iterator[str]:
    """Yield the first lines, and how many more there are of what."""
    yield from lines[:MOST]
    if len(lines) > MOST:
        yield f"and {len(lines) - MOST} more{f' {what}' if what else ''}"
