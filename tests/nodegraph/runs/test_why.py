"""What is said of a step that would run again is what a reader needs to know."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from pathlib import Path
from typing import Any

import pytest

from nodegraph.execute import Run, StepCache, open_store
from nodegraph.graph import Graph
from nodegraph.plan import plan
from nodegraph.runs.record import record
from nodegraph.runs.why import Why

WhyOf = Callable[..., list[tuple[str, ...]]]
TEXT = """
axes: {start: [-1, 1, 2]}
nodes:
  a: {use: read.number, with: {start: $start}}
  b: {use: strict.positive, in: a}
  c: {use: fill.hold, in: b}
  d: {use: compare.table, in: c}
"""
FAILS = TEXT.replace("strict.positive", "strict.fails")


@pytest.fixture
def why_of(graph_of: Callable[..., Graph], run_of: Callable[..., Run], tmp_path: Path) -> WhyOf:
    """Return what is said of a node's steps after a run of one text, when it is another now."""

    def why(
        before: str,
        now: str,
        asked: str,
        change: Callable[[dict[str, Any]], object] = lambda made: None,
    ) -> list[tuple[str, ...]]:
        made = deepcopy(record(run_of(before, store=tmp_path), "run"))
        change(made)
        graph = graph_of(now)
        planned = plan(graph)
        cache = StepCache(planned, open_store(graph.registry, tmp_path, pytest.fail))
        return [one.changes for one in Why(planned, cache, made).explain(asked)]

    return why


def test_a_combination_that_is_refused_is_no_reason_to_run_again(why_of: WhyOf) -> None:
    assert why_of(TEXT, TEXT, "d") == [()]
    assert why_of(TEXT, TEXT, "c") == [
        ("skipped, as before: b(start=-1) refused: -1.0 is negative",), (), ()
    ]  # fmt: skip


def test_a_step_that_failed_is_tried_again(why_of: WhyOf) -> None:
    said = ("b(start=-1): failed in that run, and is tried again: -1.0 is negative",)
    assert why_of(FAILS, FAILS, "b") == [said, (), ()]
    assert why_of(FAILS, FAILS, "d") == [said]


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("[-1, 1, 2]", "[1, 2]", ("d: scores took 3 values, now 2",)),
        (
            "[-1, 1, 2]", "[1, 2, 3]", ("a(start=3): was not in that run",)
        ),
        ("in: c", "in: a", ("d: scores took c.output as start=-1, now a.output as start=-1",)),
        ("use: fill.hold", "use: fill.scale", ("c(start=1): used fill.hold, now fill.scale",)),
        ("table, in: c", "table, in: c, with: {metric: y}", ("d: metric was 'x', now 'y'",)),
        (
            "use: fill.hold", "alternatives: {x: fill.hold, y: fill.scale}",
            ("c(start=1, c=y): was not in that run", "d: scores took 3 values, now 6"),
        ),
    ],
)  # fmt: skip
def test_the_root_of_a_change_is_named(
    why_of: WhyOf, old: str, new: str, said: tuple[str, ...]
) -> None:
    [changes] = why_of(TEXT, TEXT.replace(old, new), "d")
    assert set(said) <= set(changes), changes


def test_labels_of_what_is_gathered_are_a_change(why_of: WhyOf) -> None:
    text = TEXT.replace("in: c}", "in: {scores: {before: a, after: c}}}")
    [changes] = why_of(text, text.replace("before", "first"), "d")
    first, now = ("a.output as scores=before, start=-1", "a.output as scores=first, start=-1")
    assert changes == (f"d: scores took {first}, now {now}",)


def test_versions_and_edits_and_what_was_not_noted(why_of: WhyOf) -> None:
    def older(made: dict[str, Any]) -> None:
        forget_keys(made)
        made["code"]["toys:fill.hold"]["versions"]["python"] = "2.7"
        [unit] = [one for one in made["code"]["toys:fill.hold"]["units"] if one.endswith(":hold")]
        made["code"]["toys:fill.hold"]["units"][unit] = "another"

    [_, changes, _] = why_of(TEXT, TEXT, "c", older)
    assert any(one.startswith("fill.hold: python was 2.7, now 3.") for one in changes)
    assert any(one.endswith(":hold was edited") for one in changes)

    def unnoted(made: dict[str, Any]) -> None:
        forget_keys(made)
        made["code"].clear()

    [_, changes, _] = why_of(TEXT, TEXT, "c", unnoted)
    assert "fill.hold: its code was not noted in that run, which stored nothing" in changes


def test_what_is_not_in_the_store_is_told(why_of: WhyOf, tmp_path: Path) -> None:
    def prune(made: dict[str, Any]) -> None:
        for entry in tmp_path.glob("*/entries/*/*"):
            entry.unlink()

    def unstored(made: dict[str, Any]) -> None:
        prune(made)
        for one in made["steps"]:
            del one["digests"]

    text = "nodes: {a: {use: read.number}}"
    as_it_was = "its key is as it was; "
    assert why_of(text, text, "a") == [()]
    assert why_of(text, text, "a", prune) == [(f"{as_it_was}the result is not in the store",)]
    said = f"{as_it_was}that run could not store its result"
    assert why_of(text, text, "a", unstored) == [(said,)]


def forget_keys(made: dict[str, Any]) -> None:
    for one in made["steps"]:
        one["key"] = "another"
