"""Whatever a setting's type is, no value that the loader takes is refused."""

from __future__ import annotations

import datetime
import enum
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from typing import Annotated, Any, Literal

import pytest
from jsonschema import Draft202012Validator
from pydantic import BeforeValidator, Field, Strict

from nodegraph import InputFile, Unit, node
from tests.nodegraph.graphfile.conftest import Judge, settings_of


class Colour(enum.Enum):
    RED = "red"
    BLUE = "blue"


@dataclass(frozen=True)
class Bounds:
    p: int
    q: float | None = None


def listed(value: object) -> Any:
    return [value] if isinstance(value, int) else value


TYPES: dict[str, object] = {
    "whole": int,
    "bounded": Annotated[int, Field(ge=1, le=9)],
    "number": float,
    "open": Annotated[float, Field(gt=0, lt=float("inf"))],
    "truth": bool,
    "short": Annotated[str, Field(min_length=1, max_length=2)],
    "pattern": Annotated[str, Field(pattern="^(auto|[+-][xyz])$")],
    "choice": Literal["a", "b"],
    "mixed": Literal["a", 1, 2],
    "enum": Colour,
    "either": Annotated[int, Field(ge=1)] | Literal["ring"] | None,
    "numbers": float | int,
    "nested": Annotated[list[list[Annotated[float, Field(ge=0)]]], Field(min_length=1)],
    "pair": tuple[int, float],
    "few": Annotated[frozenset[int], Field(max_length=1)],
    "iterable": Iterable[int],
    "mapping": dict[str, Annotated[int, Field(ge=0)]],
    "record": Bounds,
    "records": list[Bounds] | Bounds,
    "date": datetime.date,
    "file": InputFile | None,
    "before": Annotated[list[int], BeforeValidator(listed)],
    "lax": Annotated[int, Strict(False)],
    "class": range,
}
WORDS = (
    "", "a", "b", "p", "q", "auto", "+x", "A", "ring", "red", "1", "12", "1.5", "٣", "x\n", "$",
    "$5", "$v", "$w.x", "2020-01-01", "2020-01-01 10:00", "P1D", "1:00:00", "true", "null", "a.txt",
)  # fmt: skip
SCALARS = (None, True, False, -1, 0, 1, 2, 10, 0.3, 0.5, 1.0, 3.0, -1.5, 1e30, *WORDS)


def setting_of(kind: object, default: object = ..., name: str = "toy.set") -> Callable[..., object]:
    """Return a node whose one setting has this type."""

    def make(*, value: object = default) -> float:
        raise AssertionError

    make.__annotations__ = {"value": kind, "return": float}
    if default is ...:
        make.__kwdefaults__ = None
    return node(name)(make)


@node("toy.any")
def anything(*, value: Any, other: Any) -> float:
    """Use the input and the axis, which the loader wants used."""
    raise AssertionError


def graph(value: object, start: object = 1) -> dict[str, Any]:
    return {
        "nodegraph": 1,
        "inputs": {"v": start},
        "axes": {"w": {"a": {"x": 1}}},
        "nodes": {
            "used": {"use": "toy.any", "with": {"value": "$v", "other": "$w.x"}},
            "a": {"use": "toy.set", "with": {"value": value}},
        },
    }


@pytest.fixture(scope="session")
def judge(judge_of: Callable[..., Judge]) -> Callable[[str], Judge]:
    return lru_cache(maxsize=None)(lambda name: judge_of([anything, setting_of(TYPES[name])]))


def test_the_schema_of_every_type_is_valid(judge_of: Callable[..., Judge]) -> None:
    nodes = [setting_of(kind, name=f"toy.{name}") for name, kind in TYPES.items()]
    unwritten = setting_of(range | None, None, name="toy.unwritten")
    Draft202012Validator.check_schema(judge_of([documented, unwritten, *nodes]).schema)


