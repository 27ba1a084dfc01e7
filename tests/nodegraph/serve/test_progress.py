"""What is read of a run under way is whole, whatever its file of events has at the moment."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from nodegraph.serve.progress import EventFile, states_of


def line(kind: str, **more: object) -> bytes:
    return json.dumps({"event": kind, "seconds": 1.5, **more}).encode() + b"\n"


@pytest.fixture
def path(tmp_path: Path) -> Path:
    path = tmp_path / "events.jsonl"
    path.write_bytes(
        line("planned", nodes={"a": 1, "fill": 3}, alternatives={"fill=hold": 2}, title="toy")
    )
    return path


def append(path: Path, *lines: bytes) -> None:
    with path.open("ab") as file:
        file.writelines(lines)


def test_steps_are_counted_by_node_alternative_and_state(path: Path) -> None:
    events = EventFile(path)
    assert events.update()
    assert not events.update()
    append(path, line("stored", step=0, node="a"))
    append(path, *(line("started", step=step, node="fill") for step in (1, 2)))
    reason = {"labels": {"fill": "hold"}, "reason": "too far"}
    append(path, line("failed", step=1, node="fill", **reason), line("progress", left=2, to_go=4))
    assert events.update()
    progress = events.progress
    assert progress.counts() == {
        "a": {"stored": 1},
        "fill": {"waiting": 1, "running": 1, "failed": 1},
        "fill=hold": {"waiting": 1, "failed": 1},
    }
    assert states_of(progress.counts())["alternatives"]["fill=hold"]["text"] == (
        "1 of 2 failed, 1 waiting"
    )
    assert progress.counts(is_over=True)["fill"] == {"waiting": 2, "failed": 1}
    assert progress.failures == ["fill(fill=hold): too far"]
    append(path, line("failed", step=0, node="a", reason="broken"))
    assert events.update()
    assert progress.failures == ["fill(fill=hold): too far", "a: broken"]  # as they failed
    assert (progress.to_go, progress.seconds) == (4, 1.5)


def test_a_line_is_read_once_it_is_whole(path: Path) -> None:
    events = EventFile(path)
    whole = line("done", step=0, node="a")
    append(path, whole[:20])
    events.update()
    assert events.progress.counts()["a"] == {"waiting": 1}
    append(path, whole[20:])
    events.update()
    assert events.progress.counts()["a"] == {"done": 1}


@pytest.mark.parametrize("more", [0, 100])
def test_another_run_in_the_folder_is_read_from_its_begin(path: Path, more: int) -> None:
    events = EventFile(path)
    append(path, line("done", step=0, node="a"))
    events.update()
    # a new file may have the number of the one that was removed, and be longer by now
    path.write_bytes(line("planned", nodes={"b": 1}) + line("progress", left=1) * more)
    events.update()
    assert events.progress.counts() == {"b": {"waiting": 1}}


@pytest.mark.parametrize(
    "damage",
    [
        b"\n", b"{\n", b"[]\n", b"7\n", b"\xff\xfe\n", b'{"event": "done"}\n', b"[" * 9999 + b"\n",
        line("done", step="odd", node=7), line("done", step=0), line("planned", nodes=7),
        line("failed", step=0, node="a", labels=7), line("planned", nodes={"a": "odd", "fill": 3}),
        b'{"event": "progress", "seconds": NaN}\n', line("progress", left="odd"),
        *(b'{"event": "done", "seconds": %s}\n' % each for each in (b"1" * 400, b"9" * 5000)),
        b'{"event": "done", "seconds": -1e400}\n',
        b'{"event": "done", "node": "a", "seconds": 1, "step": 1e400}\n',
        b'{"event": "progress", "seconds": 1, "left": %s}\n' % (b"1" * 400),
    ],
)  # fmt: skip
def test_damaged_lines_are_passed_over(path: Path, damage: bytes) -> None:
    events = EventFile(path)
    append(path, damage, line("done", step=2, node="fill"))
    events.update()
    assert events.progress.counts()["fill"]["done"] == 1
