"""Counts of a stream: frames in and out, missing, late and dropped, and latencies."""

from __future__ import annotations

from bisect import bisect_left
from collections import Counter
from collections.abc import Hashable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import accumulate
from typing import Any

from nodegraph.live.running_numbers import Latest

_BITS = 5
"""Latencies are counted in steps of 1/32 of their size, in memory that does not grow."""
QUANTILES = {"p50": 0.5, "p99": 0.99, "p99.9": 0.999}


class Latencies:
    """A histogram of latencies."""

    def __init__(self) -> None:
        self._counts = [0] * (64 << _BITS)
        self._longest = 0

    def add(self, nanoseconds: int) -> None:
        """Count a latency."""
        size = max(nanoseconds, 1).bit_length() - 1
        shift = size - _BITS
        part = (nanoseconds >> shift if shift > 0 else nanoseconds << -shift) & ((1 << _BITS) - 1)
        self._counts[size << _BITS | part] += 1
        self._longest = max(self._longest, nanoseconds)

    def since(self, earlier: Latencies) -> Latencies:
        """Return those that were counted after an earlier copy; their maximum is rounded up."""
        later = Latencies()
        later._counts = [
            now - then for now, then in zip(self._counts, earlier._counts, strict=True)
        ]
        place = max((place for place, count in enumerate(later._counts) if count), default=-1)
        later._longest = min(round(_upper(place)), self._longest) if place >= 0 else 0
        return later

    def milliseconds(self) -> dict[str, float]:
        """Return quantiles and maximum, each at most 1/32 too large; nothing without latencies."""
        seen = list(accumulate(self._counts))
        if not seen[-1]:
            return {}
        quantiles = {}
        for name, share in QUANTILES.items():
            limit = _upper(bisect_left(seen, share * seen[-1]))
            quantiles[name] = min(limit, self._longest) / 1e6
        return {**quantiles, "max": self._longest / 1e6}


def _upper(place: int) -> float:
    """Return the nanoseconds below which what is counted at a place lies."""
    size, part = place >> _BITS, place & ((1 << _BITS) - 1)
    return float(((1 << _BITS) + part + 1) * 2.0 ** (size - _BITS))


class Causes:
    """Counts of events by the line of code that they come from, each with its last text.

    Texts may differ from frame to frame; lines are few, so that memory does not grow.
    """

    def __init__(self) -> None:
        self._counts: Counter[Hashable] = Counter()
        self._texts: dict[Hashable, str] = {}

    def add(self, line: Hashable, text: str) -> None:
        """Count what comes from a line."""
        self._counts[line] += 1
        self._texts[line] = text

    def __iter__(self) -> Iterator[tuple[str, int]]:
        """Yield the last text of each line, and how often it happened."""
        return ((text, self._counts[line]) for line, text in self._texts.items())

    def as_json(self) -> dict[str, int]:
        """Return the counts by the last texts."""
        counts: Counter[str] = Counter()
        for text, count in self:
            counts[text] += count
        return dict(counts)


@dataclass
class Counts:
    """The counts of a stream so far.

    Attributes
    ----------
    received : int
        Frames that arrived.
    computed : int
        Frames that were computed, missing ones included.
    missing : int
        Frames that never arrived and were computed as missing.
    late, repeated : int
        Frames that arrived after their turn, or twice; they were dropped.
    dropped : int
        Frames that the policy ``newest`` left out.
    undecodable : int
        Packets that could not be decoded.
    resets : int
        How often the stream restarted: its numbers jumped, frames were dropped, or the source was
        connected again.
    reconnected : int
    refused : Causes
        Frames that a node refused, with the node and its reason.
    warnings : Causes
        Warnings of nodes.
    written, unsent : Counter of str
        Frames that each sink took, and those that it could not.
    running : mapping of step to Latest
        The numbers that are kept current, since the stream began or restarted.
    latencies : Latencies
        From the arrival of a frame until every sink has what can be computed with it. Counting
        begins when all that arrived while the stream was being opened has been worked off.
    """

    received: int = 0
    computed: int = 0
    missing: int = 0
    late: int = 0
    repeated: int = 0
    dropped: int = 0
    undecodable: int = 0
    resets: int = 0
    reconnected: int = 0
    refused: Causes = field(default_factory=Causes)
    warnings: Causes = field(default_factory=Causes)
    written: Counter[str] = field(default_factory=Counter)
    unsent: Counter[str] = field(default_factory=Counter)
    running: dict[str, Latest] = field(default_factory=dict)
    latencies: Latencies = field(default_factory=Latencies)

    def as_json(self) -> Mapping[str, Any]:
        """Return the counts as plain data; latencies in milliseconds."""
        numbers = {name: getattr(self, name) for name in NUMBERS}
        return {
            **numbers,
            "refused": self.refused.as_json(),
            "warnings": self.warnings.as_json(),
            "written": dict(self.written),
            "unsent": dict(self.unsent),
            "running": {name: latest.as_json() for name, latest in self.running.items()},
            "latency_ms": self.latencies.milliseconds(),
        }


NUMBERS = (
    "received", "computed", "missing", "late", "repeated", "dropped", "undecodable", "resets",
    "reconnected",
)  # fmt: skip
