"""Marker sets: which markers are a pair, on the midline, stable, and joined when drawn."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph import Value
from nodegraph_mocap.checks import twice

if TYPE_CHECKING:
    from collections.abc import Iterable


@dataclass(frozen=True, kw_only=True)
class MarkerSet(Value):
    """Knowledge of a face's markers beside their positions.

    Attributes
    ----------
    markers : tuple of str
    pairs : tuple of (left, right)
    midline : tuple of str
    stable : tuple of str
        Landmarks that speech and expression hardly move.
    edges : tuple of (first, second)
        Lines to draw.

    Raises
    ------
    ValueError
        If a pair, the midline, a landmark or an edge names a marker that the set lacks, or a
        name is listed twice.
    """

    markers: tuple[str, ...]
    pairs: tuple[tuple[str, str], ...] = ()
    midline: tuple[str, ...] = ()
    stable: tuple[str, ...] = ()
    edges: tuple[tuple[str, str], ...] = ()

    def __post_init__(self) -> None:
        repeated = twice(self.markers)
        if repeated:
            raise ValueError(f"marker set: listed twice: {', '.join(repeated)}")
        known = set(self.markers)
        for part, names in self._named():
            unknown = sorted(set(names) - known)
            if unknown:
                raise ValueError(f"marker set: {part} names unknown markers: {', '.join(unknown)}")

    def keep(self, names: Iterable[str]) -> MarkerSet:
        """Return the set with these markers only; what names another is left out."""
        markers = tuple(names)
        known = set(markers)
        return MarkerSet(
            markers=markers,
            pairs=tuple(pair for pair in self.pairs if known.issuperset(pair)),
            midline=tuple(name for name in self.midline if name in known),
            stable=tuple(name for name in self.stable if name in known),
            edges=tuple(edge for edge in self.edges if known.issuperset(edge)),
        )

    def _named(self) -> tuple[tuple[str, tuple[str, ...]], ...]:
        return (
            ("pairs", tuple(name for pair in self.pairs for name in pair)),
            ("midline", self.midline),
            ("stable", self.stable),
            ("edges", tuple(name for edge in self.edges for name in edge)),
        )
