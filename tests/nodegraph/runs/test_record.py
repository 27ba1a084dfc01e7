from __future__ import annotations

import json
from collections.abc import Callable

from nodegraph.execute.results import Run
from nodegraph.runs.record import record
from nodegraph.runs.record_files import record_bytes, steps_bytes
from tests.records import steps_of

TEXT = """
title: A toy
inputs: {start: -3}
axes: {k: [1, 2], actor: {ME: 5, MB: 6}}
nodes:
  a: {use: read.number, with: {start: $start}}
  gaps: {use: gaps.cut, in: a, with: {length: $actor, seed: $k}}
  fill: {in: gaps, alternatives: {hold: fill.hold, strict: strict.positive}}
  bad: {use: strict.fails, in: a}
  table: {use: compare.table, in: fill}
  x: {use: fill.hold, in: {from: gaps, at: {k: 2, actor: ME}}}
skip: [{k: 2, actor: MB}]
known: [a]
"""


def test_the_record_says_what_ran_and_how_it_ended(run_of: Callable[..., Run]) -> None:
    run = run_of(TEXT)
    what_ran = record(run)
    data = json.loads(record_bytes(what_ran)) | {"steps": steps_of(steps_bytes(what_ran.steps))}
    assert data["settings"] == {"graph": "toy.yaml"}
    assert (data["title"], data["inputs"], data["known"]) == ("A toy", {"start": -3}, ["a"])
    assert data["axes"]["actor"] == ["ME", "MB"]
    assert data["nodes"]["fill"] == {
        "axes": ["k", "actor", "fill"],
        "gathered": [],
        "methods": {
            "hold": {"use": "fill.hold", "plugin": "toys", "outputs": ["output"]},
            "strict": {"use": "strict.positive", "plugin": "toys", "outputs": ["output"]},
        },
    }
    counts = {state: count for state, count in data["counts"].items() if count}
    assert counts == {"done": 8, "refused": 3, "failed": 1}
    assert len(data["steps"]) == 12  # x is one of the cells of fill
    also = [other for step in data["steps"] for other in step.get("also", ())]
    assert also == [{"node": "x", "labels": {}}]
    steps = {(step["node"], *step["labels"].values()): step for step in data["steps"]}
    gaps = steps["gaps", 1, "MB"]
    assert gaps["settings"] == {"length": 6, "seed": 1}
    assert gaps["inputs"] == {"recording": {"step": steps["a",]["step"], "output": "output"}}
    assert gaps["state"] == "done"
    assert steps["bad",]["reason"] == "-3.0 is negative"
    assert steps["bad",]["place"].startswith("toys.py:")
    assert "ValueError" in steps["bad",]["trace"]
    assert len(steps["table",]["inputs"]["scores"]) == 6
    (skipped,) = data["skipped"]
    assert skipped["labels"] == {"k": [2], "actor": ["MB"]}
    assert skipped["counts"]["gaps"] == 1
    assert skipped["reason"] == "skip: k = 2, actor = MB"
    assert data["versions"]["python"]
    assert data["versions"]["numpy"]


def test_what_was_left_out_is_recorded(run_of: Callable[..., Run]) -> None:
    left_out = record(run_of(TEXT, only={"actor": ("MB",)})).left_out
    assert [step.node for step in left_out] == ["x"]
