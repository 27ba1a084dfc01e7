"""Two records are compared step by step: where a difference begins, and what changed there."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace

from nodegraph.execute.results import Run
from nodegraph.runs.compare import Agreement, Judged, Pair, StepChange, changes, compare
from nodegraph.runs.record import Record, RecordedCode, RecordedStep, record

RunOf = Callable[..., Run]
CODE = RecordedCode(["b"])
TEXT = """
nodes:
  a: {use: read.number}
  b: {use: fill.hold, in: a}
  c: {use: fill.hold, in: b}
  d: {use: read.number, with: {start: 3}}
  e: {use: compare.table, in: {scores: {one: c, two: d}}}
"""


def judge_of(agreements: Mapping[str, Agreement]) -> Callable[[Pair], Judged]:
    return lambda pair: Judged(agreements.get(pair.cell.node, Agreement.OTHER))


def with_setting(was: Record, node: str) -> Record:
    steps = [
        replace(step, settings={"max_gap": 7}) if step.node == node else step for step in was.steps
    ]
    return replace(was, steps=steps)


def test_a_difference_begins_where_nothing_upstream_differs_and_where_a_step_changed(
    run_of: RunOf,
) -> None:
    was = record(run_of(TEXT))
    agreements = compare(was, with_setting(was, "c"), judge_of({"d": Agreement.SAME}))
    assert [pair.cell.node for pair, _ in agreements.origins] == ["a", "c"]
    assert agreements.followers == {"b": 1, "e": 1}
    assert (agreements.beyond, agreements.same, agreements.compared) == (4, 1, 5)
    assert agreements.origins[1][0].change == StepChange(("max_gap was None, now 7",))


def test_a_step_that_stands_for_two_combinations_does_not_feed_itself(run_of: RunOf) -> None:
    text = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}, c: {use: fill.hold, in: a}}"
    was = record(run_of(text))
    assert len(was.steps) == 2
    agreements = compare(was, was, judge_of({"a": Agreement.SAME}))
    assert [pair.cell.node for pair, _ in agreements.origins] == ["b", "c"]


def test_combinations_of_one_record_only_are_no_results(run_of: RunOf) -> None:
    text = "axes: {k: [1, 2]}\nnodes: {a: {use: read.number, with: {start: $k}}}"
    was, now = (record(run_of(each)) for each in (text, text.replace("[1, 2]", "[2, 3]")))
    agreements = compare(was, now, judge_of({"a": Agreement.SAME}))
    assert [cell.name for cell in (*agreements.only_was, *agreements.only_now)] == [
        "a(k=1)",
        "a(k=3)",
    ]
    assert not agreements.is_equal


def test_all_that_decides_a_step_is_compared(run_of: RunOf) -> None:
    was = record(run_of(TEXT))
    steps = {step.node: step for step in was.steps}

    def changed(node: str, **values: object) -> tuple[str, ...]:
        step = replace(steps[node], **values)  # type: ignore[arg-type]  # of several types
        now = replace(was, steps=[step if each.node == node else each for each in was.steps])
        return changes(was, now, steps[node], step).own

    def file(step: RecordedStep, path: str, digest: str) -> RecordedStep:
        return replace(step, settings={"path": path}, files={"path": digest})

    assert changed("b") == ()
    assert changed("d", settings={"start": 4}) == ("start was 3, now 4",)
    assert changed("b", inputs=steps["c"].inputs) == ("recording took a.output, now b.output",)
    one, other, moved = (
        file(steps["a"], *pair) for pair in (("a.txt", "1"), ("a.txt", "2"), ("b.txt", "1"))
    )
    assert changes(was, was, one, other).own == ("path: the content of a.txt changed",)
    assert changes(was, was, one, moved).own == ()
    edited = replace(was, units={**was.units, "b": "1"}, code={"toys:read.number": CODE})
    now = replace(edited, units={**was.units, "b": "2"})
    assert changes(edited, now, steps["a"], steps["a"]).own == ("code: b was edited",)
