"""Wheels as users get them: ours alone, and a third-party plugin beside it.

The third-party wheel adds a method, a figure, a file format, an executor and a command.
"""

from __future__ import annotations

import csv
import shutil
import subprocess
import tarfile
import textwrap
import zipfile
from pathlib import Path

import pytest

from tests.environments import ROOT, Environment, build, one_wheel, run

HOLD = '''
"""Hold the last position over a gap."""

import numpy as np
from typing import Annotated

from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Origin, Trajectories


@node("fill.hold", cite="lab2026")
def hold(
    recording: Trajectories,
    *,
    max_gap: Annotated[int, Field(ge=1), Unit("frames")] = 30,
) -> Trajectories:
    """Repeat the last measured position over each gap.

    Parameters
    ----------
    max_gap
        For how many frames it is repeated; the rest of a longer gap stays missing.
    """
    frame = np.arange(recording.frames)[:, None]
    last = np.maximum.accumulate(np.where(recording.present, frame, -1), axis=0)
    held = ~recording.present & (last >= 0) & (frame - last <= max_gap)
    positions = recording.positions.copy()
    where = np.nonzero(held)
    positions[where] = recording.positions[last[where], where[1]]
    return recording.with_samples(positions, changed=held, origin=Origin.FILLED)
'''

SPARKLINE = '''
"""A type of its own, a figure that returns it, and how it is shown."""

from dataclasses import dataclass

import numpy as np

from nodegraph import Rendered, Value, node
from nodegraph_mocap import Trajectories


@dataclass(frozen=True)
class Sparkline(Value):
    heights: tuple[float, ...]


@node("plot.sparkline")
def sparkline(recording: Trajectories) -> Sparkline:
    """Plot the height of the head."""
    return Sparkline(tuple(np.nanmean(recording.positions[..., 1], axis=1).tolist()))


def render(value: Sparkline, title: str) -> Rendered:
    points = " ".join(f"{x},{-y:.1f}" for x, y in enumerate(value.heights))
    svg = f'<svg xmlns="http://www.w3.org/2000/svg"><polyline points="{points}"/></svg>'
    return Rendered(svg, f"{len(value.heights)} heights", files={".svg": svg.encode()})
'''

PLUGIN = '''
"""A plugin that adds a method, a figure, a file format, an executor and a command."""

from nodegraph import Command, Format, Kind, get_node, hookimpl


@hookimpl
def nodegraph_nodes():
    from nodegraph_lab.hold import hold
    from nodegraph_lab.sparkline import sparkline

    return [hold, sparkline]


@hookimpl
def nodegraph_bibtex():
    return """@article{lab2026,
        author = {Lab, A.}, title = {Standing still}, journal = {Journal}, year = {2026}
    }"""


@hookimpl
def nodegraph_kinds():
    from nodegraph_lab.sparkline import Sparkline, render

    return [Kind(Sparkline, render)]


@hookimpl
def nodegraph_formats():
    from nodegraph_mocap import Trajectories

    return [Format("LAB", Trajectories, (".lab",), read_lab)]


def read_lab(path, *, zeros_missing, unit, rate):
    """Read one marker: a line of x, y and z in mm per frame, at 100 Hz."""
    import numpy as np
    from nodegraph_mocap import Trajectories

    return Trajectories(positions=np.loadtxt(path)[:, None], markers=("nose",), rate=100.0)


@hookimpl
def nodegraph_executors():
    return {"one-by-one": one_by_one}


def one_by_one(schedule, how):
    print("one by one")
    while (call := schedule.next()) is not None:
        yield call.step, schedule.perform(call)


@hookimpl
def nodegraph_commands():
    return {"count": Command("Count the markers of a file.", add_arguments, count)}


def add_arguments(parser):
    parser.add_argument("file")


def count(arguments):
    from pathlib import Path

    recording = get_node("read.recording")(path=Path(arguments.file))
    print(len(recording.markers), "markers")
    return 0
'''

GRAPH = """
nodegraph: 1
title: Heights
nodes:
  capture: {use: read.recording, with: {path: "sample:face"}}
  fill: {use: fill.hold, in: capture}
  heights: {use: plot.sparkline, in: fill}
report: [heights]
"""


SMOOTH = """
nodegraph: 1
nodes:
  capture: {use: read.recording, with: {path: "sample:face"}}
  smooth: {use: smooth.one_euro, in: capture}
  table: {use: score.roughness, in: smooth}
report: [table]
"""
"""Reads a file of the package, and compiles a function."""

