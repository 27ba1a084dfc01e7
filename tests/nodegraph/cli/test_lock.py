"""``lock`` writes a small text that says everything, in which nothing is of one machine."""

from __future__ import annotations

import difflib
import re
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
import yaml

from nodegraph.cli.main import main
from nodegraph.lock.lockfile import read_lock
from tests.texts import edit

from . import frozen

VARYING = "os.path.getsize('calls.txt') / 1e6"
Locked = Callable[..., tuple[int, str, str]]


@pytest.fixture
def locked(capsys: pytest.CaptureFixture[str]) -> Locked:
    """Write the study, and lock it; return exit status, output and errors."""
    frozen.write_study()

    def call(*words: str, graph: str = "study.yaml") -> tuple[int, str, str]:
        more = ("--plugin", "study.py", "--store", "kept", "--executor", "serial")
        status = main(["lock", graph, *more, *words])
        return status, *capsys.readouterr()

    return call


def test_a_lock_lies_beside_the_graph_and_says_everything(locked: Locked) -> None:
    status, out, _ = locked()
    assert status == 0
    assert out.splitlines()[0] == "10 steps: 10 done"
    assert re.fullmatch(r"study\.lock \([\d.]+ KB\)", out.splitlines()[1])
    lock = read_lock(Path("study.lock"))
    record = lock.record
    assert record.settings.graph == "study.yaml"
    assert record.axes == {"length": [2, 5], "fill": ["mean", "shift"]}
    assert [step.settings for step in record.steps if step.node == "cut"] == [
        {"length": 2},
        {"length": 5},
    ]
    assert record.nodes["fill"].methods["mean"].use == "fill.mean"
    assert next(step for step in record.steps if step.node == "sheet").files.keys() == {"path"}
    assert "numpy" in record.versions
    assert len(record.units["study"]) == 10
    assert lock.conclusions == {"order": ["mean < shift"]}
    assert lock.tables["order"].splitlines()[0] == "fill,mean"
    assert lock.text == {"study.yaml": frozen.GRAPH}
    assert lock.tolerance == 1e-9


def test_what_people_read_in_a_lock_is_plain_yaml(locked: Locked) -> None:
    locked("--axis", "length=2,12")
    data = yaml.safe_load(Path("study.lock").read_text())
    assert list(data)[:3] == ["nodegraph_lock", "checksum", "title"]
    assert data["tables"]["order"].splitlines()[1].startswith("mean,")
    assert data["axis"] == {"length": [2, 12]}
    assert data["methods"]["cut"]["settings"] == {"length": "$length"}
    fill = data["methods"]["fill=shift"]
    assert (fill["use"], fill["from"]) == ("fill.shift", "study of a file")
    assert fill["results"] == "1 done, 1 refused: a gap of 12.0 cells"
    assert data["text"]["study.yaml"] == frozen.GRAPH
    assert max(map(len, data["record"].splitlines())) < 100


def test_every_combination_has_a_result_with_its_digest(locked: Locked) -> None:
    locked()
    steps = read_lock(Path("study.lock")).record.steps
    assert sorted(cell.name for step in steps for cell in step.cells) == [
        "cut(length=2)",
        "cut(length=5)",
        "fill(length=2, fill=mean)",
        "fill(length=2, fill=shift)",
        "fill(length=5, fill=mean)",
        "fill(length=5, fill=shift)",
        "order",
        "picture",
        "sheet",
        "written",
    ]
    assert {len(digest) for step in steps for digest in step.digests} == {10}
    assert {step.node for step in steps if not step.sketch} == {"picture", "written"}


