"""``nodes`` and ``show`` tell what is installed."""

from __future__ import annotations

from pathlib import Path

import pytest

from nodegraph.plugin import loading
from nodegraph.plugin.loading import Plugin
from tests.nodegraph.cli.conftest import Command


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
    toys = Path("toys.py")
    toys.write_text(toys.read_text().replace("Of the gap.\n", f"Of the gap.\n\n    {text}"))
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