IN_TURN = """
import sys
from nodegraph.cli.main import main
for line in sys.argv[1:]:
    try:
        status = main(line.split())
    except SystemExit as ended:  # of argparse
        status = ended.code
    print("---")
    if status:
        sys.exit(status)
"""
"""Gives commands, each an argument, and says where the output of each ends."""


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel built from the tree."""
    return one_wheel(build(ROOT, tmp_path_factory.mktemp("wheel"), "--wheel"), "nodegraph")


@pytest.fixture(scope="module")
def through_sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with the sdist and the wheel built from it."""
    return build(ROOT, tmp_path_factory.mktemp("sdist"))


@pytest.fixture(scope="module")
def place(tmp_path_factory: pytest.TempPathFactory, wheel: Path) -> Environment:
    """A new environment in which our wheel and a third-party wheel are installed."""
    folder = tmp_path_factory.mktemp("third_party")
    modules = {"__init__": PLUGIN, "hold": HOLD, "sparkline": SPARKLINE}
    third_party = build(write_plugin(folder, "lab", modules), folder / "wheels", "--wheel")
    place = Environment.create(folder)
    place.install(wheel, one_wheel(third_party, "nodegraph_lab"))
    return place


def test_wheel_holds_the_packages_and_nothing_else(wheel: Path) -> None:
    files = names(wheel)
    top = {name.partition("/")[0] for name in files}
    packages = {folder.parent.name for folder in (ROOT / "plugins").glob("*/__init__.py")}
    assert {name for name in top if not name.endswith(".dist-info")} == {"nodegraph", *packages}
    assert {"nodegraph/py.typed", "nodegraph_mocap/graphs/fill.yaml"} <= set(files)
    ours = [name for name in files if "/templates/" not in name]
    assert not [name for name in ours if "test_" in name or "__pycache__" in name]


def test_wheel_from_the_sdist_is_the_wheel_from_the_tree(wheel: Path, through_sdist: Path) -> None:
    assert names(one_wheel(through_sdist, "nodegraph")) == names(wheel)
    with tarfile.open(next(through_sdist.glob("*.tar.gz"))) as archive:
        inside = {name.partition("/")[2] for name in archive.getnames()}
    assert {"tests/test_third_party.py", "graphs/fill.yaml", "LICENSE"} <= inside


def test_wheel_and_checkout_replace_each_other_and_a_run_writes_nothing_there(
    tmp_path: Path, wheel: Path
) -> None:
    (tmp_path / "smooth.yaml").write_text(SMOOTH)
    place = Environment.create(tmp_path)
    before = place.files()
    leave_what_an_earlier_version_left(place)
    place.install(wheel)
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


def test_a_third_party_method_joins_the_comparison(place: Environment, tmp_path: Path) -> None:
    labels = ("length=5", "condition=own_noise", "recording=face_1", "fill=hold,linear")
    only = " ".join(f"--only {label}" for label in labels)
    words = ("show fill.hold", "new fill", f"run fill.yaml {only} --until table")
    shown, *_ = in_turn(place, *words, cwd=tmp_path)
    assert "Repeat the last measured position over each gap." in shown
    assert "Standing still" in shown
    with (tmp_path / "runs" / "fill" / "table.csv").open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["fill"] == "hold"]
    assert [row["length"] for row in rows] == ["5"]
    assert float(rows[0]["mean"]) > 0.0
    assert "Standing still" in (tmp_path / "runs" / "fill" / "report.html").read_text("utf-8")


def test_a_third_party_figure_executor_and_command_work_like_ours(
    place: Environment, tmp_path: Path
) -> None:
    (tmp_path / "heights.yaml").write_text(GRAPH)
    out = nodegraph(place, "run", "heights.yaml", "--executor", "one-by-one", cwd=tmp_path).stdout
    assert "one by one" in out
    assert "<polyline points=" in (tmp_path / "runs/heights/report.html").read_text("utf-8")
    assert (tmp_path / "runs/heights/heights.svg").is_file()

    words = ("export runs/heights fill --out fill.csv", "count fill.csv", "help")
    _, counted, helped = in_turn(place, *words, cwd=tmp_path)
    assert counted == "60 markers\n"
    assert "Count the markers" in helped


def test_a_third_party_format_is_read_like_ours(place: Environment, tmp_path: Path) -> None:
    (tmp_path / "take.lab").write_text("1 2 3\n4 5 6\n")
    (tmp_path / "read.yaml").write_text(
        "nodegraph: 1\ntitle: Lab\nnodes:\n  take: {use: read.recording, with: {path: take.lab}}\n"
    )
    in_turn(place, "run read.yaml", "export runs/read take --out take.csv", cwd=tmp_path)
    lines = (tmp_path / "take.csv").read_text("utf-8").split()
    assert lines[-3:] == ["frame,nose.X,nose.Y,nose.Z", "0,1.0,2.0,3.0", "1,4.0,5.0,6.0"]


