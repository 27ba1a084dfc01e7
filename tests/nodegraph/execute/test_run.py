from __future__ import annotations

import warnings
from collections.abc import Callable
from datetime import datetime
from pathlib import Path

import pytest

from nodegraph import NodegraphError, node
from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run
from nodegraph.node.ports import Absent
from nodegraph.state import State

WAYS = [HowToRun("serial"), HowToRun("threads", 1), HowToRun("threads", 3)]
ISOLATION = """
axes: {k: [-1, 1, 2, 3]}
nodes:
  a: {use: read.number, with: {start: $k}}
  some: {in: a, alternatives: {refuse: strict.positive, fail: strict.fails, pass: {}}}
  after: {use: fill.hold, in: some}
  table: {use: compare.table, in: after}
  each: {use: compare.table, in: after, over: [some]}
  none: {use: compare.table, in: {from: after, at: {k: -1, some: fail}}}
  lost: {use: fill.hold, in: {from: after, at: {k: -1, some: refuse}}}
skip: [{k: 3, some: pass}]
"""


@pytest.mark.parametrize("how", WAYS)
def test_what_fails_does_not_stop_the_others(run_of: Callable[..., Run], how: HowToRun) -> None:
    run = run_of(ISOLATION, how=how)
    assert not run.ok
    states = {
        state: {step.name for step, _ in run.settled(state)}
        for state in (State.REFUSED, State.FAILED)
    }
    assert states == {
        "refused": {"some(k=-1, some=refuse)"},
        "failed": {"some(k=-1, some=fail)"},
    }
    skipped = {step.node for step, _ in run.settled(State.SKIPPED)}
    assert skipped == {"after", "none", "lost"}
    seen = run["table"].value.scores
    assert len(seen.entries) == 9
    assert list(seen.absent) == [
        Absent({"k": 3, "some": "pass"}, "skipped", "skip: k = 3, some = pass"),
        Absent(
            {"k": -1, "some": "refuse"},
            "refused",
            "some(k=-1, some=refuse) refused: -1.0 is negative",
        ),
        Absent(
            {"k": -1, "some": "fail"}, "failed", "some(k=-1, some=fail) failed: -1.0 is negative"
        ),
    ]
    assert {at["k"]: len(seen.scores.entries) for at, seen in run["each"]} == {
        -1: 1,
        1: 3,
        2: 3,
        3: 2,
    }


def test_a_skipped_step_names_the_step_that_it_needs(run_of: Callable[..., Run]) -> None:
    run = run_of(ISOLATION)
    outcome = run.outcomes[run.plan.cells["lost"][()]]
    assert outcome.state == "skipped"
    assert outcome.cause == "refused"
    assert outcome.reason == "some(k=-1, some=refuse) refused: -1.0 is negative"
    with pytest.raises(NodegraphError, match=r"lost was skipped: some\(k=-1.*is negative"):
        _ = run["lost"].value


def test_a_gathering_node_is_not_run_when_all_is_absent(
    run_of: Callable[..., Run], calls: list[str]
) -> None:
    text = """
        axes: {k: [-1, -2]}
        nodes:
          a: {use: read.number, with: {start: $k}}
          b: {use: strict.positive, in: a}
          c: {use: compare.table, in: b}
        """
    run = run_of(text)
    counts = {state: count for state, count in run.counts().items() if count}
    assert counts == {"done": 2, "refused": 2, "skipped": 1}
    assert run.ok
    assert "compare.table" not in calls


def listened(run_of: Callable[..., Run], text: str, **more: object) -> list[Event]:
    events: list[Event] = []
    run_of(text, listeners=[events.append], **more)
    return [event for event in events if event.kind != "progress"]


