"""Everything that a plugin can add, on one screen.

A plugin is a module, named in the entry point group ``nodegraph``, that implements any of these
hooks with `hookimpl`. Each is called once, when the plugin is first needed.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pluggy

GROUP = "nodegraph"
hookspec = pluggy.HookspecMarker(GROUP)
hookimpl = pluggy.HookimplMarker(GROUP)


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
    ValueError
        If a script or a style has in it what would end it in a page.
    """

    html: str
    text: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict)
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        for kind, texts in (("script", self.scripts), ("style", self.styles)):
            if any(f"</{kind}" in text.lower() for text in texts):
                raise ValueError(f"a {kind} in a page must not contain </{kind}")


@dataclass(frozen=True)
class Renderer:
    """Shows the values of one type. ``render(value, title)`` returns a `Rendered`."""

    type: type
    render: Callable[[Any, str], Rendered]


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
    """

    type: type
    take_apart: Callable[[Any], Any]
    put_together: Callable[[Any], Any]
    faithful: bool = True
    lend: Callable[[Any], Any] | None = None


Parts = Mapping[str, tuple[tuple[str, tuple[str, ...]], ...]]
"""Of each array of a value, by its name: for each of its first axes a word, and names."""


@dataclass(frozen=True)
class Comparison:
    """Says in the words of its field how two values of one type differ.

    ``compare(one, other)`` yields a sentence per difference, the most telling first; nothing
    where the two are the same. What has no comparison is compared part by part.

    ``parts(value)``, if given, says of a value's arrays, by their names, what their first axes
    are: a word for one member, and the members' names if they have any, as in
    ``{"positions": (("frame", ()), ("marker", value.markers))}``. By that a lock can tell where
    two values differ of which it has only one.
    """

    type: type
    compare: Callable[[Any, Any], Iterable[str]]
    parts: Callable[[Any], Parts] | None = None


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
    """

    type: type
    conclude: Callable[[Any], Iterable[str]]
    numbers: Callable[[Any], str]


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


@hookspec
def nodegraph_nodes() -> Iterable[Callable[..., Any]]:  # type: ignore[empty-body]
    """Return the plugin's nodes: functions decorated with `nodegraph.node`."""


@hookspec
def nodegraph_bibtex() -> str:  # type: ignore[empty-body]
    """Return the BibTeX entries that the plugin's nodes cite."""


@hookspec
def nodegraph_renderers() -> Iterable[Renderer]:  # type: ignore[empty-body]
    """Return how values of the plugin's types appear in a report."""


@hookspec
def nodegraph_comparisons() -> Iterable[Comparison]:  # type: ignore[empty-body]
    """Return how values of the plugin's types are told apart."""


@hookspec
def nodegraph_conclusions() -> Iterable[Conclusion]:  # type: ignore[empty-body]
    """Return what a study concludes from values of the plugin's types."""


@hookspec
def nodegraph_storages() -> Iterable[Storage]:  # type: ignore[empty-body]
    """Return how values of the plugin's types are kept."""


@hookspec
def nodegraph_executors() -> Mapping[str, Callable[..., Any]]:  # type: ignore[empty-body]
    """Return further ways to compute steps, by name: see `nodegraph.execute.Executor`."""


@hookspec
def nodegraph_places() -> Mapping[str, Callable[[str], Path]]:  # type: ignore[empty-body]
    """Return, for ``scheme`` in a path ``scheme:name``, what finds the file or folder.

    The function raises `nodegraph.errors.NodegraphError` for a name that it does not have.
    """


@hookspec
def nodegraph_graphs() -> Iterable[Path]:  # type: ignore[empty-body]
    """Return the example graphs that the plugin ships."""


@hookspec
def nodegraph_templates() -> Mapping[str, Path]:  # type: ignore[empty-body]
    """Return what ``nodegraph new`` writes, by kind: ``plugin``, ``graph``.

    A folder whose files are written with ``{{name}}`` replaced, in their text and in their paths;
    ``.template`` at the end of a name is taken off.
    """


@hookspec
def nodegraph_specimens() -> Mapping[type, Callable[[], Mapping[str, Any]]]:  # type: ignore[empty-body]
    """Return what makes small values of the plugin's types, to test nodes on.

    Each has a name; values of several types that have one name belong together.
    """


@hookspec
def nodegraph_contracts() -> Mapping[str, Iterable[Contract]]:  # type: ignore[empty-body]
    """Return what every node of a family promises, whoever wrote it."""
