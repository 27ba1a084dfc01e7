"""How two values of one output differ, in words."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

from nodegraph.equality import difference
from nodegraph.hooks import Comparison


def told_apart(one: Any, other: Any, comparisons: Iterable[Comparison]) -> tuple[str, ...]:
    """Return a sentence per difference of two values; nothing where they are the same.

    Parameters
    ----------
    one, other
        Of any type.
    comparisons
        Those that plugins bring; the first that fits says it. What none of them tells apart is
        compared part by part.
    """
    fitting = (kind for kind in comparisons if isinstance(one, kind.type))
    said = next((tuple(kind.compare(one, other)) for kind in fitting if _alike(kind, other)), ())
    rest = difference(one, other)
    return said or ((rest,) if rest else ())


def _alike(kind: Comparison, value: Any) -> bool:
    return isinstance(value, kind.type)
