"""A step that is not cached is explained by what changed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps, open_store
from nodegraph.graph import Graph
from nodegraph.plan import plan
from nodegraph.runs.record import Record, record
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
    """Return the changes of a node's steps between a run of one text and a plan of another."""

    def why(
        before: str,
        now: str,
        node: str,
        edit: Callable[[Record], Record] = lambda earlier: earlier,
    ) -> list[tuple[str, ...]]:
        earlier = edit(record(run_of(before, store=tmp_path)))
        graph = graph_of(now)
        planned = plan(graph)
        cache = StoredSteps(planned, open_store(graph.registry, tmp_path, pytest.fail))
        return [step.changes for step in Why(planned, cache, earlier).explain(node)]

    return why


def test_a_combination_that_is_refused_is_no_reason_to_run_again(why_of: WhyOf) -> None:
    assert why_of(TEXT, TEXT, "d") == [()]
    assert why_of(TEXT, TEXT, "c") == [
        ("skipped, as before: b(start=-1) refused: -1.0 is negative",), (), ()
    ]  # fmt: skip


def test_a_step_that_failed_is_tried_again(why_of: WhyOf) -> None:
    change = ("b(start=-1): failed in the earlier run and will be tried again: -1.0 is negative",)
    assert why_of(FAILS, FAILS, "b") == [change, (), ()]
    assert why_of(FAILS, FAILS, "d") == [change]


@pytest.mark.parametrize(
    ("old", "new", "changes_named"),
    [
        ("[-1, 1, 2]", "[1, 2]", ("d: scores took 3 values, now 2",)),
        (
            "[-1, 1, 2]", "[1, 2, 3]", ("a(start=3): was not in the earlier run",)
        ),
        ("in: c", "in: a", ("d: scores took c.output as start=-1, now a.output as start=-1",)),
        ("use: fill.hold", "use: fill.scale", ("c(start=1): used fill.hold, now fill.scale",)),
        ("table, in: c", "table, in: c, with: {metric: y}", ("d: metric was 'x', now 'y'",)),
        (
            "use: fill.hold", "alternatives: {x: fill.hold, y: fill.scale}",
            ("c(start=1, c=y): was not in the earlier run", "d: scores took 3 values, now 6"),
        ),
    ],
)  # fmt: skip
def test_the_root_of_a_change_is_named(
    why_of: WhyOf, old: str, new: str, changes_named: tuple[str, ...]
) -> None:
    [changes] = why_of(TEXT, TEXT.replace(old, new), "d")
    assert set(changes_named) <= set(changes), changes


def test_labels_of_what_is_gathered_are_a_change(why_of: WhyOf) -> None:
    text = TEXT.replace("in: c}", "in: {scores: {before: a, after: c}}}")
    [changes] = why_of(text, text.replace("before", "first"), "d")
    first, now = ("a.output as scores=before, start=-1", "a.output as scores=first, start=-1")
    assert changes == (f"d: scores took {first}, now {now}",)


def without_keys(earlier: Record) -> Record:
    return replace(earlier, steps=[replace(step, key="") for step in earlier.steps])


def test_versions_and_edited_functions_are_named(why_of: WhyOf) -> None:
    def older(earlier: Record) -> Record:
        [hold] = [name for name in earlier.units if name.endswith("toys")]
        return replace(
            without_keys(earlier),
            units={**earlier.units, hold: "another"},
            versions={**earlier.versions, "platform": "Plan 9"},
        )

    [_, changes, _] = why_of(TEXT, TEXT, "c", older)
    assert any(text.startswith("fill.hold: platform was Plan 9, now ") for text in changes)
    assert any(text.endswith("toys was edited") for text in changes)


def test_code_is_not_compared_across_versions_of_python(why_of: WhyOf) -> None:
    def older(earlier: Record) -> Record:
        units = dict.fromkeys(earlier.units, "another")
        return replace(
            without_keys(earlier), units=units, versions={**earlier.versions, "python": "2.7.1"}
        )

    [_, changes, _] = why_of(TEXT, TEXT, "c", older)
    assert any(text.startswith("fill.hold: python was 2.7.1, now 3.") for text in changes)
    assert not any("edited" in text for text in changes)


def test_a_run_that_stored_nothing_has_no_code_to_compare(why_of: WhyOf) -> None:
    def unstored(earlier: Record) -> Record:
        return replace(without_keys(earlier), code={})

    [_, changes, _] = why_of(TEXT, TEXT, "c", unstored)
    assert any("fill.hold: its code was not recorded" in text for text in changes)


def test_a_result_that_is_not_in_the_store_has_an_unchanged_key(
    why_of: WhyOf, tmp_path: Path
) -> None:
    def prune(earlier: Record) -> Record:
        for entry in tmp_path.glob("*/entries/*"):
            entry.unlink()
        return earlier

    def unstorable(earlier: Record) -> Record:
        return replace(prune(earlier), steps=[replace(earlier.steps[0], digests=[])])

    text = "nodes: {a: {use: read.number}}"
    assert why_of(text, text, "a") == [()]
    [[pruned]] = why_of(text, text, "a", prune)
    [[unstored]] = why_of(text, text, "a", unstorable)
    assert pruned.endswith("the result is not in the store")
    assert unstored.endswith("could not store its result")
