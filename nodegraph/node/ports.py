"""Annotations in a node's signature, ports, which types fit each other, and gathered values."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any, Generic, NamedTuple, TypeVar

from nodegraph.node.declaration import Declared

T = TypeVar("T")
T_co = TypeVar("T_co", covariant=True)

Label = str | int | float | bool
"""A label on an axis. The empty text stands where a gathered value does not have the axis."""


class Unit(NamedTuple):
    """The unit of a setting, shown wherever the setting is: ``Annotated[float, Unit("mm")]``."""

    name: str


class Deprecated(NamedTuple):
    """Marks a setting that another replaces, with what to use instead.

    ``Annotated[int | None, Deprecated("use max_gap")] = None``. It works as before; graphs that
    set it get a notice.
    """

    instead: str


class Columns:
    """Declares the columns of a table at an output: ``Annotated[Table, Columns("rmse")]``.

    The table never has others, whatever the inputs and settings, so that a graph that names
    another is refused before anything runs. Omit it if the columns depend on the data.
    """

    def __init__(self, *names: str) -> None:
        self.names = names


class ColumnOf(NamedTuple):
    """Marks a setting that names a column of the tables at a port, or several.

    ``Annotated[str | None, ColumnOf("scores")]``. With `or_axis`, it may also name an axis that
    the port gathers. A graph that names a column that cannot exist is refused, and so is one whose
    settings `apart_from` name the same. If `independent`, an axis must have two labels at least,
    and the data must differ along it.
    """

    port: str
    or_axis: bool = False
    apart_from: tuple[str, ...] = ()
    independent: bool = False


class LabelOf(NamedTuple):
    """Marks a setting that names a label of an axis that a port gathers.

    ``Annotated[str | None, LabelOf("scores", axis="compare")]``: of the axis that the setting
    `axis` names, or of any axis if it names none. A graph without such a label is refused.
    """

    port: str
    axis: str


class TruthMark:
    """Marks a port that takes or gives the truth."""


class FileMark:
    """Marks a setting that names a file to read."""


Truth = Annotated[T, TruthMark()]
"""A port that takes or gives the truth. A plain value may feed it.

The truth feeds a plain port only of a node that damages it: one with a truth output of its own.
"""

InputFile = Annotated[Path, FileMark()]
"""A setting that names a file to read; in a graph file, relative to that file."""


@dataclass(frozen=True, slots=True)
class Absent:
    """A combination without a value, and why: ``refused``, ``failed`` or ``skipped``."""

    labels: Mapping[str, Label]
    kind: str
    reason: str


@dataclass(frozen=True, slots=True)
class Across(Generic[T_co]):
    """The values of a source over the axes that are gathered, each with its labels.

    Attributes
    ----------
    axes : tuple of str
        The gathered axes.
    entries : tuple of (mapping of axis to label, value)
        In the order in which the graph lists the labels.
    absent : tuple of Absent
        Combinations that were refused, failed or skipped.
    known : mapping of axis to labels
        Every label that the graph has, including those that were not selected; see `labels`.
    sources : tuple of str or None
        The gathered axes along which the data themselves differ: they choose what a node without
        inputs reads or makes. Along the others, the same data are treated in several ways. None
        where that is not known.
    unused : tuple of (tuple of str)
        For each entry, the gathered axes that nothing in it depends on, such as one that only
        another method's settings have: the entry stands at each label of it, with one value. Empty
        where every entry depends on all axes.
    methods : mapping of axis to mapping of label to Declared
        Declarations of the alternatives of a gathered axis.
    fields : mapping of ``axis.field`` to mapping of label to label
        Properties that labels of an axis have in common, such as ``recording.actor``.
    synthetic : bool
        Whether all data behind the values are made by a generator, not recorded.
    units : mapping of axis to str
        Units of the labels that have one: those of the settings that take them.
    files : tuple of str
        Names of the files that the data are read from; a sample's name for one that is shipped.
    """

    axes: tuple[str, ...]
    entries: tuple[tuple[Mapping[str, Label], T_co], ...]
    absent: tuple[Absent, ...] = ()
    known: Mapping[str, tuple[Label, ...]] = field(default_factory=dict)
    sources: tuple[str, ...] | None = None
    unused: tuple[tuple[str, ...], ...] = ()
    methods: Mapping[str, Mapping[Label, Declared]] = field(default_factory=dict)
    fields: Mapping[str, Mapping[Label, Label]] = field(default_factory=dict)
    synthetic: bool = False
    units: Mapping[str, str] = field(default_factory=dict)
    files: tuple[str, ...] = ()

    @staticmethod
    def of(
        values: Mapping[Any, T], *, axis: str, sources: tuple[str, ...] | None = None
    ) -> Across[T]:
        """Gather values along one axis by hand, to call a node directly."""
        entries = tuple(({axis: label}, value) for label, value in values.items())
        return Across((axis,), entries, sources=sources)

    def __len__(self) -> int:
        return len(self.entries)

    def __iter__(self) -> Iterator[tuple[Mapping[str, Label], T_co]]:
        return iter(self.entries)

    def values(self) -> tuple[T_co, ...]:
        """Return the values alone, in order."""
        return tuple(value for _, value in self.entries)

    def labels(self, axis: str) -> tuple[Label, ...]:
        """Return every label that an axis has in the graph, whichever are gathered here.

        Colours that are assigned in this order are the same for a method in every figure.
        """
        if axis in self.known:
            return self.known[axis]
        gathered = (*(labels for labels, _ in self), *(absent.labels for absent in self.absent))
        return tuple(dict.fromkeys(labels.get(axis, "") for labels in gathered))

    def names(self) -> tuple[str, ...]:
        """Return one text per value: its labels that are not empty, joined by commas."""
        return tuple(label_text(labels) for labels, _ in self.entries)


def label_text(labels: Mapping[str, Label]) -> str:
    """Return labels as one text, for legends: ``muscle, 45``."""
    return ", ".join(str(label) for label in labels.values() if label != "")


@dataclass(frozen=True, slots=True)
class Port:
    """One input or output of a node.

    Attributes
    ----------
    name : str
    type : type
        The type of one value; for a gathering port, of each gathered value.
    truth, across, optional : bool
        Whether the port takes or gives the truth, gathers over axes, may be left open.
    columns : tuple of str
        The columns that a table from this output may have; empty if they are not declared.
    """

    name: str
    type: type
    truth: bool = False
    across: bool = False
    optional: bool = False
    columns: tuple[str, ...] = ()

    @property
    def kind(self) -> str:
        """What it takes or gives, as in a signature: ``Truth[Trajectories] | None``."""
        text = self.type.__name__
        text = f"Across[{text}]" if self.across else text
        text = f"Truth[{text}]" if self.truth else text
        return text + (" | None" if self.optional else "")

    def __str__(self) -> str:
        return f"{self.name}: {self.kind}"


def mismatch(source: Port, target: Port) -> str | None:
    """Return why a source cannot feed a target, or None if it can."""
    if source.truth and not target.truth:
        return f"{source.name!r} gives the truth to {target.name!r}, which must not see it"
    if not issubclass(source.type, target.type):
        return f"{target.name!r} takes {target.type.__name__}, not {source.type.__name__}"
    return None
