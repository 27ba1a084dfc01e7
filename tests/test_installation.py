"""Wheels and checkouts replace each other in an environment, whatever was there before."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from tests.environments import ROOT, Environment

GRAPH = """
nodegraph: 1
nodes:
  capture: {use: read.recording, with: {path: "sample:face"}}
  smooth: {use: smooth.one_euro, in: capture}
  table: {use: score.roughness, in: smooth}
report: [table]
"""
"""Reads a file of the package, and compiles a function."""

LISTS = """
from nodegraph.cli.main import main
main(["show", "fill"])
print("---")
main(["new"])
"""


@pytest.fixture
def place(tmp_path: Path) -> Environment:
    """An environment without nodegraph, with a graph beside it."""
    (tmp_path / "graph.yaml").write_text(GRAPH)
    return Environment.create(tmp_path)


def leave_what_an_earlier_version_left(place: Environment) -> None:
    """Make folders that look like packages, without modules."""
    for package in (ROOT / "plugins").glob("nodegraph_*"):
        left = place.site_packages / package.name / "left"
        left.mkdir(parents=True)
        (left / "a_kernel.run-1.py311.nbi").touch()


def check_run(place: Environment, steps: str, *words: str) -> None:
    """Check that the graph runs, and that nothing is written to what is installed."""
    installed = place.files()
    assert steps in place.run("nodegraph", "run", "graph.yaml", *words)
    assert place.files() == installed


def check_all_is_there(place: Environment) -> None:
    """Check that nodes and example graphs are listed."""
    nodes, graphs = place.run("python", "-c", LISTS).split("---\n")
    assert {"fill.muscle", "fill.subspace_kalman"} <= set(nodes.split())
    assert "fill" in graphs.split()


def test_wheel_and_checkout_replace_each_other_and_a_run_writes_nothing_there(
    place: Environment, wheel: Path
) -> None:
    before = place.files()
    leave_what_an_earlier_version_left(place)
    place.install("--no-compile", wheel)
    # files where folders would be written
    in_the_way = [
        place.home,
        *(each / "__pycache__" for each in place.site_packages.glob("nodegraph_*/")),
    ]
    for path in in_the_way:
        path.touch()
    check_run(place, "3 steps: 3 computed")  # kernels are compiled for this run alone
    for path in in_the_way:
        path.unlink()

    place.install("-e", ROOT)
    check_all_is_there(place)
    check_run(place, "3 steps: 3 stored")

    for left in place.site_packages.glob("nodegraph_*/"):
        shutil.rmtree(left)
    place.install("--force-reinstall", wheel)
    other = ("--no-cache", "--executor", "processes", "--jobs", "1")
    check_run(place, "3 steps: 3 computed", *other)
    assert list(place.home.rglob("nodegraph/kernels/*/one_euro_kernel.*.nbc"))
    place.uninstall("nodegraph")
    assert place.files() == before