@pytest.mark.parametrize("name", TYPES)
def test_no_plain_value_that_the_loader_takes_is_refused(
    name: str, judge: Callable[[str], Judge]
) -> None:
    values = [value for scalar in SCALARS for value in (scalar, [scalar, scalar], {"p": scalar})]
    data = graph(values[0])
    for number, value in enumerate(values):
        data["nodes"][f"a{number}"] = {"use": "toy.set", "with": {"value": value}}
    refused = {line.split(".")[2].partition(":")[0] for line in judge(name).refusals(data)}
    mistaken = {line.split(": ")[1] for line in judge(name).mistakes(data)}
    assert not [data["nodes"][node] for node in refused - mistaken]


REFUSED = [
    ("whole", "a"), ("whole", 1.5), ("whole", True), ("whole", None), ("whole", "$5"),
    ("bounded", 0), ("bounded", 10), ("number", "1"), ("open", 0), ("truth", 1), ("short", "abc"),
    ("choice", "c"), ("either", 0), ("either", "rings"), ("nested", 1), ("nested", []),
    ("nested", [[-1]]), ("few", ["a"]), ("file", 5),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value"), REFUSED)
def test_both_refuse_a_value_that_does_not_fit(
    name: str, value: Any, judge: Callable[[str], Judge]
) -> None:
    assert judge(name).refusals(graph(value))
    assert judge(name).mistakes(graph(value))


VARIABLES = [
    ("whole", "$v", 3), ("whole", "$w.x", 1), ("choice", "$v", "a"), ("pattern", "$v", "auto"),
    ("nested", [["$v"]], 1), ("nested", "$v", [[1]]), ("pair", [1, "$v"], 2.5),
    ("mapping", {"p": "$v"}, 3), ("records", [{"p": "$v"}], 3), ("truth", "$v", True),
    ("either", "$v", None),
]  # fmt: skip


@pytest.mark.parametrize(("name", "value", "held"), VARIABLES)
def test_a_variable_may_stand_for_a_value_and_for_any_part_of_it(
    name: str, value: Any, held: Any, judge: Callable[[str], Judge]
) -> None:
    assert not judge(name).refusals(graph(value, held))
    assert not judge(name).mistakes(graph(value, held))


def test_infinity_is_a_number(judge: Callable[[str], Judge]) -> None:
    assert not judge("number").refusals(graph(float("inf")))


@node("toy.documented")
def documented(
    *,
    gap: Annotated[int, Field(ge=1), Unit("frames")] = 15,
    bound: float = float("inf"),
    names: tuple[str, ...] = ("x",),
    path: InputFile,
) -> float:
    """Document.

    Parameters
    ----------
    gap
        Length of ``each`` gap.
    """
    raise AssertionError


def test_each_setting_has_its_unit_meaning_kind_and_default(judge_of: Callable[..., Judge]) -> None:
    schema = settings_of(judge_of([documented]), "toy.documented")
    text = "Length of each gap. Whole number >= 1, in frames. Default: 15."
    assert schema["gap"]["description"] == text
    assert schema["gap"]["default"] == 15
    assert schema["gap"]["minimum"] == 1
    assert schema["names"]["default"] == ["x"]
    assert schema["path"]["description"] == "Path. Required."
    assert "default" not in schema["bound"], "JSON has no infinity"
    assert schema["bound"]["description"] == "Number. Default: inf."


def test_a_setting_that_no_file_can_hold_is_left_to_the_loader(
    judge_of: Callable[..., Judge],
) -> None:
    judge = judge_of([anything, setting_of(range | None, None)])
    schema = settings_of(judge, "toy.set")["value"]
    assert schema == {"description": "Value or null. Default: null.", "default": None}


def test_an_error_names_the_one_thing_that_is_wrong(judge: Callable[[str], Judge]) -> None:
    assert judge("bounded").refusals(graph(0)) == [
        "$.nodes.a.with.value: 0 is less than the minimum of 1"
    ]