def test_events_come_in_order(run_of: Callable[..., Run]) -> None:
    text = """
        nodes:
          a: {use: read.number, with: {start: -1}}
          b: {use: strict.positive, in: a}
          c: {use: fill.hold, in: b}
          d: {use: strict.fails, in: a}
        """
    events = listened(run_of, text)
    assert [(event.kind, event.node) for event in events] == [
        ("planned", ""),
        ("started", "a"),
        ("done", "a"),
        ("started", "b"),
        ("refused", "b"),
        ("skipped", "c"),
        ("started", "d"),
        ("failed", "d"),
        ("finished", ""),
    ]
    planned = {**events[0].detail}
    assert datetime.fromisoformat(planned.pop("began")).tzinfo is not None
    assert planned.pop("settings")["graph"] == "toy.yaml"
    assert Path(planned.pop("folder")).is_dir()
    nodes = dict.fromkeys("abcd", 1)
    about = {"alternatives": {}, "title": "toy.yaml"}
    assert planned == {"format": 1, "steps": 4, "nodes": nodes, **about}
    assert events[4].detail["reason"] == "-1.0 is negative"
    counts = {state: count for state, count in events[-1].detail.items() if count}
    assert counts == {"done": 1, "refused": 1, "failed": 1, "skipped": 1}
    seconds = [event.seconds for event in events]
    assert seconds == sorted(seconds)


def test_an_event_is_plain_data(run_of: Callable[..., Run]) -> None:
    events = listened(run_of, "axes: {k: [5]}\nnodes: {a: {use: read.number, with: {start: $k}}}")
    plain = events[2].as_dict()
    assert plain.keys() == {"event", "seconds", "step", "node", "labels", "took"}
    assert (plain["event"], plain["step"], plain["labels"]) == ("done", 0, {"k": 5})
    assert "step" not in events[0].as_dict()


@pytest.mark.parametrize("how", WAYS)
def test_every_step_has_one_event_of_its_end(run_of: Callable[..., Run], how: HowToRun) -> None:
    events = listened(run_of, ISOLATION, how=how)
    states = ("done", "refused", "failed", "skipped")
    settled = [event.step for event in events if event.kind in states]
    assert sorted(settled) == list(range(events[0].detail["steps"]))
    place = {(event.kind, event.step): number for number, event in enumerate(events)}
    assert all(
        place["started", event.step] < number
        for number, event in enumerate(events)
        if event.kind in ("done", "refused", "failed")
    )


@pytest.mark.parametrize("how", WAYS)
def test_warnings_of_nodes_land_in_outcomes_and_events(
    run_of: Callable[..., Run], how: HowToRun
) -> None:
    @node("warn.number")
    def warn(x: float) -> float:
        warnings.warn(f"{x:g} gaps left open", stacklevel=2)
        return x

    text = """
        axes: {k: {count: 12}}
        nodes: {a: {use: read.number, with: {start: $k}}, b: {use: warn.number, in: a}}
        """
    events: list[Event] = []
    run = run_of(text, more=[warn], how=how, listeners=[events.append])
    for (k,), index in run.plan.cells["b"].items():
        assert run.outcomes[index].warnings == (f"{k} gaps left open",)
    for event in events:
        if event.kind == "done" and event.node == "b":
            assert event.detail["warnings"] == [f"{event.labels['k']} gaps left open"]


@pytest.mark.parametrize(
    ("how", "message"),
    [
        (HowToRun("thread"), "no executor 'thread'; did you mean 'threads'"),
        (HowToRun(timeout=0), "timeout must be above 0, got 0"),
        (HowToRun("serial", memory=1), "memory cannot be limited with executor 'serial'"),
        (HowToRun(jobs=0), "jobs must be 1 or more, got 0"),
    ],
)
def test_a_wrong_way_to_run_is_an_error(
    run_of: Callable[..., Run], how: HowToRun, message: str
) -> None:
    with pytest.raises(NodegraphError, match=message):
        run_of("nodes: {a: {use: read.number}}", how=how)


def test_a_file_that_cannot_be_read_is_a_failed_step(
    run_of: Callable[..., Run], tmp_path: Path
) -> None:
    path = tmp_path / "take.txt"
    path.write_text("no number")
    run = run_of("nodes: {a: {use: read.file, with: {path: take.txt}}}")
    assert run.counts()["failed"] == 1
    outcome = run.outcomes[0]
    assert "could not convert string to float: 'no number'" in outcome.reason
