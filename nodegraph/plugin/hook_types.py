"""What the hooks of plugins return: how values are shown, kept, told apart and concluded from."""

from __future__ import annotations

import reprlib
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from types import NoneType
from typing import Any

_brief = reprlib.Repr()
_brief.maxother = 80
brief = _brief.repr
"""Returns how anything is written in Python, shortened where it is long."""

_WORDS: Mapping[Any, str] = {
    bool: "true or false",
    str: "a text",
    type: "a type",
    tuple: "a tuple",
    Mapping: "a mapping",
    Callable: "a function",
    NoneType: "None",
}


def _check(one: Any, **kinds: Any) -> None:
    """Refuse an object of a hook that has something of another type than is due."""
    for name, kind in kinds.items():
        given = getattr(one, name)
        if not isinstance(given, kind):
            due = " or ".join(
                _WORDS[each] for each in (kind if isinstance(kind, tuple) else [kind])
            )
            raise TypeError(f"{type(one).__name__}: {name} must be {due}, not {brief(given)}")


@dataclass(frozen=True)
class Rendered:
    """How a value appears: HTML for the report, text for a terminal, files beside the report.

    Attributes
    ----------
    html : str
        A fragment, complete in itself; what came from users is already escaped.
    text : str
        A few plain lines; empty when the value is a picture.
    files : mapping of suffix to bytes
        For instance ``{".csv": ..., ".tex": ...}``.
    scripts, styles : tuple of str
        JavaScript and CSS that the fragment needs: each text stands once in a page, however many
        values bring it. Scripts run in this order when all of the page is there.

    Raises
    ------
    TypeError
        If something is of another type.
    ValueError
        If a script or a style has in it what would end it in a page.
    """

    html: str
    text: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict)
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        _check(self, html=str, text=str, files=Mapping, scripts=tuple, styles=tuple)
        for suffix, content in self.files.items():
            if not isinstance(suffix, str) or not isinstance(content, bytes):
                raise TypeError(f"Rendered: of files, {suffix!r} is not a suffix with its bytes")
        for kind, texts in (("script", self.scripts), ("style", self.styles)):
            if not all(isinstance(text, str) for text in texts):
                raise TypeError(f"Rendered: each of the {kind}s must be a text")
            if any(f"</{kind}" in text.lower() for text in texts):
                raise ValueError(f"a {kind} in a page must not contain </{kind}")


@dataclass(frozen=True)
class Renderer:
    """Shows the values of one type.

    Attributes
    ----------
    type : type
    render : callable
        ``render(value, title)`` returns a `Rendered`.

    Raises
    ------
    TypeError
        If something is of another type.
    """

    type: type
    render: Callable[[Any, str], Rendered]

    def __post_init__(self) -> None:
        _check(self, type=type, render=Callable)


@dataclass(frozen=True)
class Storage:
    """How values of one type are kept on disk and sent to other processes, without pickle.

    Values that derive from `nodegraph.Value`, arrays, numbers, texts, bytes, and tuples, lists and
    mappings of these need none.

    Attributes
    ----------
    type : type
    take_apart : callable
        Returns what the value is made of, as such plain values.
    put_together : callable
        Returns the value again.
    faithful : bool
        Whether what `put_together` returns is the value itself. If not, it is a stand-in that
        can be shown, and whoever needs the value has it computed again.
    lend : callable, optional
        Returns what one reader gets, where a reader could change the value itself.

    Raises
    ------
    TypeError
        If something is of another type.
    """

    type: type
    take_apart: Callable[[Any], Any]
    put_together: Callable[[Any], Any]
    faithful: bool = True
    lend: Callable[[Any], Any] | None = None

    def __post_init__(self) -> None:
        _check(self, type=type, take_apart=Callable, put_together=Callable, faithful=bool)
        _check(self, lend=(Callable, NoneType))


Parts = Mapping[str, tuple[tuple[str, tuple[str, ...]], ...]]
"""Of each array of a value, by its name: for each of its first axes a word, and names."""


@dataclass(frozen=True)
class Comparison:
    """Says in the words of its field how two values of one type differ.

    Attributes
    ----------
    type : type
    compare : callable
        ``compare(one, other)`` yields a sentence per difference, the most telling first; nothing
        where the two are the same. What has no comparison is compared part by part.
    parts : callable, optional
        ``parts(value)`` returns of a value's arrays, by their names, what their first axes are: a
        word for one member, and the members' names if they have any, as in
        ``{"positions": (("frame", ()), ("marker", value.markers))}``. By that a lock can tell
        where two values differ of which it has only one.

    Raises
    ------
    TypeError
        If something is of another type.
    """

    type: type
    compare: Callable[[Any, Any], Iterable[str]]
    parts: Callable[[Any], Parts] | None = None

    def __post_init__(self) -> None:
        _check(self, type=type, compare=Callable, parts=(Callable, NoneType))


@dataclass(frozen=True)
class Conclusion:
    """Says what readers take from values of one type, as a study quotes it.

    Attributes
    ----------
    type : type
    conclude : callable
        Yields a sentence per conclusion that the value supports, such as an order of methods. It
        has no measured number in it, so that it stays the same while the conclusion does.
    numbers : callable
        Returns the value's numbers as CSV with a head.

    Raises
    ------
    TypeError
        If something is of another type.
    """

    type: type
    conclude: Callable[[Any], Iterable[str]]
    numbers: Callable[[Any], str]

    def __post_init__(self) -> None:
        _check(self, type=type, conclude=Callable, numbers=Callable)


@dataclass(frozen=True)
class Tried:
    """One call of a node by its tests, as a contract sees it.

    Attributes
    ----------
    inputs, outputs : mapping of port to value
        What went in and what came out. An optional port that was left open is absent.
    settings : mapping of setting to value
        All of them, defaults included.
    units : mapping of setting to text
        Of those settings that have one: ``mm``.
    doc : str
        The node's documentation, in which it may say what it does not promise.
    again : callable
        Calls the node again with other inputs, ``again(recording=moved)``, and other settings,
        ``again({"gate": 4.0}, recording=moved)``; returns its outputs, or None where the node
        refuses these.
    """

    inputs: Mapping[str, Any]
    outputs: Mapping[str, Any]
    settings: Mapping[str, Any]
    units: Mapping[str, str]
    doc: str
    again: Callable[..., Mapping[str, Any] | None]


Contract = Callable[[Tried], Iterable[str]]
"""A promise of a family: its docstring says it, and it yields whatever breaks it."""
