"""The metadata of an archive."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from nodegraph import NodegraphError, Rendered
from nodegraph.archive.contents import Contents
from nodegraph.archive.inputs import ArchivedInput
from nodegraph.archive.rocrate import crate_metadata
from nodegraph.report.study import Link, MethodRow, Section, Study, WithoutResult

from .records import record_with

RECORD = record_with(
    inputs={"take": "a b.txt", "gone": "c.txt", "sizes": [1, 2], "on": True},
    axes={"length": [1, 5]},
    counts={"done": 2, "failed": 1},
)


def contents(**more: Any) -> Contents:
    row = MethodRow("fill", "fill.hold", "Hold.", citation="Hold 2001")
    study = Study(
        "Which?",
        sections=(Section("table", Rendered("", ""), files=(Link("CSV", "t.csv"),)),),
        methods=(row, row),
        without_result=(WithoutResult("bad", "bad.boom"),),
        created="2024-05-06T07:08:00+00:00",
        seconds=60.0,
        **more,
    )
    inputs = (
        ArchivedInput("a b.txt", "12.txt", "inputs/a b.txt", Path("a b.txt")),
        ArchivedInput("c.txt", "34" * 32 + ".txt", "c.txt"),
    )
    files = {"g.yaml": b"", "run/t.csv": b"1", "inputs/a b.txt": b"2"}
    return Contents("g.yaml", study, RECORD, files=files, inputs=inputs)


def entities_of(archived: Contents) -> dict[str, dict[str, object]]:
    return {item["@id"]: item for item in json.loads(crate_metadata(archived))["@graph"]}


def test_inputs_and_labels_are_parameters_with_values() -> None:
    entities = entities_of(contents())
    assert entities["inputs/a%20b.txt"]["exampleOfWork"] == {"@id": "#input-take"}
    assert entities["#input-take"]["additionalType"] == "File"
    assert entities["#value-gone"]["value"] == "c.txt"
    assert entities["#file-c.txt"]["sha256"] == "34" * 32
    assert entities["#value-sizes"]["value"] == "[1, 2]"
    assert entities["#input-on"]["additionalType"] == "Boolean"
    assert entities["#labels-length"]["value"] == "1, 5"
    assert entities["run/t.csv"]["exampleOfWork"] == {"@id": "#output-table"}


def test_each_method_with_a_result_is_listed_once() -> None:
    entities = entities_of(contents())
    assert entities["g.yaml"]["hasPart"] == [{"@id": "#method-fill.hold"}]
    assert "#method-bad.boom" not in entities
    assert entities["#run"]["actionStatus"] == "http://schema.org/FailedActionStatus"


def test_the_start_is_that_of_the_events_or_computed_from_the_duration() -> None:
    archived = contents()
    assert entities_of(archived)["#run"]["startTime"] == "2024-05-06T07:07:00+00:00"
    archived.files["run/events.jsonl"] = b'{"began": "2024-05-06T07:00:00+00:00"}\n'
    assert entities_of(archived)["#run"]["startTime"] == "2024-05-06T07:00:00+00:00"
    assert entities_of(archived)["#run"]["endTime"] == "2024-05-06T07:01:00+00:00"


def test_an_invalid_time_is_reported() -> None:
    archived = contents()
    object.__setattr__(archived.study, "created", "odd")
    with pytest.raises(NodegraphError, match=r"study\.json\.gz: created: "):
        crate_metadata(archived)
