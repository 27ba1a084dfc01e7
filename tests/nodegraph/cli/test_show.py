"""``show`` tells what is installed, and what is in a file."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from nodegraph.plugin import loading
from nodegraph.plugin.loading import Plugin
from tests.nodegraph.cli.conftest import READER, Command
from tests.texts import edit


def test_nodes_are_listed(command: Command) -> None:
    status, out, _ = command("show")
    assert status == 0
    assert [line.split()[0] for line in out.splitlines()] == [
        "fill.hold", "fill.strict", "toy.cut", "toy.number", "toy.sum",
    ]  # fmt: skip
    assert command("show", "fill")[1] == command("show", "fill.*")[1]
    assert command("show", "toy")[1].count("\n") == 3
    assert command("show", "HOLD")[1].split()[0] == "fill.hold"
    status, out, err = command("show", "fill.hodl")
    assert (status, out) == (2, "")
    assert "did you mean 'fill.hold'" in err
    assert "there is: fill, toy" in command("show", "lips")[2]
    assert command("show", nodes=False)[0] == 0


def test_a_node_is_shown(command: Command) -> None:
    status, out, _ = command("show", "toy.cut")
    assert status == 0
    assert out.startswith("toy.cut    plugin toys\n\nin   x: float\nout  gappy: float\n")
    assert "truth: Truth[float]" in out
    assert "length   3        frames  whole number >= 1  Of the gap." in out
    assert out.endswith("cite: nothing\n")
    hold = command("show", "fill.hold")[1]
    assert "\n\nas published\nlook-ahead 0 frames\nends of gaps not met\n\n" in hold
    assert "hold2001 (no BibTeX entry is installed)" in hold
    assert command("show", "toys:toy.cut")[1] == out
    status, _, err = command("show", "toy.cutt")
    assert status == 2
    assert "did you mean 'toy.cut'" in err


def test_an_example_is_shown_that_may_stand_in_a_graph(command: Command) -> None:
    _, out, _ = command("show", "toy.cut")
    example = "toy: {use: toy.cut, in: x, with: {length: 3}}"
    assert f"\n\nexample, among the nodes of a graph:\n  {example}\n\ncite:" in out
    text = (
        "Examples\n    --------\n    Of five:\n\n        gaps: {use: toy.cut, with: {length: 5}}\n"
    )
    edit("toys.py", "Of the gap.\n", f"Of the gap.\n\n    {text}")
    _, out, _ = command("show", "toy.cut")
    assert "gaps: {use: toy.cut, with: {length: 5}}" in out
    assert "\nexample, among the nodes of a graph:\n" not in out


def test_the_example_of_a_node_that_two_plugins_have_names_its_own(
    command: Command, monkeypatch: pytest.MonkeyPatch
) -> None:
    other = Plugin("other", loading.from_file(Path("toys.py")).module)
    monkeypatch.setattr(loading, "installed", lambda: ([other], []))
    _, out, _ = command("show", "other:toy.number")
    assert "\n  toy: {use: 'other:toy.number', with: {start: 1.0}}\n" in out


def test_a_file_is_read_by_the_node_of_its_format_and_its_facts_are_shown(
    command: Command,
) -> None:
    Path("reader.py").write_text(READER)
    Path("a.count").write_text("count:3000")
    words = ("a.count", "--plugin", "reader.py")
    status, out, _ = command("show", *words)
    assert status == 0
    assert out.splitlines() == [
        "a.count    Count, read by read.count",
        "",
        "number   3,000 things",
        "names    2: one, two",
        "nothing  none",
        "",
        "parts",
        "      size",
        "half  1,500",
        "",
        "guessed or left out",
        "- a.count: it states no unit",
    ]
    assert "number   3,000 things" in command("show", "toy:a.count", "--plugin", "reader.py")[1]
    data = json.loads(command("show", *words, "--json")[1])
    assert data["facts"][0] == {"name": "number", "value": 3000, "unit": "things"}
    assert data["facts"][3]["value"] == {"half": {"size": 1500}}
    assert (data["node"], data["warnings"]) == ("read.count", ["a.count: it states no unit"])


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("empty.count", "count:0", "empty.count:1: there is nothing; set `times`; write --with t"),
        ("a.other", "", "a.other: no node reads it"),
        ("far/away", None, "far/away: no such file"),
    ],
)
def test_a_file_that_cannot_be_read_is_named(
    command: Command, name: str, content: str | None, message: str
) -> None:
    Path("reader.py").write_text(READER)
    if content is not None:
        Path(name).write_text(content)
    status, out, err = command("show", name, "--plugin", "reader.py")
    assert (status, out) == (2, "")
    assert message in err


def test_a_file_that_is_too_large_is_refused_unread(command: Command) -> None:
    Path("reader.py").write_text(READER)
    with Path("large.count").open("wb") as file:
        file.truncate(2 * 10**9)
    status, _, err = command("show", "large.count", "--plugin", "reader.py")
    assert status == 2
    assert "large.count: 2.0 GB; files of up to 1.0 GB" in err


def test_a_folder_named_as_a_family_does_not_hide_its_nodes(command: Command) -> None:
    Path("fill").mkdir()
    assert command("show", "fill")[1].split()[0] == "fill.hold"


def test_what_a_file_does_not_state_can_be_set(command: Command) -> None:
    Path("reader.py").write_text(READER)
    Path("a.count").write_text("count:3")
    words = ("show", "a.count", "--plugin", "reader.py")
    assert "number   6 things" in command(*words, "--with", "times=2")[1]
    for setting, message in (
        ("time=2", "read.count: no setting 'time'; did you mean 'times'?"),
        ("times=two", "a.count: times: input should be a valid integer"),
        ("times=0", "a.count: times: input should be greater than or equal to 1"),
    ):
        status, out, err = command(*words, "--with", setting)
        assert (status, out) == (2, "")
        assert message in err
    assert "'fill.hold' is none" in command("show", "fill.hold", "--with", "times=2")[2]


def test_a_run_is_shown_by_another_command(command: Command) -> None:
    assert command("run", "toy.yaml", "--until", "a", "--out", "ran")[0] == 0
    status, _, err = command("show", "ran")
    assert status == 2
    assert "`nodegraph open ran` shows its report" in err
