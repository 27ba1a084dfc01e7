"""What users may read: every mistake has a place, what is wrong and what there is instead."""

from __future__ import annotations

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple


class Place(NamedTuple):  # of all that is frozen, a tuple is made fastest
    """Where something was written: a file, a line and a column, counted from 1."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


@dataclass(frozen=True, slots=True)
class Problem:
    """One mistake: its place, what is wrong, and what there is instead."""

    place: Place
    message: str
    instead: str = ""

    def __str__(self) -> str:
        hint = f"\n    {self.instead}" if self.instead else ""
        return f"{self.place}: {self.message}{hint}"


class NodegraphError(Exception):
    """Any mistake that a user can mend; its text says how."""


class GraphError(NodegraphError):
    """A graph, or the command that names it, is wrong; nothing has run.

    Attributes
    ----------
    problems : tuple of Problem
        Every mistake found, in the order of their places.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        unique = dict.fromkeys(problems)
        self.problems = tuple(sorted(unique, key=_reading_order))
        super().__init__("\n".join(str(problem) for problem in self.problems))


class NodeError(NodegraphError):
    """A function cannot be a node as it is declared."""


class UnknownNodeError(NodegraphError):
    """No installed node has the name, or several have it."""


class Refusal(NodegraphError):
    """Raised by a node that cannot do what is asked of this data: no failure, but counted.

    Examples
    --------
    >>> raise Refusal("needs one complete frame")
    Traceback (most recent call last):
    nodegraph.errors.Refusal: needs one complete frame
    """


class Problems:
    """Collects mistakes, so that all of them are told at once."""

    def __init__(self, found: Iterable[Problem] = ()) -> None:
        self._found: list[Problem] = list(found)

    def __bool__(self) -> bool:
        return bool(self._found)

    def add(self, place: Place, message: str, instead: str = "") -> None:
        """Note one mistake and go on."""
        self._found.append(Problem(place, message, instead))

    def all(self) -> tuple[Problem, ...]:
        """Return what was noted so far."""
        return tuple(self._found)

    def raise_any(self) -> None:
        """Raise a `GraphError` with all that was noted, if anything was."""
        if self._found:
            raise GraphError(self._found)


def nearest(name: object, known: Iterable[object], *, what: str = "there is") -> str:
    """Return a hint: the nearest known name, then all that there are."""
    names = [str(one) for one in known]
    if not names:
        return f"{what} none"
    close = closest(name, names)
    guess = f"did you mean {close!r}? " if close else ""
    return f"{guess}{what}: {listed(names)}"


def closest(name: object, known: Iterable[object]) -> str:
    """Return the known name that is most like a name, upper or lower case; empty if none is."""
    lower = {str(one).lower(): str(one) for one in known}
    close = difflib.get_close_matches(str(name).lower(), lower, n=1, cutoff=0.6)
    return lower[close[0]] if close else ""


def listed(names: Iterable[object], most: int = 20) -> str:
    """Return names for a sentence: the first of them, and how many more there are.

    Parameters
    ----------
    names
        Anything that says its name as text.
    most
        How many are named.

    Examples
    --------
    >>> listed(["chin", "brow", "nose"], most=2)
    'chin, brow, and 1 more'
    >>> listed([])
    'none'
    """
    every = [str(one) for one in names]
    more = f", and {len(every) - most} more" if len(every) > most else ""
    return (", ".join(every[:most]) or "none") + more


def _reading_order(problem: Problem) -> tuple[str, int, int]:
    return (problem.place.file, problem.place.line, problem.place.column)
