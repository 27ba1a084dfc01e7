"""Errors that users may see: each names the place, what is wrong, and what there is instead."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable
from typing import NamedTuple

Hint = str | Callable[[], str]
"""A text, or what returns it: to find the nearest name takes time, and not every error is shown."""


class Place(NamedTuple):
    """A file, with a line and a column counted from 1; or a command-line option."""

    file: str
    line: int = 0
    column: int = 0

    def __str__(self) -> str:
        return f"{self.file}:{self.line}:{self.column}" if self.line else self.file


class Problem(NamedTuple):
    """One error in a graph: its place, what is wrong, and what there is instead."""

    place: Place
    message: str
    hint: Hint = ""

    @property
    def instead(self) -> str:
        """What there is instead, as text."""
        return self.hint if isinstance(self.hint, str) else self.hint()

    def __str__(self) -> str:
        instead = self.instead
        hint = f"\n    {one_line(instead)}" if instead else ""
        return f"{self.place}: {one_line(self.message)}{hint}"


_LONGEST = 2000
_LONGEST_NAME = 60
_MOST_SHOWN = 20
_MOST_AT_PLACE = 2


def one_line(text: str) -> str:
    """Return a message as one line, without the middle of a very long one.

    Names and values that it quotes may have any length, and line breaks.
    """
    return without_middle(" ".join(text.splitlines()), _LONGEST)


def without_middle(text: str, longest: int) -> str:
    """Return a text of some length at most: what is longer, with … in place of its middle."""
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]} … {text[-half:]}"


def quoted(value: object) -> str:
    """Return a name or a value as Python writes it, with … in place of the middle of a long one.

    Examples
    --------
    >>> quoted("chin")
    "'chin'"
    """
    return without_middle(repr(value), _LONGEST_NAME)


class NodegraphError(Exception):
    """Base class of errors that a user can correct, with a message that says how."""


class GraphError(NodegraphError):
    """A graph, or the command that names it, is wrong; nothing has run.

    Attributes
    ----------
    problems : tuple of Problem
        All errors, in the order of their places.
    """

    def __init__(self, problems: Iterable[Problem]) -> None:
        unique = {(problem.place, problem.message): problem for problem in problems}
        self.problems = tuple(sorted(unique.values(), key=lambda problem: problem.place))
        super().__init__("\n".join([*map(str, self.first), *self.more]))

    @property
    def first(self) -> tuple[Problem, ...]:
        """The errors that a message shows: of many at one place, the first."""
        at_place: Counter[Place] = Counter()
        shown = []
        for problem in self.problems:
            at_place[problem.place] += 1
            if at_place[problem.place] <= _MOST_AT_PLACE or not problem.place.line:
                shown.append(problem)
        return tuple(shown[:_MOST_SHOWN])

    @property
    def more(self) -> tuple[str, ...]:
        """How many errors a message does not show, as a line; none if it shows all."""
        rest = len(self.problems) - len(self.first)
        return (f"and {rest:,} more; correct these first",) if rest else ()


class NodeError(NodegraphError):
    """A function is not declared as a node must be."""


class UnknownNodeError(NodegraphError):
    """Raised if no installed node has the name, or several have it.

    Attributes
    ----------
    message : str
        Without what there is instead.
    hint : str or callable
    """

    def __init__(self, message: str, hint: Hint = "") -> None:
        super().__init__(message)
        self.message = message
        self.hint = hint

    def __str__(self) -> str:
        instead = self.hint if isinstance(self.hint, str) else self.hint()
        return f"{self.message}; {instead}" if instead else self.message


class Refusal(NodegraphError):
    """Raised by a node that cannot process this data: not a failure, but counted.

    Examples
    --------
    >>> raise Refusal("needs one complete frame")
    Traceback (most recent call last):
    nodegraph.errors.Refusal: needs one complete frame
    """


class Problems:
    """Collects errors, so that all of them are reported at once."""

    def __init__(self, problems: Iterable[Problem] = ()) -> None:
        self._problems: list[Problem] = list(problems)

    def __bool__(self) -> bool:
        return bool(self._problems)

    def add(self, place: Place, message: str, instead: Hint = "") -> None:
        """Note one error and continue."""
        self._problems.append(Problem(place, message, instead))

    def extend(self, problems: Iterable[Problem]) -> None:
        """Note errors that were found elsewhere."""
        self._problems.extend(problems)

    def all(self) -> tuple[Problem, ...]:
        """Return the errors noted so far."""
        return tuple(self._problems)

    def raise_any(self) -> None:
        """Raise a `GraphError` with all errors noted so far, if there are any."""
        if self._problems:
            raise GraphError(self._problems)


def message_of(error: BaseException) -> str:
    """Return the message of an error, whose class may be a plugin's and raise another."""
    try:
        return str(error)
    except Exception:
        return "its message cannot be shown"


def nearest(name: object, known: Iterable[object], *, what: str = "there is") -> str:
    """Return a hint: the nearest known name, then all known names."""
    names = [str(each) for each in known]
    if not names:
        return f"{what} none"
    close = closest(name, names)
    guess = f"did you mean {close!r}? " if close else ""
    return f"{guess}{what}: {listed(names)}"


def closest(name: object, known: Iterable[object]) -> str:
    """Return the known name that is most similar, in any case; empty if none is similar."""
    import difflib

    by_lower = {str(each).lower(): str(each) for each in known}
    text = str(name).lower()
    close = difflib.get_close_matches(text, by_lower, n=3, cutoff=0.6)
    # letters in another order are the likelier mistake
    close.sort(key=lambda each: sorted(each) != sorted(text))
    return by_lower[close[0]] if close else ""


def listed(names: Iterable[object], most: int = 20) -> str:
    """Return the first names as text, each without the middle of a long one, and how many more.

    Parameters
    ----------
    names
        Strings, or objects whose ``str()`` is their name.
    most
        How many are named.

    Examples
    --------
    >>> listed(["chin", "brow", "nose"], most=2)
    'chin, brow, and 1 more'
    >>> listed([])
    'none'
    """
    texts = [without_middle(str(name), _LONGEST_NAME) for name in names]
    more = f", and {len(texts) - most} more" if len(texts) > most else ""
    return (", ".join(texts[:most]) or "none") + more
