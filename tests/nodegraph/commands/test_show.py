"""``nodes`` and ``show`` tell what is installed."""

from __future__ import annotations

from collections.abc import Callable

Command = Callable[..., tuple[int, str, str]]


def test_nodes_are_listed(command: Command) -> None:
    status, out, _ = command("nodes")
    assert status == 0
    assert [line.split()[0] for line in out.splitlines()] == [
        "fill.hold", "fill.strict", "toy.cut", "toy.number", "toy.sum",
    ]  # fmt: skip
    assert command("nodes", "fill")[1] == command("nodes", "fill.*")[1]
    assert command("nodes", "toy")[1].count("\n") == 3
    status, out, err = command("nodes", "fil")
    assert (status, out) == (2, "")
    assert "no family 'fil'; did you mean 'fill'" in err
    status, _, err = command("nodes", "fill.hold")
    assert (status, "`nodegraph show fill.hold` shows it" in err) == (2, True)
    status, _, err = command("nodes", "fill.hodl")
    assert (status, "no node 'fill.hodl'; did you mean 'fill.hold'" in err) == (2, True)
    assert command("nodes", nodes=False)[0] == 0


def test_a_node_is_shown(command: Command) -> None:
    status, out, _ = command("show", "toy.cut")
    assert status == 0
    assert out.startswith("toy.cut    plugin toys\n\nin   x: float\nout  gappy: float\n")
    assert "truth: Truth[float]" in out
    assert "length   3        frames  whole number >= 1  Of the gap." in out
    assert out.endswith("cite: nothing\n")
    assert "hold2001 (no BibTeX entry is installed)" in command("show", "fill.hold")[1]
    assert command("show", "toys:toy.cut")[1] == out
    status, _, err = command("show", "toy.cutt")
    assert status == 2
    assert "did you mean 'toy.cut'" in err