def test_a_plugin_that_does_not_import_is_named_and_the_rest_goes_on(
    place: Environment, tmp_path: Path
) -> None:
    about = place.site_packages / "nodegraph_broken-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: nodegraph-broken\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text("[nodegraph]\nbroken = a_module_that_is_not_there\n")
    try:
        listed = nodegraph(place, "show", "fill", cwd=tmp_path)
    finally:
        shutil.rmtree(about)
    assert "plugin 'broken' is left out" in listed.stderr
    assert "a_module_that_is_not_there" in listed.stderr
    assert {"fill.hold", "fill.muscle"} <= set(listed.stdout.split())
    assert "Repeat the last measured position over each gap." in listed.stdout


def test_a_new_plugin_is_installed_and_passes_its_own_tests(
    place: Environment, tmp_path: Path
) -> None:
    nodegraph(place, "new", "plugin", "hold_on", cwd=tmp_path)
    source = tmp_path / "hold_on"
    wheel = one_wheel(build(source, tmp_path / "wheels", "--wheel"), "hold_on")
    assert {"hold_on/references.bib", "hold_on/graphs/hold_on.yaml"} <= set(names(wheel))
    place.install("-e", source)
    (tmp_path / "pytest.ini").write_text("[pytest]\naddopts = --of-a-folder-above\n")
    # its tests run the graph that is written here
    nodegraph(place, "new", "hold_on", cwd=tmp_path)
    words = ("-m", "pytest", "-q", "-p", "no:cacheprovider")
    alone = {"PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1"}  # other plugins of pytest take a second
    result = run(str(place.python), *words, cwd=source, variables=alone)
    assert "3 passed" in result.stdout
    method = source / "hold_on" / "method.py"
    method.write_text(method.read_text("utf-8").replace("Repeat each", "Say again each"))
    shown = nodegraph(place, "show", "fill.hold_on", cwd=tmp_path).stdout
    assert "Say again each" in shown
    assert "Whatever the method is published in" in shown


def leave_what_an_earlier_version_left(place: Environment) -> None:
    """Make folders that look like packages, without modules."""
    for package in (ROOT / "plugins").glob("nodegraph_*"):
        left = place.site_packages / package.name / "left"
        left.mkdir(parents=True)
        (left / "a_kernel.run-1.py311.nbi").touch()


def check_run(place: Environment, steps: str, *words: str) -> None:
    """Check that the graph runs, and that nothing is written to what is installed."""
    installed = place.files()
    assert steps in place.run("nodegraph", "run", "smooth.yaml", *words)
    assert place.files() == installed


def check_all_is_there(place: Environment) -> None:
    """Check that nodes and example graphs are listed."""
    nodes, graphs, _ = place.run("python", "-c", IN_TURN, "show fill", "new").split("---\n")
    assert {"fill.muscle", "fill.subspace_kalman"} <= set(nodes.split())
    assert "fill" in graphs.split()


def write_plugin(folder: Path, name: str, modules: dict[str, str]) -> Path:
    """Write the source of a plugin package and return its folder."""
    source = folder / f"source_{name}"
    package = source / f"nodegraph_{name}"
    package.mkdir(parents=True)
    for module, text in modules.items():
        (package / f"{module}.py").write_text(text, encoding="utf-8")
    (source / "pyproject.toml").write_text(
        textwrap.dedent(f"""
            [build-system]
            requires = ["hatchling"]
            build-backend = "hatchling.build"
            [project]
            name = "nodegraph-{name}"
            version = "1.0"
            dependencies = ["nodegraph"]
            [project.entry-points.nodegraph]
            {name} = "nodegraph_{name}"
        """),
        encoding="utf-8",
    )
    return source


def names(wheel: Path) -> list[str]:
    with zipfile.ZipFile(wheel) as archive:
        return sorted(archive.namelist())


def nodegraph(place: Environment, *words: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return run(str(place.python.with_name("nodegraph")), *words, cwd=cwd)


def in_turn(place: Environment, *commands: str, cwd: Path) -> list[str]:
    """Give commands in one process, which must succeed; return what each prints."""
    *printed, _ = run(str(place.python), "-c", IN_TURN, *commands, cwd=cwd).stdout.split("---\n")
    return printed
