"""A run whose files are not as it wrote them is told: the file, the key, and what to do."""

from __future__ import annotations

import gzip
import json
import os
import shutil
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import pytest

from nodegraph import NodegraphError
from nodegraph.report import study
from nodegraph.report.study import read_study
from nodegraph.runs import folder
from nodegraph.runs.record_files import read_record as record_in
from tests.nodegraph.cli.conftest import Command
from tests.records import read_record, write_steps
from tests.texts import edit

Place = tuple[str | int, ...]
OTHERS: tuple[object, ...] = (None, 7, "odd", [7])
OTHERS_ON_TOP: tuple[object, ...] = ([], {}, {"odd": 7})
ALIKE: tuple[Place, ...] = (("code",), ("units",), ("versions",))
"""Mappings whose members are alike, as those of lists are."""
READERS = (
    ("archive", "ran", "--out", "new.zip"),
    ("export", "ran", "fill", "--at", "fill=hold,length=1", "--out", "new.raw", "--store", "kept"),
    ("diff", "whole", "ran", "--store", "kept"),
    ("diff", "ran", "whole", "--store", "kept"),
    ("check", "toy.yaml", "--why", "fill", "--run", "ran", "--store", "kept"),
)


@pytest.fixture
def ran(command: Command) -> Path:
    """A run with a step of every kind, whole and to be damaged."""
    more = "  never: {use: fill.strict, in: a}\nskip: [{fill: strict, length: 1}]\n"
    Path("toy.yaml").write_text(Path("toy.yaml").read_text() + more)
    edit("toys.py", "x < -9:", "x > 4:")
    assert command("run", "toy.yaml", "--store", "kept", "--out", "whole")[0] == 0
    shutil.copytree("whole", "ran")
    return Path("ran")


def places(data: object, at: Place = ()) -> Iterator[Place]:
    """Yield every place in plain data, of members that are alike only the first and the last."""
    if at:
        yield at
    if isinstance(data, dict | list):
        parts = [*(data.items() if isinstance(data, dict) else enumerate(data))]
        are_alike = isinstance(data, list) or at in ALIKE
        for key, part in parts[:: max(len(parts) - 1, 1)] if are_alike else parts:
            yield from places(part, (*at, key))


def changed(data: object, at: Place) -> Iterator[Any]:
    """Yield data without what is at a place, and with something else there."""
    text = json.dumps(data)
    for other in (..., *OTHERS, *(OTHERS_ON_TOP if len(at) == 1 else ())):
        damaged = inner = json.loads(text)
        for key in at[:-1]:
            inner = inner[key]
        if other is ...:
            del inner[at[-1]]
        else:
            inner[at[-1]] = other
        yield damaged


def read_by(command: Command, readers: Iterable[tuple[str, ...]]) -> str:
    """Give commands that read the run; return what they say on stderr."""
    errors = ""
    for words in readers:
        status, _, err = command(*words, nodes=words[0] == "check")
        assert "internal error" not in err, (words, err)
        assert status in (0, 1, 2)
        errors += err
        for new in Path().glob("new.*"):
            new.unlink()
    return errors


def test_a_record_may_be_damaged_anywhere(command: Command, ran: Path) -> None:
    whole = read_record(ran)
    assert "again" not in read_by(command, READERS)
    files = ("run.json", "steps.jsonl.gz")
    beginnings = tuple(f"ran/{name} {text}" for name in files for text in ("cannot", "is of"))
    good = {name: (ran / name).read_bytes() for name in files}
    for at in places(whole):
        name = files[at[0] == "steps"]
        readers: tuple[tuple[str, ...], ...] = READERS
        for count, data in enumerate(changed(whole, at)):
            (ran / name).unlink()  # ext4 writes a file to the disk at once if it was emptied
            steps = data.pop("steps", None)
            if name == "run.json":
                (ran / name).write_text(json.dumps(data))
            else:
                write_steps(ran, steps if isinstance(steps, list) else [steps])
            try:
                record_in(ran)
            except NodegraphError as error:
                message = str(error)
                assert message.startswith(beginnings), message
                assert message.endswith("run the graph again"), message
            else:
                read_by(command, readers if count < 2 else ())
                readers = ()
        (ran / name).write_bytes(good[name])


@pytest.mark.parametrize(
    ("key", "at"),
    [
        ("nodes", "nodes: field required"),
        ("command", "command: field required"),
        ("counts", "counts: field required"),
        ("folder", "folder: field required"),
    ],
)
def test_the_key_that_lacks_is_named(command: Command, ran: Path, key: str, at: str) -> None:
    data = json.loads((ran / "run.json").read_text())
    del data[key]
    (ran / "run.json").write_text(json.dumps(data))
    for words in READERS:
        status, _, err = command(*words, nodes=words[0] == "check")
        assert status == 2
        assert f"ran/run.json cannot be read ({at})" in err


