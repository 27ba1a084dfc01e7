"""Nodes that damage a recording take a truth of its own, to which errors are measured."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph.cli.main import main
from nodegraph_mocap import Trajectories

NODES = ("gaps.cut", "noise.add", "impulses.add", "points.scatter")
NAMES = ("a", "b", "c", "d")


def recording(*, shift: float = 0.0, markers: tuple[str, ...] = NAMES) -> Trajectories:
    random = np.random.default_rng(3)
    positions = random.normal(size=(300, len(markers), 3)) + shift
    return Trajectories(positions=positions, markers=markers, rate=60.0)


@pytest.mark.parametrize("name", NODES)
def test_the_truth_comes_out_as_it_went_in_and_changes_nothing_else(name: str) -> None:
    node: Any = get_node(name)
    truth = recording(shift=5.0).keep(reversed(NAMES))
    alone, beside = node(recording()), node(recording(), truth=truth)
    assert beside.truth is truth
    for output, other in zip(alone, beside, strict=True):
        if not isinstance(output, Trajectories) or output is not alone.truth:
            assert all(
                np.array_equal(value, vars(other)[field], equal_nan=True)
                for field, value in vars(output).items()
                if isinstance(value, np.ndarray)
            )


def nearly_empty(truth: Trajectories) -> Trajectories:
    positions = np.full_like(truth.positions, np.nan)
    positions[0] = truth.positions[0]
    return Trajectories(positions=positions, markers=truth.markers, rate=truth.rate)


@pytest.mark.parametrize("name", NODES)
@pytest.mark.parametrize(
    ("change", "named"),
    [
        (lambda truth: replace(truth, rate=120.0), ("120 Hz", "60")),
        (
            lambda truth: replace(truth, positions=truth.positions[1:], origin=truth.origin[1:]),
            ("299", "300"),
        ),
        (lambda truth: truth.keep(NAMES[:3]), ("lacks d",)),
        (lambda truth: replace(truth, markers=("a", "b", "c", "e")), ("lacks d", "besides e")),
    ],
)
def test_a_truth_that_does_not_fit_is_an_error(
    name: str, change: Callable[[Trajectories], Trajectories], named: tuple[str, ...]
) -> None:
    node: Any = get_node(name)
    with pytest.raises(ValueError, match="truth") as caught:
        node(recording(), truth=change(recording()))
    assert all(text in str(caught.value) for text in named)


@pytest.mark.parametrize("name", ["gaps.cut", "impulses.add"])
def test_a_damaged_sample_must_be_in_the_truth(name: str) -> None:
    node: Any = get_node(name)
    with pytest.raises(ValueError, match=r"frame \d+, marker '[abcd]': the truth has no"):
        node(recording(), truth=nearly_empty(recording()))


GRAPH = """nodegraph: 1
nodes:
  face: {use: synthesize.face, with: {seconds: 2.0, markers: 12, impulses: 0.0, noise: 0.4}}
  gaps: {use: gaps.cut, in: WIRES, with: {count: 4, length: 5}}
  fill: {use: fill.linear, in: FILLED}
  error: {use: score.gaps, in: {estimate: fill, truth: TRUTH, hidden: gaps.hidden}}
"""


@pytest.mark.parametrize(
    ("wires", "filled", "truth", "says"),
    [
        ("{recording: face.captured, truth: face.truth}", "gaps", "gaps.truth", ""),
        ("face.truth", "gaps", "gaps.truth", ""),
        ("face.captured", "gaps", "face.truth", ""),
        ("face.truth", "gaps", "face.truth", "6:43: error is scored"),
        ("face.truth", "face.truth", "gaps.truth", "5:32: fill: face"),
        (
            "{recording: face.captured, truth: face.truth}", "face.captured", "gaps.truth",
            "6:43: error is scored",
        ),
    ],
)  # fmt: skip
def test_graphs_with_a_truth_of_their_own(
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    wires: str,
    filled: str,
    truth: str,
    says: str,
) -> None:
    text = GRAPH.replace("WIRES", wires).replace("FILLED", filled).replace("TRUTH", truth)
    path = tmp_path / "study.yaml"
    path.write_text(text)
    assert main(["check", str(path)]) == (2 if says else 0)
    assert says in capsys.readouterr().err
