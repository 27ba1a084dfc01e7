"""The README of an archive."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nodegraph.archive.contents import Contents, readme
from nodegraph.archive.inputs import ArchivedInput
from nodegraph.report.study import Study

from .records import record_with


def contents(**more: Any) -> Contents:
    study = Study("Which?", answer=("a is best.",), versions=(("nodegraph", "1.2"),), created="now")
    return Contents(
        "g.yaml", study, record_with(), command="nodegraph run g.yaml --plugin p.py", **more
    )


def test_answer_and_command() -> None:
    text = readme(contents())
    assert text.startswith("# Which?\n\nA run of `g.yaml` by nodegraph 1.2, made now. ")
    assert "\na is best.\n" in text
    assert "\n\n    nodegraph run g.yaml --plugin p.py\n" in text
    for word in ("verify", "Not in this archive", "SHA-256"):
        assert word not in text


def test_missing_files_are_listed() -> None:
    text = readme(contents(missing=["plugin p.py: missing"]))
    assert "Not in this archive:\n\n- plugin p.py: missing\n" in text


def test_only_the_lock_of_the_graph_is_verified() -> None:
    assert "`nodegraph verify g.lock`" in readme(contents(files={"g.lock": b""}))
    assert "verify" not in readme(contents(files={"run/uv.lock": b""}))


def test_inputs_are_listed_with_their_digests() -> None:
    inputs = (
        ArchivedInput("/far/a.c3d", "12ab.c3d", "inputs/a.c3d", Path("/far/a.c3d")),
        ArchivedInput("sample:x", "34cd", "sample:x", is_shipped=True),
    )
    text = readme(contents(inputs=inputs))
    assert "- `inputs/a.c3d`: 12ab.c3d\n" in text
    assert "- `sample:x`" in text
