"""All that a plugin knows of a type of values, in one record."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from nodegraph.plugin.hook_types import CheckedRecord, Detail, Fact, Provenance, Rendered
from nodegraph.plugin.streaming import LiveView, Streamable


@dataclass(frozen=True)
class Kind(CheckedRecord):
    """All that a plugin knows of one type: how its values are shown, stored, compared, streamed.

    Everything but the type is optional. Of several plugins, the last that knows something of a
    type or of one of its bases counts, for each field by itself.

    Attributes
    ----------
    type : type
    render : callable
        ``render(value, title)`` returns a `Rendered`: how a value appears.
    render_in_run : callable
        ``render_in_run(value, title, origin)`` takes its place in the report of a run, and may
        use what the run knows of the value's `Provenance`.
    take_apart : callable
        Returns a value as a composition of `nodegraph.Value`, arrays, numbers, text, bytes, and
        tuples, lists and mappings of these, which are stored without pickle. A type that is one
        of them needs none.
    put_together : callable
        Returns the value again. What is stored may be damaged: whatever is raised for parts that
        `take_apart` does not return has the value computed again.
    faithful : bool
        Whether `put_together` returns an equal value. If not, it returns a stand-in that can only
        be shown, and a step that needs the value computes it again.
    lend : callable
        Returns what each reader gets, where a reader could modify the value itself.
    compare : callable
        ``compare(first, second)`` yields a sentence per difference in the terms of the field, the
        most important first; nothing if the two are the same. Values of other types are compared
        part by part.
    conclude : callable
        Yields a sentence per conclusion that a value supports, such as an order of methods,
        without measured numbers, so that it stays the same while the conclusion does.
    numbers : callable
        Returns the value's numbers as CSV with a header.
    data : callable
        Returns a value, numbers and all, as a mapping of plain data: what ``--json`` prints of it.
    facts : callable
        Yields what a reader wants to know of a value before anything is computed from it: each a
        `Fact`.
    stream, live_view, detail : callable
        Return a `Streamable`, a `LiveView` and a `Detail`; called when they are first needed.
    specimens : callable
        Returns small values by name, on which nodes are tested; values of several types that have
        the same name belong together.

    Raises
    ------
    ValueError
        If there is only one of `take_apart` and `put_together`.
    """

    type: type
    render: Callable[[Any, str], Rendered] | None = None
    render_in_run: Callable[[Any, str, Provenance], Rendered] | None = None
    take_apart: Callable[[Any], object] | None = None
    put_together: Callable[[Any], object] | None = None
    faithful: bool = True
    lend: Callable[[Any], object] | None = None
    compare: Callable[[Any, Any], Iterable[str]] | None = None
    conclude: Callable[[Any], Iterable[str]] | None = None
    numbers: Callable[[Any], str] | None = None
    data: Callable[[Any], Mapping[str, object]] | None = None
    facts: Callable[[Any], Iterable[Fact]] | None = None
    stream: Callable[[], Streamable] | None = None
    live_view: Callable[[], LiveView] | None = None
    detail: Callable[[], Detail] | None = None
    specimens: Callable[[], Mapping[str, object]] | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if (self.take_apart is None) != (self.put_together is None):
            raise ValueError("Kind: take_apart and put_together belong together")


def late(place: str) -> Callable[..., Any]:
    """Return a function that is imported when it is first called.

    A plugin names heavy modules in this way, so that commands that do not need them start fast.

    Examples
    --------
    >>> Kind(Lips, render=late("lips.report:render"))
    """

    def call(*arguments: object, **options: object) -> object:
        module, _, name = place.partition(":")
        return getattr(import_module(module), name)(*arguments, **options)

    return call
