"""The README says what lacks, and offers only what can be done with what is there."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from nodegraph.archive.contents import Contents, readme
from nodegraph.archive.inputs import ReadFile
from nodegraph.report import Study

from .records import record_with


def contents(**more: Any) -> Contents:
    study = Study("Which?", answer=("a is best.",), versions=(("nodegraph", "1.2"),), created="now")
    return Contents(
        "g.yaml", study, record_with(), command="nodegraph run g.yaml --plugin p.py", **more
    )


def test_it_begins_with_the_answer_and_the_command() -> None:
    text = readme(contents())
    assert text.startswith("# Which?\n\nA run of `g.yaml` by nodegraph 1.2, made now.")
    assert "\na is best.\n" in text
    assert (
        "Run it again here, with the same versions of the packages below:\n\n"
        "    nodegraph run g.yaml --plugin p.py\n" in text
    )
    for word in ("verify", "Not in this archive", "It read"):
        assert word not in text


def test_what_lacks_is_listed_and_said_where_the_command_is() -> None:
    text = readme(contents(lacking=["plugin p.py: it is gone"]))
    assert "the packages below, and with what is not in this archive:" in text
    assert "Not in this archive:\n\n- plugin p.py: it is gone\n" in text


def test_only_a_lock_beside_the_graph_is_one_to_verify() -> None:
    assert "`nodegraph verify g.lock`" in readme(contents(files={"g.lock": b""}))
    assert "verify" not in readme(contents(files={"run/uv.lock": b""}))


def test_inputs_are_listed_with_what_they_were() -> None:
    inputs = (
        ReadFile("/far/a.c3d", "12ab.c3d", "inputs/a.c3d", Path("/far/a.c3d")),
        ReadFile("sample:x", "34cd", "sample:x", is_shipped=True),
    )
    text = readme(contents(inputs=inputs))
    assert "- `inputs/a.c3d`: 12ab.c3d\n- `sample:x`, which its package ships: 34cd\n" in text
