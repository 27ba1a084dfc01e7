"""``run`` ends with 0, 1 when a step failed, 2 when it cannot begin."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Callable
from pathlib import Path

import pytest

import nodegraph_dask
from nodegraph.plugin import loading
from nodegraph.plugin.loading import Plugin
from nodegraph.store import Upkeep
from tests.nodegraph.cli.conftest import Command
from tests.records import read_record
from tests.texts import edit

FAILED = r"failed: fill\(length=[15], fill=strict\): too far"
"""Whichever of both ends first."""


def test_a_run_writes_its_folder_and_ends_with_0(command: Command) -> None:
    status, out, _ = command("run", "toy.yaml", "--executor", "serial")
    assert status == 0
    assert "runs/toy" in out
    for name in ("report.html", "run.json", "steps.jsonl.gz", "graph.yaml", "events.jsonl"):
        assert (Path("runs/toy") / name).is_file()
    assert Path("runs/toy/graph.yaml").read_text() == Path("toy.yaml").read_text()


def test_results_are_packed_after_the_answer_and_an_interrupt_loses_nothing(
    command: Command, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    before = []

    def tidy(_: Upkeep) -> str:
        before.append(capsys.readouterr().out)
        raise KeyboardInterrupt

    monkeypatch.setattr(Upkeep, "tidy", tidy)
    status, out, err = command("run", "toy.yaml")
    assert (status, out, err) == (0, "", "")
    (shown,) = before
    assert "runs/toy/report.html" in shown
    assert command("run", "toy.yaml")[1].count("stored") > 0


def test_a_run_with_other_settings_keeps_the_first(command: Command) -> None:
    command("run", "toy.yaml", "--out", "here")
    status, _, err = command("run", "toy.yaml", "--out", "here", "--set", "start=6")
    assert status == 0
    assert "the earlier run is now in here-" in err
    assert len([path for path in Path().iterdir() if path.name.startswith("here")]) == 2


def test_the_same_run_again_replaces_the_first(command: Command) -> None:
    command("run", "toy.yaml")
    status, _, err = command("run", "toy.yaml", "--jobs", "1")
    assert status == 0
    assert "the earlier run in runs/toy had the same results" in err
    assert [path.name for path in Path("runs").iterdir()] == ["toy"]


@pytest.mark.parametrize(
    "change",
    [
        lambda: Path("runs/toy/notes.txt").write_text("of the user"),
        lambda: Path("toy.yaml").write_text(Path("toy.yaml").read_text() + "notes: other\n"),
        lambda: Path("toys.py").write_text(
            Path("toys.py").read_text().replace("return start", "return start + 0.5")
        ),
        lambda: Path("runs/toy/run.json").write_text("[]"),
        lambda: Path("runs/toy/steps.jsonl.gz").write_bytes(b""),
    ],
)
def test_a_run_that_differs_in_anything_is_kept(
    command: Command, change: Callable[[], object]
) -> None:
    command("run", "toy.yaml")
    change()
    assert command("run", "toy.yaml")[0] == 0
    assert len(list(Path("runs").iterdir())) == 2


def test_runs_without_keys_are_kept(command: Command) -> None:
    for _ in range(2):
        command("run", "toy.yaml", "--no-cache")
    assert len(list(Path("runs").iterdir())) == 2


def test_quiet_prints_failures_only(command: Command) -> None:
    assert command("run", "toy.yaml", "-q") == (0, "", "")
    status, out, err = command("run", "toy.yaml", "-q", "--set", "start=-100")
    assert (status, out) == (1, "")
    first, *more = err.splitlines()
    assert re.match(FAILED, first)
    assert more == ["and 1 more failed"]


def test_the_answer_as_json(command: Command) -> None:
    status, out, _ = command("run", "toy.yaml", "--json", "--set", "start=-100")
    content = json.loads(out)
    assert status == 1
    assert (content["title"], content["ok"]) == ("A toy", False)
    assert content["report"] == "runs/toy/report.html"
    assert content["steps"] == {"done": 6, "failed": 2}
    (failed,) = content["failed"]
    assert failed["count"] == 2
    assert failed["reason"].startswith("too far")


def test_a_report_shows_an_entry_where_it_fixes_axes(command: Command) -> None:
    entry = "report: [{from: gaps, at: {length: 5}}]"
    Path("toy.yaml").write_text(f"{Path('toy.yaml').read_text()}{entry}\n")
    _, out, _ = command("run", "toy.yaml")
    assert "Gaps gappy length=5" in out
    assert "length=1" not in out


def test_a_refusal_is_no_failure(command: Command) -> None:
    status, _, err = command("run", "toy.yaml", "--set", "start=-8")
    assert status == 0
    assert "refused: fill(length=5, fill=strict): too small" in err


def test_warnings_of_steps_are_printed_once_for_all_combinations(command: Command) -> None:
    warning = "    import warnings; warnings.warn(f'gap of {length} is long')\n"
    cut = "    return Cut(x - length, x)"
    edit("toys.py", cut, warning + cut)
    _, out, _ = command("run", "toy.yaml")
    first, second = (f"warning: gaps (toy.cut) at length={n}: gap of {n} is long" for n in (1, 5))
    assert "\nwarning: gaps (toy.cut): gap of … is long (2 times)\n" in out
    assert first not in out
    _, out, _ = command("run", "toy.yaml", "--full")
    assert f"{first}\n{second}\n" in out


def test_a_failed_step_ends_with_1(command: Command) -> None:
    status, out, err = command("run", "toy.yaml", "--set", "start=-100")
    assert status == 1
    assert re.search(FAILED, err)
    assert "2 failed" in out
    assert Path("runs/toy/report.html").is_file()


def test_a_result_that_cannot_be_shown_ends_with_1(command: Command) -> None:
    text = Path("toys.py").read_text()
    Path("toys.py").write_text(
        f"{text}\n"
        "from nodegraph import Kind, hookimpl\n\n"
        "def explode(value, title):\n"
        "    raise RuntimeError('no ink')\n\n"
        "@hookimpl\n"
        "def nodegraph_kinds():\n"
        "    return [Kind(float, explode)]\n"
    )
    status, out, _ = command("run", "toy.yaml", "--until", "a")
    assert status == 1
    assert "1 step: 1 computed" in out
    (failure,) = (
        line for line in out.splitlines() if line.startswith("failed: a: cannot be shown")
    )
    assert "RuntimeError: no ink" in failure
    assert "Warnings and limitations" in (report := Path("runs/toy/report.html").read_text())
    assert "RuntimeError: no ink" in report.partition("Warnings and limitations")[2]


def test_a_failed_step_is_repeated_where_it_ran(command: Command) -> None:
    _, out, _ = command("run", "toy.yaml", "--set", "start=-100", "--executor", "serial")
    alone = next(line for line in out.splitlines() if "repeat it alone" in line)
    assert " --executor serial" in alone


def test_a_failed_step_is_repeated_alone_by_the_printed_command(command: Command) -> None:
    _, out, _ = command("run", "toy.yaml", "--set", "start=-100")
    alone = next(line for line in out.splitlines() if "repeat it alone" in line)
    words = shlex.split(alone.partition("alone: ")[2])
    assert words[:2] == ["nodegraph", "run"]
    status, out, _ = command(*words[1:], nodes=False)
    assert status == 1
    assert "3 steps: 2 stored, 1 failed" in out
    assert {path.name for path in Path("runs").iterdir()} == {"toy", "toy-fill"}
    steps = read_record("runs/toy-fill")["steps"]
    failed = next(step for step in steps if step["state"] == "failed")
    assert (failed["node"], failed["labels"]) == ("fill", {"length": 1, "fill": "strict"})
    assert failed["reason"] == "too far"
    assert "raise ValueError" in failed["trace"]
    assert failed["repeat"].startswith("nodegraph run toy.yaml")


def test_a_failed_step_of_chosen_labels_is_repeated_alone(command: Command) -> None:
    words = ["--set", "start=-100", "--only", "fill=strict,hold", "--until", "total"]
    _, out, _ = command("run", "toy.yaml", *words)
    alone = next(line for line in out.splitlines() if "repeat it alone" in line)
    status, out, _ = command(*shlex.split(alone.partition("alone: ")[2])[1:], nodes=False)
    assert status == 1
    assert "3 steps: 2 stored, 1 failed" in out


def test_until_runs_no_further(command: Command) -> None:
    status, out, _ = command("run", "toy.yaml", "--until", "gaps", "--until", "one")
    assert status == 0
    assert "4 steps: 4 computed" in out
    status, _, err = command("run", "toy.yaml", "--until", "gasp")
    assert status == 2
    assert "the graph has no node 'gasp'; did you mean 'gaps'?" in err


def test_stored_results_are_used_unless_no_cache_is_given(command: Command) -> None:
    assert "8 steps: 8 computed" in command("run", "toy.yaml")[1]
    assert "8 steps: 8 stored" in command("run", "toy.yaml")[1]
    assert "8 steps: 8 computed" in command("run", "toy.yaml", "--no-cache")[1]
    assert "8 steps: 8 computed" in command("run", "toy.yaml", "--store", "here")[1]
    assert "8 steps: 8 stored" in command("run", "toy.yaml", "--store", "here")[1]


def test_a_store_that_cannot_be_used_costs_no_result(command: Command) -> None:
    Path("store").write_text("not a folder")
    status, out, err = command("run", "toy.yaml", "--store", "store")
    assert status == 0
    assert "8 steps: 8 computed" in out
    assert "results are no longer kept: " in err
    assert Path("store").read_text() == "not a folder"


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["--jobs", "0"], "jobs must be 1 or more, got 0"),
        (["--jobs", "many"], "invalid int value"),
        (["--executor", "serail"], "did you mean 'serial'"),
        (["--out", "toys.py"], "toys.py exists and is not a run folder"),
        (["--out", "toys.py/x"], "cannot be written there"),
    ],
)
def test_a_run_that_cannot_begin_ends_with_2(
    command: Command, words: list[str], reason: str
) -> None:
    status, out, err = command("run", "toy.yaml", *words)
    assert (status, out) == (2, "")
    assert reason in err
    assert "def number" in Path("toys.py").read_text()


def test_a_cluster_that_does_not_answer_costs_nothing(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(loading, "installed", lambda: ([Plugin("dask", nodegraph_dask)], []))
    command("run", "toy.yaml")
    words = ["--executor", "dask", "--scheduler", "tcp://127.0.0.1:9"]
    status, out, err = command("run", "toy.yaml", *words, "--no-cache")
    assert (status, out) == (2, "")
    assert "no Dask scheduler answers at tcp://127.0.0.1:9" in err
    assert [path.name for path in Path("runs").iterdir()] == ["toy"]
    assert Path("runs/toy/report.html").is_file()
