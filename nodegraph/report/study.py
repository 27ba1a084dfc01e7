"""What a report says, as plain data, before it becomes a page."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from nodegraph.describe import SettingText
from nodegraph.hooks import Rendered


@dataclass(frozen=True)
class Section:
    """One value that the report shows.

    Attributes
    ----------
    title : str
        The node, and its combination where it has several.
    name : str
        For file names and links.
    rendered : Rendered
    """

    title: str
    name: str
    rendered: Rendered

    @property
    def files(self) -> Mapping[str, bytes]:
        """File name -> content."""
        return {f"{self.name}{suffix}": one for suffix, one in self.rendered.files.items()}


@dataclass(frozen=True)
class MethodRow:
    """One method that took part.

    Attributes
    ----------
    node, use, plugin, summary : str
    settings : tuple of (SettingText, value)
        The value as it was used; several values are joined.
    references : tuple of str
    """

    node: str
    use: str
    plugin: str
    summary: str
    settings: tuple[tuple[SettingText, str], ...]
    references: tuple[str, ...]


@dataclass(frozen=True)
class Note:
    """Something that happened to some steps of a node, for one reason."""

    node: str
    reason: str
    combinations: tuple[str, ...]
    trace: str = ""


@dataclass(frozen=True)
class Timing:
    """How long the steps of one node took."""

    node: str
    use: str
    steps: int
    seconds: float


@dataclass(frozen=True)
class Study:
    """Everything that a report says.

    Attributes
    ----------
    title, notes : str
        As the graph file has them; notes are Markdown.
    answer : tuple of str
        What the results say, in sentences.
    sections : tuple of Section
    drawing : str
        The graph as SVG.
    axes : mapping of axis to labels, as text
    inputs : mapping of input to value, as text
    known : tuple of str
        What methods were allowed to know.
    methods : tuple of MethodRow
    failed, refused, skipped, left_out, warned : tuple of Note
    counts : mapping of state to number of steps
    timings : tuple of Timing
    seconds : float
    versions : mapping of name to version
    command, graph_text : str
        How to run it again.
    """

    title: str
    notes: str = ""
    answer: tuple[str, ...] = ()
    sections: tuple[Section, ...] = ()
    drawing: str = ""
    axes: Mapping[str, str] = field(default_factory=dict)
    inputs: Mapping[str, str] = field(default_factory=dict)
    known: tuple[str, ...] = ()
    methods: tuple[MethodRow, ...] = ()
    failed: tuple[Note, ...] = ()
    refused: tuple[Note, ...] = ()
    skipped: tuple[Note, ...] = ()
    left_out: tuple[Note, ...] = ()
    warned: tuple[Note, ...] = ()
    counts: Mapping[str, int] = field(default_factory=dict)
    timings: tuple[Timing, ...] = ()
    seconds: float = 0.0
    versions: Mapping[str, str] = field(default_factory=dict)
    command: str = ""
    graph_text: str = ""
