"""The form that the data of a lock has, checked once where a lock is read."""

from __future__ import annotations

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from nodegraph.misfit import first_misfit

_Name = Annotated[str, Field(min_length=1)]
_Label = str | int | float | bool
# a name of digits alone is read as a number where it is a key
_Texts = dict[_Label, str]
_Size = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Part(BaseModel):
    model_config = ConfigDict(strict=True)


class _Versions(_Part):
    model_config = ConfigDict(strict=True, extra="allow")
    __pydantic_extra__: dict[str, str]

    python: str


class _Choices(_Part):
    inputs: dict[str, Any] = Field({}, alias="set")
    axis: dict[str, Any] = {}
    only: dict[str, list[_Label]] = {}


class _Method(_Part):
    use: _Name
    plugin: _Name | None = None
    distribution: str = Field("", alias="from")
    code: str = ""
    axes: list[str] = []
    gathers: list[str] = []
    fed: dict[str, Any] = Field({}, alias="in")
    settings: dict[str, Any] = {}


class _Results(_Part):
    along: list[str] = []
    scale: dict[str, _Size] = {}
    steps: _Texts


class _Data(_Part):
    graph: _Name
    title: str
    tolerance: Annotated[float, Field(gt=0, lt=1)]
    choices: _Choices
    versions: _Versions
    inputs: dict[str, Any]
    axes: dict[str, list[_Label] | dict[_Label, Any]]
    removed: dict[str, list[_Label]]
    files: _Texts
    methods: dict[str, _Method]
    code: _Texts
    conclusions: dict[str, list[str]]
    tables: dict[str, str]
    results: dict[str, _Results]
    parts: dict[str, dict[str, _Texts]]
    text: Annotated[dict[_Name, str], Field(min_length=1)]


def misfit(data: Any) -> str:
    """Return which key of a lock's data is first of another form than it is written in, and how.

    Parameters
    ----------
    data
        As read from YAML.

    Returns
    -------
    str
        ``methods.fill=linear.use: input should be a valid string``; empty if all is well.
    """
    try:
        _Data.model_validate(data)
    except ValidationError as error:
        return first_misfit(error, data)
    return ""
