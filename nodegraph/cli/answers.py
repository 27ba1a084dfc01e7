"""What commands print with ``--json``: a record for each, from which its JSON Schema is made."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, is_dataclass
from typing import Any

from nodegraph.node.description import ShownSetting
from nodegraph.node.ports import Label

Labels = Mapping[str, Label]


@dataclass(frozen=True)
class Result:
    """A reported result.

    Attributes
    ----------
    node, output : str
        Names in the graph.
    labels : mapping of axis to label
    data : mapping
        What a plugin says of the value; of a table: ``columns``, ``rows`` (a list per
        row, null for a number that is missing), ``units`` and ``better`` by column, ``best`` and
        ``tied`` (by column, the rows that are clearly the best and those that each may be),
        ``cells``: the columns that hold the interval and the p of another, and ``answer``: its
        ``sentence``, ``scope`` and ``certainty``, and of each of its ``groups`` whether there is a
        ``verdict``, which methods are ``best`` by it, ``tied`` (others that may be as good),
        ``behind`` and ``first`` by the mean, and their ``mean``, ``low``, ``high`` and ``p``;
        ``overall`` is the same of all groups taken together, or null.
    """

    node: str
    output: str
    labels: Labels
    data: Mapping[str, object]


@dataclass(frozen=True)
class Note:
    """Steps that failed, were refused or left out, or gave a warning, for one reason.

    Attributes
    ----------
    node : str
    methods : list of str
    reason : str
    count : int
    """

    node: str
    methods: Sequence[str]
    reason: str
    count: int


@dataclass(frozen=True)
class RunAnswer:
    """What ``nodegraph run --json`` prints.

    Attributes
    ----------
    title : str
    ok : bool
        Whether no step failed.
    folder, report : str
    answer : list of str
        The sentences with which the report begins.
    results : list of Result
    steps : mapping of str to int
        How many steps ended in each way.
    seconds : float
    failed, refused, left_out, warnings : list of Note
    files : list of str
        In the folder.
    """

    title: str
    ok: bool
    folder: str
    report: str
    answer: Sequence[str]
    results: Sequence[Result]
    steps: Mapping[str, int]
    seconds: float
    failed: Sequence[Note]
    refused: Sequence[Note]
    left_out: Sequence[Note]
    warnings: Sequence[Note]
    files: Sequence[str]


@dataclass(frozen=True)
class PlannedNode:
    """A node of a graph that was checked.

    Attributes
    ----------
    node : str
    uses : list of str
        Its methods.
    axes : mapping of axis to labels
    steps, stored : int
    """

    node: str
    uses: Sequence[str]
    axes: Mapping[str, Sequence[Label]]
    steps: int
    stored: int


@dataclass(frozen=True)
class CheckAnswer:
    """What ``nodegraph check --json`` prints.

    Attributes
    ----------
    title : str
    steps, stored, skipped : int
        Steps, those that are stored, and combinations that are skipped.
    nodes : list of PlannedNode
    left_out, warnings : list of str
    """

    title: str
    steps: int
    stored: int
    skipped: int
    nodes: Sequence[PlannedNode]
    left_out: Sequence[str]
    warnings: Sequence[str]


@dataclass(frozen=True)
class ExplainedStep:
    """Why a step is stored or not.

    Attributes
    ----------
    node : str
    labels : mapping of axis to label
    stored : bool
    changes : list of str
        Since the earlier run; if there are none, why there is no result all the same.
    """

    node: str
    labels: Labels
    stored: bool
    changes: Sequence[str]


@dataclass(frozen=True)
class WhyAnswer:
    """What ``nodegraph check --why NODE --json`` prints.

    Attributes
    ----------
    node : str
    run : str
        The earlier run.
    steps : list of ExplainedStep
    """

    node: str
    run: str
    steps: Sequence[ExplainedStep]


@dataclass(frozen=True)
class ListedNode:
    """An installed node.

    Attributes
    ----------
    name, plugin, distribution, summary : str
    """

    name: str
    plugin: str
    distribution: str
    summary: str


@dataclass(frozen=True)
class ShownPort:
    """An input or output of a node.

    Attributes
    ----------
    name, type : str
    optional, gathers, truth : bool
    """

    name: str
    type: str
    optional: bool
    gathers: bool
    truth: bool


@dataclass(frozen=True)
class ShowAnswer:
    """What ``nodegraph show --json`` prints: a node, or the list of those that a word applies to.

    Attributes
    ----------
    nodes : list of ListedNode
    inputs, outputs : list of ShownPort
        The ports of the node that was named, as is all that follows.
    settings : list of ShownSetting
    declares : list of str
    documentation : str
    cites : list of str
        Formatted references.
    """

    nodes: Sequence[ListedNode]
    inputs: Sequence[ShownPort] = ()
    outputs: Sequence[ShownPort] = ()
    settings: Sequence[ShownSetting] = ()
    declares: Sequence[str] = ()
    documentation: str = ""
    cites: Sequence[str] = ()


@dataclass(frozen=True)
class ShownFact:
    """A fact of what a file holds.

    Attributes
    ----------
    name : str
    value : number, str, list of str, or mapping of str to (mapping of str to number)
        A mapping is a table: a row per key.
    unit : str
    """

    name: str
    value: object
    unit: str


@dataclass(frozen=True)
class FileAnswer:
    """What ``nodegraph show FILE --json`` prints.

    Attributes
    ----------
    file : str
        As it was named.
    format, node : str
        Its format, and the node that reads it.
    facts : list of ShownFact
    warnings : list of str
        What reading it had to guess, or left out.
    """

    file: str
    format: str
    node: str
    facts: Sequence[ShownFact]
    warnings: Sequence[str]


@dataclass(frozen=True)
class ListedRun:
    """A run in a folder.

    Attributes
    ----------
    folder : str
    ended : str
        Local time, ISO 8601.
    state : str
        ``done``, ``failed``, ``running``, ``writing its report``, ``interrupted``, or why it
        cannot be read.
    title, command : str
    answer : list of str
    """

    folder: str
    ended: str
    state: str
    title: str
    command: str
    answer: Sequence[str]


@dataclass(frozen=True)
class RunsAnswer:
    """What ``nodegraph runs --json`` prints.

    Attributes
    ----------
    runs : list of ListedRun
        The latest first.
    """

    runs: Sequence[ListedRun]


@dataclass(frozen=True)
class FirstDifference:
    """Combinations of a node with which a difference begins, all of which changed in one way.

    Attributes
    ----------
    node : str
    labels : list of (mapping of axis to label)
        The labels of each combination.
    changes : list of str
        Changes of method, settings, files, sources and code.
    versions : list of str
        Changes of distributions that its code reaches, of Python, and of the platform.
    distance : float
        Root mean square difference relative to the usual size, of the combination that differs
        most; 0 if unknown.
    text : str
        Further differences.
    values : list of str
        How the values of the first combination differ, if both are stored.
    """

    node: str
    labels: Sequence[Labels]
    changes: Sequence[str]
    versions: Sequence[str]
    distance: float
    text: str
    values: Sequence[str]


@dataclass(frozen=True)
class DiffAnswer:
    """What ``nodegraph diff --json`` prints.

    Attributes
    ----------
    was, now : str
        The folders.
    same : bool
        Whether all combinations have the same results.
    equal, beyond, unknown : int
        How many combinations have the same result, another, and one that was not stored.
    choices : list of str
        Inputs and axes that changed.
    only_was, only_now, follow, harmless : mapping of node to int
        How many combinations only one run has, follow from the origins, or have the same result
        although they changed.
    origins : list of FirstDifference
    """

    was: str
    now: str
    same: bool
    equal: int
    beyond: int
    unknown: int
    choices: Sequence[str]
    only_was: Mapping[str, int]
    only_now: Mapping[str, int]
    follow: Mapping[str, int]
    harmless: Mapping[str, int]
    origins: Sequence[FirstDifference]


@dataclass(frozen=True)
class VerifyAnswer:
    """What ``nodegraph verify --json`` prints.

    Attributes
    ----------
    lock : str
    grade : str
        ``identical``, ``within tolerance``, ``same conclusions`` or ``diverged``.
    holds : bool
        Whether the study still has its results and its conclusions.
    identical, near, beyond, unknown : int
        How many combinations have the same result to the bit, one within the tolerance, another,
        and one that cannot be stored.
    tolerance : float
    farthest : float
        The largest distance of those within the tolerance, relative to their usual size.
    changes : list of str
        Changes of the study as a whole.
    only_locked, only_now : list of str
        Combinations that only the lock has, or only this run.
    origins : list of FirstDifference
    follow : mapping of node to int
    conclusions, tables : list of str
        Conclusions and tables that changed.
    """

    lock: str
    grade: str
    holds: bool
    identical: int
    near: int
    beyond: int
    unknown: int
    tolerance: float
    farthest: float
    changes: Sequence[str]
    only_locked: Sequence[str]
    only_now: Sequence[str]
    origins: Sequence[FirstDifference]
    follow: Mapping[str, int]
    conclusions: Sequence[str]
    tables: Sequence[str]


@dataclass(frozen=True)
class Repeated:
    """The repetition of the steps of a method.

    Attributes
    ----------
    node, method, grade : str
    worst, of : int
        How many of its steps have that grade, the worst, and how many were repeated.
    text : str
    """

    node: str
    method: str
    grade: str
    worst: int
    of: int
    text: str


@dataclass(frozen=True)
class RepeatAnswer:
    """What ``nodegraph verify --repeat --json`` prints.

    Attributes
    ----------
    holds : bool
        Whether every method gives the same result again.
    methods : list of Repeated
    """

    holds: bool
    methods: Sequence[Repeated]


@dataclass(frozen=True)
class StoredResult:
    """A stored result.

    Attributes
    ----------
    node, step, state : str
    bytes : int
    seconds : float
        Duration of the computation.
    used : float
        When it was used last, in seconds since 1970.
    """

    node: str
    step: str
    state: str
    bytes: int
    seconds: float
    used: float


@dataclass(frozen=True)
class CacheAnswer:
    """What ``nodegraph cache --json`` prints.

    Attributes
    ----------
    folder : str
    results, files, bytes : int
        Amounts that there are now, or that are left.
    removed_results, removed_bytes : int
    listed : list of StoredResult
        With ``list``: those that were used last.
    """

    folder: str
    results: int
    files: int
    bytes: int
    removed_results: int = 0
    removed_bytes: int = 0
    listed: Sequence[StoredResult] = ()


@dataclass(frozen=True)
class CiteAnswer:
    """What ``nodegraph cite --json`` prints.

    Attributes
    ----------
    texts : mapping of file to str
        Methods, settings and BibTeX, as Markdown and as LaTeX.
    not_cited : list of str
        Methods that gave no result.
    """

    texts: Mapping[str, str]
    not_cited: Sequence[str]


ANSWERS: Mapping[str, tuple[type, ...]] = {
    "run": (RunAnswer,),
    "check": (CheckAnswer, WhyAnswer),
    "show": (ShowAnswer, FileAnswer),
    "runs": (RunsAnswer,),
    "diff": (DiffAnswer,),
    "verify": (VerifyAnswer, RepeatAnswer),
    "cache": (CacheAnswer,),
    "cite": (CiteAnswer,),
}
"""What each command prints with ``--json``; the second with an option, or for a file."""


def print_json(answer: object) -> None:
    """Print a record as JSON; a number that is not finite is null."""
    print(json.dumps(_plain(answer), indent=1))


def answer_schema(command: str) -> dict[str, Any]:
    """Return the JSON Schema of what a command prints with ``--json``."""
    from pydantic import TypeAdapter

    kinds = ANSWERS[command]
    kind: Any = kinds[0] if len(kinds) == 1 else kinds[0] | kinds[1]
    schema = TypeAdapter(kind).json_schema(mode="serialization")
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", **schema}


def _plain(value: object) -> object:
    if is_dataclass(value) and not isinstance(value, type):
        return {each.name: _plain(getattr(value, each.name)) for each in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(item) for item in value]
    if isinstance(value, float) and not math.isfinite(value):
        return None
    return value if value is None or isinstance(value, (str, int, float)) else str(value)
