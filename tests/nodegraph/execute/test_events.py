from __future__ import annotations

import json
from collections.abc import Callable

import numpy as np
import pytest

from nodegraph.execute.events import Event
from nodegraph.execute.executor import HowToRun
from nodegraph.execute.results import Run


def test_a_line_is_json_whatever_is_in_it() -> None:
    event = Event("done", 1.0, 3, "a", {"k": float("inf")}, {"took": float("nan"), "x": np.ones(1)})
    line = json.dumps(event.as_dict(), allow_nan=False)
    assert json.loads(line) == {
        "event": "done", "seconds": 1.0, "step": 3, "node": "a", "labels": {"k": "inf"},
        "took": "nan", "x": "[1.]",
    }  # fmt: skip


def test_counts_and_what_is_left_add_up(
    run_of: Callable[..., Run], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph.execute.events._INTERVAL", 0.0)
    text = """
        axes: {start: {range: [-9, 9, 1]}}
        nodes:
          a: {use: read.number, with: {start: $start}}
          b: {use: strict.positive, in: a}
          c: {use: fill.hold, in: b}
        """
    events: list[Event] = []
    run = run_of(text, listeners=[events.append])
    progress = [dict(event.detail) for event in events if event.kind == "progress"]
    assert len(progress) == len(run.plan.steps)
    for counts in progress:
        counts.pop("to_go")
        assert sum(counts.values()) == len(run.plan.steps)
    assert progress[-1]["left"] == 0


def test_an_interruption_is_an_event(run_of: Callable[..., Run]) -> None:
    events: list[Event] = []

    def listen(event: Event) -> None:
        events.append(event)
        if event.node == "b":
            raise KeyboardInterrupt

    text = "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}"
    with pytest.raises(KeyboardInterrupt):
        run_of(text, how=HowToRun("threads"), listeners=[listen])
    assert events[-1].kind == "interrupted"
    assert (events[-1].detail["run"], events[-1].detail["left"]) == (1, 1)
