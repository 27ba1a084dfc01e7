"""``diff`` names where two runs part, by how much, and why."""

from __future__ import annotations

import pytest

from tests.nodegraph.cli.conftest import Command
from tests.texts import edit


def ran(command: Command) -> None:
    assert command("run", "toy.yaml", "--store", "kept", "--out", "was")[0] in (0, 1)


def compared(command: Command) -> tuple[int, str]:
    assert command("run", "toy.yaml", "--store", "kept", "--out", "now")[0] in (0, 1)
    status, out, err = command("diff", "was", "now", "--store", "kept")
    assert err == ""
    return status, out


def test_equal_runs_have_no_difference(command: Command) -> None:
    ran(command)
    assert compared(command) == (0, "was and now: all 9 combinations have the same results\n")


def test_a_setting_explains_the_first_difference(command: Command) -> None:
    ran(command)
    edit("toy.yaml", "start: 5", "start: 6")
    status, out = compared(command)
    assert status == 1
    assert "input start was 5, now 6" in out
    first = out.split("\n\n")[1]
    assert first == "first: a\n    start was 5, now 6\n    output was 5.0, now 6.0"
    assert "what follows from that: gaps (2), fill (4), one (1), total (1)" in out


def test_an_edited_method_and_its_outputs_are_named(command: Command) -> None:
    ran(command)
    edit("toys.py", "Cut(x - length, x)", "Cut(x - length - 1, x)")
    status, out = compared(command)
    assert status == 1
    first = out.split("\n\n")[1]
    assert first.splitlines() == [
        "first: gaps(length=1) and 1 more of gaps",
        "    code: toys was edited",
        "    gappy was 4.0, now 3.0",
    ]


def test_labels_are_compared_however_many_there_are(command: Command) -> None:
    edit("toy.yaml", "[1, 5]", str([*range(1, 25)]))
    ran(command)
    edit("toy.yaml", "24]", "99]")
    status, out = compared(command)
    assert status == 1
    assert "axis length was (1, 2, " in out
    assert "23, 24), now (1, 2, " in out
    assert "23, 99)" in out


def test_combinations_of_one_run_only_are_counted(command: Command) -> None:
    ran(command)
    edit("toy.yaml", "[1, 5]", "[2, 5]")
    status, out = compared(command)
    assert status == 1
    assert "axis length was (1, 5), now (2, 5)" in out
    assert "only in was: " in out
    assert "gaps (1)" in out
    assert "fill (2)" in out


def test_an_edit_without_effect_is_counted(command: Command) -> None:
    ran(command)
    edit("toys.py", "return Cut(x - length, x)", "return Cut(-length + x, x)")
    status, out = compared(command)
    assert status == 0
    assert "all 9 combinations have the same results" in out
    assert "changed, with the same results: a (1), gaps (2), fill (4)" in out


def test_a_step_that_failed_in_one_run_only(command: Command) -> None:
    ran(command)
    edit("toy.yaml", "start: 5", "start: -90")
    status, out = compared(command)
    assert status == 1
    assert out.split("\n\n")[2].splitlines() == [
        "also: fill(length=1, fill=strict) and 1 more of fill=strict",
        "    was done, now failed (too far)",
    ]


def test_values_that_are_no_longer_stored_are_not_compared(command: Command) -> None:
    ran(command)
    edit("toy.yaml", "start: 5", "start: 6")
    command("run", "toy.yaml", "--store", "kept", "--out", "now")
    command("cache", "clear", "--store", "kept", nodes=False)
    status, out, _ = command("diff", "was", "now", "--store", "kept")
    assert status == 1
    assert "its values are no longer stored" in out


def test_runs_without_stored_results_cannot_be_compared(command: Command) -> None:
    command("run", "toy.yaml", "--no-cache", "--out", "was")
    command("run", "toy.yaml", "--no-cache", "--out", "now")
    status, out, _ = command("diff", "was", "now", "--store", "kept")
    assert status == 1
    assert "are unknown" in out


@pytest.mark.parametrize("runs", [("was", "nothing"), ("nothing", "was")])
def test_a_folder_without_a_run_is_named(command: Command, runs: tuple[str, str]) -> None:
    ran(command)
    status, _, err = command("diff", *runs)
    assert status == 2
    assert "nothing: there is no finished run" in err