@pytest.mark.parametrize(
    ("step", "reason"),
    [
        ({"node": "nowhere"}, "line 1: no node 'nowhere'"),
        ({"use": "fill.hold"}, "line 1: 'a' has no method 'fill.hold'"),
        ({"labels": {"length": 1}}, "line 1: its labels are not those of 'a'"),
        ({"state": "odd"}, "line 1.state: input should be 'done'"),
        ({"inputs": {"x": {"step": 99, "output": "x"}}}, "line 1: inputs.x: no step 99"),
        ({"key": "../../odd"}, "line 1.key: string should match pattern"),
    ],
)
def test_steps_that_refer_to_nothing_are_named(
    ran: Path, step: dict[str, object], reason: str
) -> None:
    first, *rest = read_record(ran)["steps"]
    write_steps(ran, [first | step, *rest])
    with pytest.raises(NodegraphError) as caught:
        record_in(ran)
    assert reason in str(caught.value)


def test_a_file_that_is_not_a_record_is_an_error(command: Command, ran: Path) -> None:
    for text in ("", "[]", "7", "[" * 100_000, '{"format": 99}', "\0"):
        (ran / "run.json").write_text(text)
        assert "run the graph again" in read_by(command, READERS[:1])


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("run.json", READERS[0]),
        ("steps.jsonl.gz", READERS[2]),
        ("study.json.gz", ("report", "ran")),
    ],
)
def test_a_device_or_a_pipe_is_not_read(
    command: Command, ran: Path, name: str, words: tuple[str, ...]
) -> None:
    (ran / name).unlink()
    (ran / name).symlink_to("/dev/zero")
    assert "it is not a regular file" in read_by(command, (words,))
    (ran / name).unlink()
    os.mkfifo(ran / name)
    assert "it is not a regular file" in read_by(command, (words,))


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, "was not written when the run ended"),
        (b"{}", "cannot be read (Not a gzipped file"),
        (gzip.compress(b"{}\n", mtime=0), "cannot be read (line 1.step: field required)"),
        (gzip.compress(b"{\n", mtime=0), "cannot be read (Expecting property name"),
        (gzip.compress(b" " * 100_001, mtime=0), "cannot be read (it has more than 0 MB)"),
    ],
    ids=["none", "plain", "empty", "no JSON", "large"],
)
def test_a_file_that_has_no_steps_is_an_error(
    ran: Path, content: bytes | None, reason: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(folder, "_MOST_BYTES", 100_000)
    (ran / "steps.jsonl.gz").unlink()
    if content is not None:
        (ran / "steps.jsonl.gz").write_bytes(content)
    with pytest.raises(NodegraphError, match="run the graph again") as caught:
        record_in(ran)
    assert str(caught.value).startswith("ran/steps.jsonl.gz")
    assert reason in str(caught.value)


def test_a_study_larger_than_its_bound_is_not_read(
    ran: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    content = gzip.decompress((ran / "study.json.gz").read_bytes())
    monkeypatch.setattr(study, "_MOST_BYTES", len(content))
    read_study(ran)
    (ran / "study.json.gz").write_bytes(gzip.compress(content + b" "))
    with pytest.raises(NodegraphError, match=r"study\.json\.gz cannot be read"):
        read_study(ran)


@pytest.mark.parametrize(
    ("place", "code"),
    [
        ("html", "<p>x</p><sCript type=text/javascript>own()</script>"),
        ("html", '<script type="application/json"/src=own()></script>'),
        ("lead", '<META http-equiv="refresh" content="0;url=https://own()">'),
        ("scripts", ["own()"]),
        ("styles", ["main { content: 'own()' }"]),
        ("html", "<p>own()</p><!-- never closed"),
        ("html", "<style>main { content: 'own()' }</style>"),
        ("html", "<p>own()</p></div></section>"),
        ("html", "<div>own()"),
        ("lead", "<plaintext>own()"),
        ("graph_svg", "<svg><desc><path/></desc><text>own()</text></svg>"),
        ("lead", '<script type="application/json" id="a"><!--<script>own()</script>'),
        ("graph_svg", "<svg><script>own()</script></svg>"),
    ],
)
def test_a_report_drawn_again_has_no_code_of_a_stranger(
    command: Command, ran: Path, place: str, code: object
) -> None:
    whole = json.loads(gzip.decompress((ran / "study.json.gz").read_bytes()))
    (whole if place in whole else whole["sections"][0]["rendered"])[place] = code
    (ran / "study.json.gz").write_bytes(gzip.compress(json.dumps(whole).encode()))
    status, _, errors = command("report", "ran", nodes=False)
    assert (status, errors.count("1 result with scripts")) == (0, 1)
    assert "own()" not in (ran / "report.html").read_text()


def test_a_study_may_be_damaged_anywhere(command: Command, ran: Path) -> None:
    whole = json.loads(gzip.decompress((ran / "study.json.gz").read_bytes()))
    readers = (
        ("archive", "ran", "--out", "new.zip"),
        ("cite", "ran"),
        ("report", "ran", "whole", "--out", "new.html"),
    )
    for at in places(whole):
        for count, data in enumerate(changed(whole, at)):
            (ran / "study.json.gz").unlink()
            (ran / "study.json.gz").write_bytes(gzip.compress(json.dumps(data).encode()))
            try:
                read_study(ran)
            except NodegraphError as error:
                message = str(error)
                assert message.startswith("ran/study.json.gz cannot be read ("), message
                assert message.endswith("); run the graph again"), message
            else:
                # below that, it is one text or another in a page
                read_by(command, readers if len(at) == 1 and count < 4 else ())
