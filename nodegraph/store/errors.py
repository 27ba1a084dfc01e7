"""What cannot be stored, and what cannot be read."""

from __future__ import annotations

from nodegraph.errors import NodegraphError


class Unstorable(NodegraphError):
    """A value cannot be kept without pickle.

    Attributes
    ----------
    kind : str
        The type that cannot be kept.
    inside : tuple of str
        The types that hold it, from the inside out.
    """

    def __init__(self, kind: str, why: str = "no plugin says how to keep it") -> None:
        self.kind = kind
        self.why = why
        self.inside: tuple[str, ...] = ()
        super().__init__(kind, why)

    def __str__(self) -> str:
        where = "".join(f" inside {place}" for place in self.inside)
        return f"a value of type {self.kind}{where} cannot be kept: {self.why}"


class Unreadable(NodegraphError):
    """Stored data cannot be read."""


class UnknownClass(Unreadable):
    """A value is of a class that is not here: its plugin may not be loaded."""
