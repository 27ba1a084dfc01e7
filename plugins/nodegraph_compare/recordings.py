"""The recordings behind a comparison, as they say of themselves what they are."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

from nodegraph import Value, listed
from nodegraph_compare.actors import ACTOR
from nodegraph_tables import info_of
from nodegraph_tables.numbers import SPACE

if TYPE_CHECKING:
    from collections.abc import Iterable

    from nodegraph import Across
    from nodegraph_mocap import Table

_MOST_FILES = 2

Span = tuple[float, ...]
"""The least and the most, once where they are the same; empty where nothing is known."""


@dataclass(frozen=True)
class Recordings(Value):
    """The recordings behind a comparison.

    Attributes
    ----------
    files : tuple of str
        Their names.
    synthetic : bool
        Whether all are made by a generator.
    actors : int
        How many they are of; 0 where no field of an axis says who is recorded.
    seconds, markers, rates : tuple of float
        The least and the most of them; once where they are the same, none where they are unknown.
    """

    files: tuple[str, ...] = ()
    synthetic: bool = False
    actors: int = 0
    seconds: Span = ()
    markers: Span = ()
    rates: Span = ()

    @property
    def rate(self) -> float:
        """Hz of all recordings; 0 where they differ, or are unknown."""
        return self.rates[0] if len(self.rates) == 1 else 0.0

    @property
    def sizes(self) -> str:
        """Length, markers and rate: ``8 s, 60 markers, 60 Hz``."""
        spans = ((self.seconds, "s"), (self.markers, "markers"), (self.rates, "Hz"))
        return ", ".join(
            f"{' to '.join(f'{end:.3g}' for end in span)}{SPACE}{unit}"
            for span, unit in spans
            if span
        )

    @property
    def names(self) -> str:
        """Names of files, where there are few."""
        few = 0 < len(self.files) <= _MOST_FILES
        return listed([name for name in self.files]) if few else ""


def recordings_of(scores: Across[Table]) -> Recordings:
    """Return what the recordings behind tables of scores say of themselves."""
    every = {poses for table in scores.values() if (poses := info_of(table).poses) is not None}
    names = [f"{axis}.{ACTOR}" for axis in scores.sources or ()]
    actors = [scores.fields[name] for name in names if name in scores.fields]
    moving = [poses for poses in every if poses.frames > 1]
    return Recordings(
        scores.files,
        scores.synthetic,
        len({actor for of in actors for actor in of.values()}),
        _span(round(poses.frames / poses.rate, 1) for poses in moving),
        _span(len(poses.markers) for poses in every if poses.markers),
        _span(poses.rate for poses in moving),
    )


def _span(values: Iterable[float]) -> Span:
    known = sorted({float(value) for value in values})
    return tuple(dict.fromkeys([*known[:1], *known[-1:]]))
