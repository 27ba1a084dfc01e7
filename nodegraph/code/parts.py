"""What is kept of a module: its statements as digests and references, and what binds a name."""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

WHOLE_MODULE = frozenset({"eval", "exec", "globals"})
"""With these, code can reach any name of its module."""


class Part(NamedTuple):
    """One statement at the top of a module.

    Attributes
    ----------
    digest : str
        Of its syntax, without comments, docstrings and places.
    references : tuple of str
        Names that it takes from its module, with attributes (``np.linalg.norm``), and what it
        imports itself (``package.module:name.attribute``).
    first, last : int
        Its lines, counted from 1, decorators included.
    defines : bool
        Whether it is a function or a class, by itself.
    """

    digest: str
    references: tuple[str, ...]
    first: int
    last: int
    defines: bool = False


class Summary(NamedTuple):
    """What a module binds, and how.

    Attributes
    ----------
    parts : tuple of Part
    names : mapping of name to numbers of parts
        Every part that binds or changes the name, in their order.
    imports : mapping of name to targets
        ``module:name``, or ``module:`` for a module itself; relative ones begin with dots.
    stars : tuple of str
        Modules of which every name is imported.
    statements : tuple of int
        Parts that do something when the module is imported, whatever name is asked for.
    effects : tuple of str
        What else is run when the module is imported, as references.
    trouble : str
        Why the file cannot be read.
    """

    parts: tuple[Part, ...] = ()
    names: Mapping[str, tuple[int, ...]] = MappingProxyType({})
    imports: Mapping[str, tuple[str, ...]] = MappingProxyType({})
    stars: tuple[str, ...] = ()
    statements: tuple[int, ...] = ()
    effects: tuple[str, ...] = ()
    trouble: str = ""


def short_digest(*texts: object) -> str:
    """Return 16 hexadecimal digits for the written form of plain values."""
    return hashlib.sha256(repr(texts).encode("utf-8", "surrogatepass")).hexdigest()[:16]


def to_plain(summary: Summary) -> dict[str, Any]:
    """Return a summary as what JSON can hold."""
    return {
        "parts": [
            [part.digest, list(part.references), part.first, part.last, part.defines]
            for part in summary.parts
        ],
        "names": {name: list(numbers) for name, numbers in summary.names.items()},
        "imports": {name: list(targets) for name, targets in summary.imports.items()},
        "stars": list(summary.stars),
        "statements": list(summary.statements),
        "effects": list(summary.effects),
    }


def from_plain(plain: Any) -> Summary:
    """Return the summary again.

    Raises
    ------
    TypeError, ValueError, KeyError
        If it is none.
    """
    parts = tuple(_part(*one) for one in plain["parts"])
    return Summary(
        parts=parts,
        names={name: _numbers(some, len(parts)) for name, some in plain["names"].items()},
        imports={name: _texts(some) for name, some in plain["imports"].items()},
        stars=_texts(plain["stars"]),
        statements=_numbers(plain["statements"], len(parts)),
        effects=_texts(plain["effects"]),
    )


def _part(digest: Any, references: Any, first: Any, last: Any, defines: Any) -> Part:
    if not (isinstance(digest, str) and type(first) is type(last) is int):
        raise TypeError("not a part")
    return Part(digest, _texts(references), first, last, bool(defines))


def _texts(some: Iterable[Any]) -> tuple[str, ...]:
    texts = tuple(some)
    if isinstance(some, str) or not {str}.issuperset(map(type, texts)):
        raise TypeError("not texts")
    return texts


def _numbers(some: Iterable[Any], count: int) -> tuple[int, ...]:
    numbers = tuple(some)
    if not ({int}.issuperset(map(type, numbers)) and set(range(count)).issuperset(numbers)):
        raise ValueError("not numbers of parts")
    return numbers
