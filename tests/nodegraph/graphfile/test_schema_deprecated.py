"""Editors strike out what is deprecated, and refuse nothing that the loader takes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated

import pytest

from nodegraph import Deprecated, node
from tests.nodegraph.graphfile.conftest import Judge


@node("read.number")
def number() -> float:
    return 1.0


@node("fill.new")
def new(
    x: float, *, most: int = 1, longest: Annotated[int | None, Deprecated("use most")] = None
) -> float:
    """Fill."""
    return x


@node("fill.old", deprecated="use fill.new")
def old(x: float) -> float:
    """Fill."""
    return x


@node("gone.one", deprecated="use fill.new")
def gone(x: float) -> float:
    return x


@pytest.fixture(scope="session")
def judge(judge_of: Callable[..., Judge]) -> Judge:
    return judge_of([number, new, old, gone])


def graph(**b: object) -> dict[str, object]:
    return {"nodegraph": 1, "nodes": {"a": {"use": "read.number"}, "b": {"in": "a", **b}}}


def test_nodes_and_settings_are_marked(judge: Judge) -> None:
    names = {
        constant.get("const"): constant for constant in judge.schema["$defs"]["node name"]["oneOf"]
    }
    assert names["fill.old"]["deprecated"] is True
    assert "Deprecated: use fill.new." in names["fill.old"]["description"]
    assert "deprecated" not in names["fill.new"]
    settings = judge.schema["$defs"]["fill.new"]["properties"]["with"]["properties"]
    assert settings["longest"]["deprecated"] is True
    assert settings["longest"]["description"].startswith("Deprecated: use most.")
    assert "deprecated" not in settings["most"]


GOOD: dict[str, dict[str, object]] = {
    "alone": {"use": "fill.old"},
    "listed": {"alternatives": ["fill.old", "fill.new"]},
    # the family leaves fill.old out, which has no such setting
    "family": {"alternatives": "fill.*", "with": {"most": 2, "longest": 3}},
    "family and old": {"alternatives": {"fill.*": {"with": {"most": 2}}, "old": "fill.old"}},
    "family of the old": {"alternatives": ["gone.one"]},
}
BAD: dict[str, dict[str, object]] = {
    "setting": {"use": "fill.old", "with": {"most": 2}},
    "shared": {"alternatives": ["fill.old", "fill.new"], "with": {"most": 2}},
    "family of none": {"alternatives": "gone.*"},
}


@pytest.mark.parametrize("name", GOOD)
def test_both_take_it(name: str, judge: Judge) -> None:
    assert judge.mistakes(graph(**GOOD[name])) == []
    assert judge.refusals(graph(**GOOD[name])) == []


@pytest.mark.parametrize("name", BAD)
def test_both_refuse_it(name: str, judge: Judge) -> None:
    assert judge.mistakes(graph(**BAD[name]))
    assert judge.refusals(graph(**BAD[name]))