def test_the_same_study_gives_the_same_lock_wherever_it_lies(
    locked: Locked, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    locked()
    text = Path("study.lock").read_text()
    assert str(tmp_path) not in text
    there = tmp_path / "elsewhere" / "deep"
    shutil.copytree(tmp_path, there, ignore=shutil.ignore_patterns("kept", "elsewhere"))
    monkeypatch.chdir(there)
    assert locked("--jobs", "1")[0] == 0
    assert Path("study.lock").read_text() == text


def test_an_edit_of_the_graph_shows_in_few_lines(locked: Locked) -> None:
    locked()
    before = Path("study.lock").read_text().splitlines()
    edit("study.yaml", "use: toy.cut, in: sheet", "in: sheet, use: toy.cut")
    locked()
    after = Path("study.lock").read_text().splitlines()
    changed = [line for line in difflib.ndiff(before, after) if line[:2] in ("- ", "+ ")]
    assert [line[2:].split(":")[0].strip() for line in changed] == ["checksum"] * 2 + ["cut"] * 2


def test_choices_are_part_of_a_lock(locked: Locked) -> None:
    locked("--axis", "length=3", "--only", "fill=mean", "--out", "less.lock")
    record = read_lock(Path("less.lock")).record
    assert record.settings.axis == {"length": [3]}
    assert record.settings.only == {"fill": ["mean"]}
    assert record.axes == {"length": [3], "fill": ["mean"]}


def test_the_texts_of_graphs_that_it_uses_are_part_of_a_lock(locked: Locked) -> None:
    Path("inner.yaml").write_text(frozen.INNER)
    Path("study.yaml").write_text(frozen.OUTER)
    assert locked()[0] == 0
    assert read_lock(Path("study.lock")).text["inner.yaml"] == frozen.INNER


def test_what_fails_or_is_refused_is_part_of_a_lock(locked: Locked) -> None:
    edit("study.yaml", "[2, 5]", "[2, 12, 99]")
    fails = (
        "if len(sheet.cells) == np.isnan(sheet.cells).sum(): raise ValueError('empty')\n    if np."
    )
    edit("study.py", "if np.", fails)
    status, out, err = locked()
    assert status == 1
    assert "1 refused, 1 failed" in out
    assert "some steps failed" in err
    steps = read_lock(Path("study.lock")).record.steps
    endings = {step.labels["length"]: step.ending for step in steps if step.use == "fill.shift"}
    assert endings == {2: "done", 12: "refused: a gap of 12.0 cells", 99: "failed"}


def test_a_file_that_is_no_lock_is_left_alone(locked: Locked) -> None:
    status, _, err = locked("--out", "study.py")
    assert status == 2
    assert "study.py exists and is not a lock" in err
    assert Path("study.py").read_text() == frozen.NODES


def test_an_unwritable_place_is_refused_before_anything_runs(locked: Locked) -> None:
    status, _, err = locked("--out", "study.py/x.lock")
    assert status == 2
    assert "study.py/x.lock: cannot be written: study.py is a file" in err
    assert not Path("calls.txt").exists()


def test_results_that_vary_in_an_audit_are_named(locked: Locked) -> None:
    edit("study.py", "np.loadtxt(path) +", f"np.loadtxt(path) + {VARYING} +")
    words = ("--plugin", "study.py", "--store", "kept", "--executor", "serial")
    assert main(["verify", "study.yaml", "--repeat", *words]) == 1
    _, out, _ = locked()
    reason = "1 result is not stored: read.sheet: an audit found that it gives another answer"
    assert reason in out


def test_a_damaged_lock_is_written_again(locked: Locked) -> None:
    locked()
    text = Path("study.lock").read_text()
    Path("study.lock").write_bytes(text.replace("\n", "\r\n")[:500].encode())
    assert locked()[0] == 0
    assert Path("study.lock").read_text() == text


def test_a_graph_that_names_a_place_of_one_machine_is_refused(
    locked: Locked, tmp_path: Path
) -> None:
    path = tmp_path / "numbers.txt"
    edit("study.yaml", "file: numbers.txt", f"file: {path}")
    status, _, err = locked()
    assert status == 2
    assert f"sheet: path: {path} " in err
    assert "--set" in err
    assert not Path("calls.txt").exists()


def test_a_graph_without_a_title_may_be_named_by_its_whole_path(
    locked: Locked, tmp_path: Path
) -> None:
    edit("study.yaml", "title: A frozen toy\n", "")
    assert locked(graph=str(tmp_path / "study.yaml"))[0] == 0
    text = Path("study.lock").read_text()
    assert "title: study.yaml\n" in text
    assert str(tmp_path) not in text


def test_a_text_with_a_place_of_this_machine_is_refused(locked: Locked, tmp_path: Path) -> None:
    edit("study.yaml", "A frozen toy", f"As in {tmp_path / 'notes.txt'}")
    status, _, err = locked()
    assert status == 2
    assert f"{tmp_path}/" in err
    assert "title: " in err
    assert not Path("study.lock").exists()


def test_a_label_that_is_a_place_of_one_machine_is_refused(locked: Locked, tmp_path: Path) -> None:
    edit("study.yaml", "path: $file", "path: $source")
    edit("study.yaml", "inputs: {file: numbers.txt}\n", "")
    edit("study.yaml", "[2, 5]}", "[2, 5], source: [numbers.txt]}")
    path = tmp_path / "numbers.txt"
    status, _, err = locked("--axis", f"source={path}")
    assert status == 2
    assert f"axis source: the label {path} " in err
    assert "{label: path, ...}" in err


def test_a_file_that_the_command_names_is_called_by_how_it_lies_to_the_graph(
    locked: Locked, tmp_path: Path
) -> None:
    Path("data").mkdir()
    frozen.write_numbers("data/mine.txt")
    assert locked("--set", f"file={tmp_path / 'data' / 'mine.txt'}")[0] == 0
    record = read_lock(Path("study.lock")).record
    assert record.settings.set == {"file": "data/mine.txt"}
    assert record.inputs == {"file": "data/mine.txt"}
    assert record.steps[0].settings == {"path": "data/mine.txt"}
