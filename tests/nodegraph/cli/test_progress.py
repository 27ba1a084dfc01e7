"""Progress is shown as a bar in a terminal, and as lines otherwise."""

from __future__ import annotations

import io
import re
from collections.abc import Iterable, Iterator

import pytest

from nodegraph.cli.progress import Display, counts_text, progress, settled_line
from nodegraph.execute.events import Event

_COUNTED = {"done": "run"}


class FakeTerminal(io.StringIO):
    """Standard error, which may be a terminal."""


def events(states: Iterable[str], *, left: int | None = None, every: int = 1) -> list[Event]:
    """Return the events of a run whose steps end in these states."""
    states = list(states)
    run = [Event("planned", 0.0, detail={"steps": len(states), "nodes": {"a": 1, "b": 1}})]
    counts = dict.fromkeys(("run", "stored", "refused", "failed", "skipped"), 0)
    for number, state in enumerate(states):
        kinds = [state] if state in ("stored", "skipped") else ["started", state]
        reason = {"reason": "no frame"}
        run += [Event(kind, number / 5, number, "fill", {"k": number}, reason) for kind in kinds]
        counts[_COUNTED.get(state, state)] += 1
        if (number + 1) % every == 0:
            rest = len(states) - number - 1 if left is None else left
            detail = {**counts, "left": rest, "to_go": 12.2 if rest else None}
            run.append(Event("progress", number / 5, detail=detail))
    run.append(Event("finished", 3.0, detail={"done": counts["run"], **counts, "unneeded": 0}))
    return run


def show(run: Iterable[Event]) -> None:
    with progress() as display:
        for event in run:
            display(event)


def fake_stderr(monkeypatch: pytest.MonkeyPatch, *, is_terminal: bool = True) -> FakeTerminal:
    terminal = FakeTerminal()
    monkeypatch.setattr(terminal, "isatty", lambda: is_terminal)
    monkeypatch.setattr("sys.stderr", terminal)
    monkeypatch.setenv("TERM", "xterm")
    monkeypatch.setenv("COLUMNS", "120")
    return terminal


def plain(terminal: FakeTerminal) -> str:
    return re.sub(r"\x1b\[[0-9;?]*[A-Za-z]", "", terminal.getvalue())


def test_plain_lines_where_there_is_no_terminal(capsys: pytest.CaptureFixture[str]) -> None:
    show(events(["done"] * 98 + ["failed", "refused"]))
    out, err = capsys.readouterr()
    lines = err.splitlines()
    assert out == ""
    assert lines[:2] == [
        "100 steps of 2 nodes",
        "0:02  10 of 100 steps: 10 computed, 90 left, 0:12 to go",
    ]
    assert lines[-4:] == [
        "failed: fill(k=98): no frame",
        "refused: fill(k=99): no frame",
        "0:20  100 of 100 steps: 98 computed, 1 refused, 1 failed",
        "finished after 3.0 s: 98 computed, 1 refused, 1 failed",
    ]
    assert len(lines) == 14


def test_a_line_soon_says_how_long_a_slow_run_takes(capsys: pytest.CaptureFixture[str]) -> None:
    run = events(["done"] * 300)[:50]
    unknown = Event("progress", 2.0, detail={**run[3].detail, "to_go": None})
    show([run[0], unknown, *run[1:]])
    lines = capsys.readouterr().err.splitlines()
    assert lines[1:] == ["0:02  11 of 300 steps: 11 computed, 289 left, 0:12 to go"]


def test_unneeded_steps_are_not_in_the_total(
    capsys: pytest.CaptureFixture[str],
) -> None:
    run = events(["stored"] * 9 + ["done"], left=10)
    show([run[0], run[-2], run[-1]])
    assert "10 of 20 steps: 1 computed, 9 already stored" in capsys.readouterr().err


def test_all_planned_steps_are_in_the_total_while_results_are_looked_up(
    capsys: pytest.CaptureFixture[str],
) -> None:
    run = events(["done"] + ["stored"] * 19, left=0)
    show([run[0], *run[3:6]])
    assert "2 of 20 steps: 1 computed, 1 already stored" in capsys.readouterr().err


def test_stored_results_alone_are_counted_at_the_end(capsys: pytest.CaptureFixture[str]) -> None:
    show(events(["stored"] * 20))
    assert capsys.readouterr().err.splitlines() == [
        "20 steps of 2 nodes",
        "finished after 3.0 s: 20 already stored",
    ]


def test_skipped_steps_after_a_failure_are_counted_at_the_end(
    capsys: pytest.CaptureFixture[str],
) -> None:
    show(events(["failed"] + ["skipped"] * 19))
    assert capsys.readouterr().err.splitlines()[2:] == [
        "0:00  2 of 20 steps: 1 failed, 1 skipped, 18 left, 0:12 to go",
        "finished after 3.0 s: 1 failed, 19 skipped",
    ]


