"""Where a difference between two runs of one graph begins, and what follows from it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable
from dataclasses import dataclass, field
from typing import Generic, TypeVar

_Found = TypeVar("_Found")


@dataclass
class Spread(Generic[_Found]):
    """Combinations with another result, sorted into origins and followers.

    Attributes
    ----------
    origins : list
        What was found of combinations with another result although what feeds them has the same,
        or whose step itself is another; in the order of the graph.
    followers : Counter of str
        How many further combinations of each node have another result.
    """

    origins: list[_Found] = field(default_factory=list)
    followers: Counter[str] = field(default_factory=Counter)
    _steps: set[int] = field(default_factory=set, repr=False, compare=False, kw_only=True)

    @property
    def beyond(self) -> int:
        """Combinations with another result."""
        return len(self.origins) + self.followers.total()

    def reaches(self, needed: Iterable[int]) -> bool:
        """Whether any of these steps has another result."""
        return not self._steps.isdisjoint(needed)

    def add(
        self, found: _Found, node: str, step: int, needed: Collection[int], *, changed: bool
    ) -> None:
        """Sort in a combination with another result, after all that feeds it.

        Parameters
        ----------
        found
            What is kept of it if the difference begins with it.
        node
        step, needed
            Number of its step, and of those that feed it. A step may stand for several
            combinations, and is no source of itself.
        changed
            Whether the step itself is another.
        """
        if self.reaches(needed) and not changed:
            self.followers[node] += 1
        else:
            self.origins.append(found)
        self._steps.add(step)
