"""The parts of what hooks of plugins return: what is shown, formats, commands and promises."""

from __future__ import annotations

import json
import re
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from html import escape
from types import UnionType
from typing import Any, Literal, Protocol, get_args, get_origin, get_type_hints

from nodegraph.errors import listed
from nodegraph.node.ports import Label

_MOST_NAMES = 8
_SUFFIX = re.compile(r"(\.[A-Za-z0-9]{1,15}){1,2}")


def expect(value: object, hint: object) -> Any:
    """Return a value that is of an annotated type; its items are not looked at.

    Text and mappings are iterable, but never what an ``Iterable`` in a hook means.

    Raises
    ------
    TypeError
        If it is of another type.
    """
    hints = get_args(hint) if isinstance(hint, UnionType) else (hint,)
    if get_origin(hint) is Literal:
        if value not in get_args(hint):
            words = " or ".join(map(repr, get_args(hint)))
            raise TypeError(f"expected {words}, got {value!r}")
        return value
    kinds = tuple(get_origin(each) or each for each in hints)
    is_one_item = kinds == (Iterable,) and isinstance(value, (str, bytes, Mapping))
    if is_one_item or not isinstance(value, kinds):
        expected = " or ".join(kind.__name__ for kind in kinds)
        raise TypeError(f"expected {expected}, got {type(value).__name__}")
    return value


class CheckedRecord:
    """A record whose fields are checked when it is made.

    Raises
    ------
    TypeError
        If a field is of another type, with its name.
    """

    def __post_init__(self) -> None:
        kind: type = type(self)
        for name, hint in _hints(kind).items():
            try:
                expect(getattr(self, name), hint)
            except TypeError as error:
                raise TypeError(f"{kind.__name__}.{name}: {error}") from None


@cache
def _hints(kind: type) -> Mapping[str, object]:
    return get_type_hints(kind)


@dataclass(frozen=True)
class Grid:
    """A comparison as a terminal shows it: a row per method, a column per group.

    Attributes
    ----------
    title : str
    head : tuple of str
        The name of what is compared, then those of the columns; a name may have several lines.
    rows : tuple of tuple of str
        The method, then a number per column.
    best, tied : tuple of (row, column)
        The numbers that are clearly the best of their columns, and those of which each may be the
        best. Column 1 is the first with numbers.
    """

    title: str
    head: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    best: tuple[tuple[int, int], ...] = ()
    tied: tuple[tuple[int, int], ...] = ()


@dataclass(frozen=True)
class Rendered(CheckedRecord):
    """A value as it appears: HTML for the report, text for a terminal, files beside the report.

    Attributes
    ----------
    html : str
        A fragment, complete in itself, in which text from users is escaped.
    text : str
        A few plain lines; empty when the value is a picture.
    files : mapping of suffix to bytes
        For instance ``{".csv": ..., ".tex": ...}``: points, letters and digits.
    scripts, styles : tuple of str
        JavaScript and CSS that the fragment needs. A page has each text once, however many values
        need it. Scripts run in this order once the page is complete. Those that are no file
        ``.js`` of an installed package are left out of a report that is drawn again.
    answer : tuple of str
        Sentences with which the value answers the question of the study, for a terminal; the
        report begins with them where it has no lead.
    lead : str
        A fragment of HTML that answers the question at a glance. The first lead heads the report,
        others stand at the value.
    replaces : tuple of str
        Other outputs of the node that the fragment shows too: the report only links their files.
    grid : Grid, optional
        A table that a terminal shows in place of the text, and may shorten.
    title : str
        The value's own title: its heading, where the graph gives none.
    kind : {"", "table", "figure"}
        As what the report numbers it; empty for what has no number.

    Raises
    ------
    ValueError
        If a suffix is not like these, or differs from another in case only; or if a script or a
        style contains the tag that would end it in a page.
    """

    html: str
    text: str = ""
    files: Mapping[str, bytes] = field(default_factory=dict)
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()
    answer: tuple[str, ...] = ()
    lead: str = ""
    replaces: tuple[str, ...] = ()
    grid: Grid | None = None
    title: str = ""
    kind: Literal["", "table", "figure"] = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        for suffix, content in self.files.items():
            if not isinstance(suffix, str) or not isinstance(content, bytes):
                raise TypeError(f"Rendered.files[{suffix!r}]: expected a suffix and its bytes")
            if not _SUFFIX.fullmatch(suffix):
                raise ValueError(f"Rendered.files[{suffix!r}]: expected a suffix such as '.csv'")
        if len({suffix.lower() for suffix in self.files}) < len(self.files):
            suffixes = ", ".join(self.files)
            raise ValueError(f"Rendered.files: two suffixes differ in case only: {suffixes}")
        for tag, texts in (("script", self.scripts), ("style", self.styles)):
            if not all(isinstance(text, str) for text in texts):
                raise TypeError(f"Rendered.{tag}s: expected a tuple of str")
            if any(f"</{tag}" in text.lower() for text in texts):
                raise ValueError(f"Rendered.{tag}s: a {tag} in a page must not contain </{tag}")
        for name in ("answer", "replaces"):
            if not all(isinstance(text, str) for text in getattr(self, name)):
                raise TypeError(f"Rendered.{name}: expected a tuple of str")


