"""The content of a lock as typed data, which is written and read."""

from __future__ import annotations

from typing import Annotated

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PlainSerializer,
    PlainValidator,
)

from nodegraph.lock.locked_result import LockedResult


def _text_keys(value: object) -> object:
    """Return plain data with texts as keys: YAML reads a key of digits as a number."""
    if isinstance(value, dict):
        return {str(key): _text_keys(item) for key, item in value.items()}
    return [_text_keys(item) for item in value] if isinstance(value, list) else value


def _has_python(versions: dict[str, str]) -> dict[str, str]:
    if "python" not in versions:
        raise ValueError("python is missing")
    return versions


def _result(value: object) -> LockedResult:
    if isinstance(value, LockedResult):
        return value
    if isinstance(value, str):
        return LockedResult.read(value)
    raise ValueError("input should be a valid string")


def _result_text(value: LockedResult) -> str:
    return value.text


_Name = Annotated[str, Field(min_length=1)]
_Key = Annotated[str, BeforeValidator(str)]
_Label = str | int | float | bool
_Plain = Annotated[object, BeforeValidator(_text_keys)]
_Texts = dict[_Key, str]
_Size = Annotated[float, Field(gt=0, allow_inf_nan=False)]
_Recorded = Annotated[LockedResult, PlainValidator(_result), PlainSerializer(_result_text)]


class _Model(BaseModel):
    model_config = ConfigDict(strict=True, frozen=True, populate_by_name=True)


class LockedChoices(_Model):
    """The choices of the command."""

    inputs: dict[str, object] = Field({}, alias="set")
    axis: dict[str, object] = {}
    only: dict[str, list[_Label]] = {}


class LockedMethod(_Model):
    """A method of a node: where it comes from, what feeds it, and its settings."""

    use: _Name
    plugin: str = ""
    distribution: str = Field("", alias="from")
    code: str = ""
    axes: list[str] = []
    gathers: list[str] = []
    inputs: dict[str, str | _Texts] = Field({}, alias="in")
    settings: dict[str, _Plain] = {}

    @property
    def full_name(self) -> str:
        """The name with the plugin, if it comes from one."""
        return f"{self.plugin}:{self.use}" if self.plugin else self.use


class LockedResults(_Model):
    """The results of a node or alternative.

    Attributes
    ----------
    along : list of str
        The axes whose labels name a combination.
    scale : dict of place to float
        Usual size of the floats there.
    steps : dict of labels to LockedResult
    """

    along: list[str] = []
    scale: dict[str, _Size] = {}
    steps: dict[_Key, _Recorded]


class _Study(_Model):
    graph: _Name
    title: str
    tolerance: Annotated[float, Field(gt=0, lt=1)]
    choices: LockedChoices


class Provenance(_Model):
    """Everything that decides the results of a run.

    Attributes
    ----------
    versions : dict of distribution to str
        Also of Python, and the platform.
    inputs, axes : dict
        Those of the graph.
    removed : dict of axis to list
        Labels that the command left out.
    files : dict of name to str
        Digests of the contents.
    methods : dict of node or alternative to LockedMethod
    code : dict of module to str
        Digests; also of functions without a file.
    """

    versions: Annotated[dict[str, str], AfterValidator(_has_python)]
    inputs: dict[str, _Plain]
    axes: dict[str, list[_Label] | dict[_Key, _Plain]]
    removed: dict[str, list[_Label]]
    files: _Texts
    methods: dict[str, LockedMethod]
    code: _Texts


class LockedStudy(Provenance, _Study):
    """The content of a lock; its fields have the order of the file.

    Attributes
    ----------
    graph : str
        Path of the graph file from the folder of the lock.
    title : str
    tolerance : float
        Relative size of differences that do not count.
    choices : LockedChoices
    conclusions : dict of reported value to list of str
    tables : dict of reported value to str
        As CSV.
    results : dict of node or alternative to LockedResults
    text : dict of file to str
        The graph file, and those that it includes.
    """

    conclusions: dict[str, list[str]]
    tables: dict[str, str]
    results: dict[str, LockedResults]
    text: Annotated[dict[_Name, str], Field(min_length=1)]

    def recorded(self, group: str, labels: str) -> LockedResult | None:
        """Return the result of a combination, if the lock has it."""
        results = self.results.get(group)
        return results.steps.get(labels) if results is not None else None
