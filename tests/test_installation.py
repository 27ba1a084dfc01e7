"""Wheels and checkouts replace each other in an environment, whatever was there before."""

from __future__ import annotations

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


def check_all_is_there(place: Environment) -> None:
    """Check that nodes and example graphs are listed."""
    nodes, graphs = place.run("python", "-c", LISTS).split("---\n")
    assert {"fill.muscle", "fill.subspace_kalman"} <= set(nodes.split())
    assert "fill" in graphs.split()


def test_wheel_and_checkout_replace_each_other_and_a_run_writes_nothing_there(
    place: Environment, wheel: Path
) -> None:
    before = place.files()
    for source, words, steps in (
        ([wheel], ("--executor", "processes", "--jobs", "1"), "3 computed"),
        (["-e", ROOT], (), "3 stored"),
    ):
        place.install("--force-reinstall", *source)
        installed = place.files()
        assert f"3 steps: {steps}" in place.run("nodegraph", "run", "graph.yaml", *words)
        assert place.files() == installed
    place.install("--force-reinstall", "--no-compile", wheel)
    check_all_is_there(place)
    assert list(place.home.rglob("nodegraph/kernels/*/one_euro_kernel.*.nbc"))
    place.uninstall("nodegraph")
    assert place.files() == before
    leave_what_an_earlier_version_left(place)
    place.install("-e", ROOT)
    check_all_is_there(place)


def test_kernels_compile_where_neither_packages_nor_home_can_be_written(
    place: Environment, wheel: Path
) -> None:
    leave_what_an_earlier_version_left(place)
    place.install("--no-compile", wheel)
    for package in place.site_packages.glob("nodegraph_*"):
        (package / "__pycache__").touch()  # a file where a folder would be written
    place.home.touch()
    installed = place.files()
    assert "3 steps: 3 computed" in place.run("nodegraph", "run", "graph.yaml")
    assert place.files() == installed