@dataclass(frozen=True)
class Fact(CheckedRecord):
    """One fact of a value: ``Fact("rate", 60.0, "Hz")``.

    Attributes
    ----------
    name : str
        In words.
    value : number, str, sequence of str, or mapping of str to (mapping of str to number)
        A mapping is a table: a row per key, whose columns all rows have.
    unit : str
        The unit of a number.
    """

    name: str
    value: int | float | str | Sequence[str] | Mapping[str, Mapping[str, int | float]]
    unit: str = ""

    @property
    def text(self) -> str:
        """What is no table as text: ``60 Hz``, ``3: nose, chin, jaw``, ``none``."""
        if isinstance(self.value, str):
            return self.value
        if isinstance(self.value, (int, float)):
            return f"{_number_text(self.value)} {self.unit}".rstrip()
        return f"{len(self.value)}: {listed(self.value, _MOST_NAMES)}" if self.value else "none"

    @property
    def table(self) -> tuple[tuple[str, ...], ...]:
        """The rows of a table as text, the head first; none if it is no table."""
        if not isinstance(self.value, Mapping) or not self.value:
            return ()
        head = next(iter(self.value.values()))
        rows = ((name, *map(_number_text, row.values())) for name, row in self.value.items())
        return (("", *head), *rows)


def _number_text(value: float) -> str:
    return f"{value:,}" if isinstance(value, int) else f"{value:,.10g}"


def json_script(value: object, element_id: str) -> str:
    """Return an element that holds data for the scripts of a page.

    Parameters
    ----------
    value
        Numbers that are finite, text, None, and lists and mappings of these.
    element_id
        By which `page.data` finds it.

    Examples
    --------
    >>> json_script({"fill": "ridge", "rmse": 0.59}, "study")
    '<script type="application/json" id="study">{"fill": "ridge", "rmse": 0.59}</script>'
    """
    content = json.dumps(value, allow_nan=False, ensure_ascii=False).replace("<", "\\u003c")
    return f'<script type="application/json" id="{escape(element_id)}">{content}</script>'


PLACEHOLDERS = (
    "best", "tied", "behind", "better", "worse",
    "number", "interval", "difference", "count", "scope",
)  # fmt: skip


@dataclass(frozen=True)
class Placeholder:
    """A place in the author's answer: ``{best}``, ``{behind guenter at length=5}``.

    Attributes
    ----------
    name : str
        One of `PLACEHOLDERS`.
    label : str
        The method that the author names, or what is counted or subtracted; empty for the methods
        that there are.
    at : mapping of axis to text, optional
        Labels of the groups that it is about; None for all groups taken together.
    text : str
        As written.
    """

    name: str
    label: str
    at: Mapping[str, str] | None
    text: str


class Provenance(Protocol):
    """The origin of a value in a report: the part of the run that a renderer may read."""

    @property
    def node(self) -> str:
        """The node in the graph."""

    @property
    def labels(self) -> Mapping[str, object]:
        """The combination that the value stands for."""

    @property
    def caption(self) -> str:
        """The author's caption; empty without one."""

    @property
    def answer(self) -> tuple[str | Placeholder, ...]:
        """The author's answer, in parts; none without one.

        A renderer fills it in, or raises a `nodegraph.NodegraphError` that says what contradicts
        it; then it is called again without one.
        """

    def detail(self, value: object) -> Detail | None:
        """Return the view of single blocks whose scores read such a value; None without one."""

    def seconds(self, axis: str) -> Mapping[Label, Sequence[float]]:
        """Return the times of results by label of an axis; empty if no node has the name.

        The time of a result is that of its step and of the steps before it that not all labels of
        the axis need. The first call of a node may have compiled it, too.
        """

    def summaries(self, axis: str) -> Mapping[Label, str]:
        """Return the first lines of the documentation of methods that labels of an axis name.

        A label names a method that begins with its name, such as `savgol_4`; others have none, and
        neither have `pass` and an axis that is no node with alternatives.
        """

    def open_axes(self, labels: Mapping[str, Any]) -> Mapping[str, tuple[object, ...]]:
        """Return the gathered axes that labels leave open, each with its labels."""

    def inputs(self, labels: Mapping[str, Any]) -> Mapping[str, object] | None:
        """Return the inputs of the step behind a gathered value, by port.

        Parameters
        ----------
        labels
            Labels of the gathered axes; others are ignored. The value is that of the node's first
            port that gathers.

        Returns
        -------
        mapping or None
            None where a value is neither in memory nor stored, so that it had to be computed
            again, or where there is no such step.
        """

    def command(self, labels: Mapping[str, Any]) -> str:
        """Return the command that computes the step behind a gathered value; empty without one."""