def test_a_run_without_steps(capsys: pytest.CaptureFixture[str]) -> None:
    show(events([]))
    lines = capsys.readouterr().err.splitlines()
    assert lines == ["0 steps of 2 nodes", "finished after 3.0 s: nothing to do"]


def test_a_bar_in_a_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    terminal = fake_stderr(monkeypatch)
    show(events(["done", "failed", "skipped", "refused", "stored"], left=33))
    text = plain(terminal)
    assert "failed: fill(k=1): no frame\n" in text
    assert "refused: fill(k=3): no frame\n" in text
    assert (
        "1 computed, 1 already stored, 1 refused, 1 failed, 1 skipped, 33 left, 0:12 to go" in text
    )
    assert "5/38" in text


@pytest.mark.parametrize("is_terminal", [True, False])
def test_the_first_failure_of_each_kind_is_shown_and_the_rest_are_counted(
    monkeypatch: pytest.MonkeyPatch, is_terminal: bool
) -> None:
    terminal = fake_stderr(monkeypatch, is_terminal=is_terminal)
    show(events(["refused"] * 40 + ["failed"] * 16, every=100))
    lines = [line.strip() for line in plain(terminal).splitlines()]
    assert "refused: fill(k=0): no frame" in lines
    assert "failed: fill(k=40): no frame" in lines
    assert sum(line.startswith(("refused", "failed")) for line in lines) == 2
    assert "and 39 more refused" in lines
    assert "and 15 more failed" in lines


def test_failures_of_many_kinds_are_not_all_shown(capsys: pytest.CaptureFixture[str]) -> None:
    show(Event("failed", 0.0, k, f"node{k}", detail={"reason": "no"}) for k in range(30))
    lines = capsys.readouterr().err.splitlines()
    assert len(lines) == 21
    assert lines[-1] == "and 10 more failed"


def test_reasons_that_differ_in_numbers_are_one_kind(capsys: pytest.CaptureFixture[str]) -> None:
    reasons = ["frame 3 is empty", "frame 17 is empty", "marker is empty"]
    show(Event("failed", 0.0, k, "a", detail={"reason": why}) for k, why in enumerate(reasons))
    assert capsys.readouterr().err.splitlines() == [
        "failed: a: frame 3 is empty", "failed: a: marker is empty", "and 1 more failed",
    ]  # fmt: skip


def test_an_interrupted_run_counts_its_failures(capsys: pytest.CaptureFixture[str]) -> None:
    def interrupted() -> Iterator[Event]:
        yield from events(["failed"] * 30, every=100)[:-1]
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        show(interrupted())
    assert capsys.readouterr().err.splitlines()[-1] == "and 29 more failed"


@pytest.mark.parametrize("is_terminal", [True, False])
def test_a_text_is_shown_as_it_is(monkeypatch: pytest.MonkeyPatch, is_terminal: bool) -> None:
    terminal = fake_stderr(monkeypatch, is_terminal=is_terminal)
    with progress() as display:
        assert isinstance(display, Display)
        display.say("the store [bold]cannot[/bold] be written")
    assert "the store [bold]cannot[/bold] be written\n" in plain(terminal)


def test_the_bar_is_not_updated_for_every_step(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from rich.progress import Progress

    calls: list[object] = []
    monkeypatch.setattr(Progress, "update", lambda self, task, **how: calls.append(how))
    fake_stderr(monkeypatch)
    show(events(["stored"] * 10_000, every=100))
    assert len(calls) == 101


def test_the_current_node_is_updated_ten_times_a_second(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    from rich.progress import Progress

    named: list[str] = []
    monkeypatch.setattr(
        Progress, "update", lambda self, task, **how: named.append(how.get("description", ""))
    )
    fake_stderr(monkeypatch)
    run: list[Event] = []
    for n in range(250):
        begun = Event("started", n / 1000, n, "fill", {"k": n})
        ended = Event("done", n / 1000, n - 2, "fill", {"k": n - 2})
        run += [begun, ended]
    show(run)
    assert named == ["fill(k=0)", "fill(k=98) and 2 more", "fill(k=198) and 2 more"]


def test_counts_as_text() -> None:
    counts = {"run": 120, "stored": 540, "refused": 0, "failed": 2, "skipped": 0}
    text = "120 computed, 540 already stored, 2 failed, 33 left"
    assert counts_text({**counts, "left": 33, "to_go": 12.0}) == f"{text}, 0:12 to go"
    assert counts_text({**counts, "left": 33, "to_go": 3723.0}) == f"{text}, 1:02:03 to go"
    assert counts_text({**counts, "left": 33, "to_go": None}) == text


def test_a_step_without_labels_is_its_node() -> None:
    assert settled_line(Event("failed", 0.0, 1, "table")) == "failed: table: "


def test_a_reason_is_one_line_without_commands_to_the_terminal() -> None:
    event = Event("failed", 0.0, 1, "a", detail={"reason": "two\nlines\x1b[2J"})
    assert settled_line(event) == "failed: a: two lines [2J"