@dataclass(frozen=True)
class Detail(CheckedRecord):
    """Shows one block of a comparison: what each method made of it.

    It is that of the type of the first input of the steps that scored the blocks.

    Attributes
    ----------
    pack : callable
        ``pack(block, inputs)`` returns what the view of a block shows, as data for `json_script`,
        or None if it has nothing to show. ``block`` maps columns such as ``marker`` and ``start``
        to labels, ``inputs`` maps each method to what its score read, by port.
    layout : callable
        ``layout(inputs, column)`` returns where the labels of a column lie, or None:
        ``{"title": "on the face", "names": [...], "points": [[x, y], ...], "edges": [[i, j], ...],
        "regions": {name: [i, ...]}}``, y upwards; ``inputs`` is what one score read.
    module : str
        The module of a script whose ``show(element, packed, context)`` draws what was packed.
    scripts, styles : tuple of str
        JavaScript and CSS that the view needs.
    """

    pack: Callable[
        [Mapping[str, Any], Mapping[str, Mapping[str, Any]]], Mapping[str, object] | None
    ]
    layout: Callable[[Mapping[str, Any], str], Mapping[str, object] | None]
    module: str
    scripts: tuple[str, ...] = ()
    styles: tuple[str, ...] = ()


@dataclass(frozen=True)
class Viewer(CheckedRecord):
    """Shows values of some types together on a page, as a reader looks at files.

    Attributes
    ----------
    types : tuple of type
    view : callable
        ``view(values)`` takes values of these types by label and returns a `Rendered`. A
        `nodegraph.Refusal` says why there is nothing to see.
    beside : str
        What ends the name of a file beside a viewed one, such as ``.marks.csv``: scripts of the
        page write it through the module ``server``, ``keep(label, text)``, and what it holds is
        viewed with the file. Empty where nothing is kept.
    """

    types: tuple[type, ...]
    view: Callable[[Mapping[str, Any]], Rendered]
    beside: str = ""


@dataclass(frozen=True)
class Format(CheckedRecord):
    """Reads values of one type from files of one format.

    Attributes
    ----------
    name : str
        As messages write it: ``C3D``.
    type : type
    suffixes : tuple of str
        In lower case, with the dot. A folder is searched for a file with the first.
    read : callable
        ``read(path, **options)`` returns the value. Which options there are depends on the type;
        a ``ValueError``, which names the file, is a message to users.
    recognizes : callable
        ``recognizes(start)`` returns whether a file that begins with these bytes, 1024 unless it
        is shorter, is of the format. By default, only the suffix counts.

    Raises
    ------
    ValueError
        If there are no suffixes, or one is not of that form.
    """

    name: str
    type: type
    suffixes: tuple[str, ...]
    read: Callable[..., Any]
    recognizes: Callable[[bytes], bool] = lambda start: False

    def __post_init__(self) -> None:
        super().__post_init__()
        for suffix in self.suffixes or ("",):
            if not isinstance(suffix, str) or suffix[:1] != "." or suffix != suffix.lower():
                raise ValueError(f"Format.suffixes: {suffix!r} is not of the form '.c3d'")


@dataclass(frozen=True)
class Command(CheckedRecord):
    """A command of the command line: ``nodegraph NAME``.

    Attributes
    ----------
    help : str
        A sentence for ``nodegraph help``.
    add_arguments : callable
        ``add_arguments(parser)`` declares the arguments on an `argparse.ArgumentParser`, which
        has ``--plugin`` already.
    call : callable
        ``call(arguments)`` runs the command with an `argparse.Namespace` and returns the exit
        status: 0, or 1 if something failed. The message of a `nodegraph.NodegraphError` is
        printed, and the status is 2.
    """

    help: str
    add_arguments: Callable[[ArgumentParser], None]
    call: Callable[[Namespace], int]


@dataclass(frozen=True)
class Tried:
    """One call of a node by its tests, as a contract sees it.

    Attributes
    ----------
    inputs, outputs : mapping of port to value
        An optional port that was left open is absent.
    settings : mapping of setting to value
        All of them, defaults included.
    units : mapping of setting to text
        Units of the settings that have one: ``mm``.
    doc : str
        The node's documentation, which may exempt the node from a promise.
    lookahead : int or None
        How many frames ahead the node's result may depend on; None if any.
    meets_ends : bool
        Whether the node declares that its result meets both ends of a gap.
    again : callable
        Calls the node again with other inputs, ``again(recording=moved)``, and other settings,
        ``again({"gate": 4.0}, recording=moved)``; returns its outputs, or None if the node
        refuses these.
    """

    inputs: Mapping[str, Any]
    outputs: Mapping[str, Any]
    settings: Mapping[str, Any]
    units: Mapping[str, str]
    doc: str
    lookahead: int | None
    meets_ends: bool
    again: Callable[..., Mapping[str, Any] | None]


Contract = Callable[[Tried], Iterable[str]]
"""A promise of a family: its docstring states it, and it yields a sentence per violation."""
