"""Ports and settings of a dataclass that several nodes share, as a plugin's file declares them."""

from __future__ import annotations

import inspect
import json
from dataclasses import KW_ONLY, dataclass
from pathlib import Path
from typing import Annotated, Any

import pytest
from pydantic import Field

import nodegraph as ng
from nodegraph import NodeError, Unit, node
from nodegraph.cli.main import main
from nodegraph.node.decorator import Node, node_of
from nodegraph.node.description import describe_settings, meanings
from nodegraph.testing import check_node

PLUGIN = '''
from __future__ import annotations

from dataclasses import KW_ONLY, dataclass, replace
from typing import Annotated

from pydantic import Field

from nodegraph import Unit, node
from nodegraph_mocap import Trajectories


@dataclass(frozen=True)
class Moved:
    """A recording and how far it is moved.

    Attributes
    ----------
    recording : Trajectories
        Any recording.
    far
        How far the camera goes.
    """

    recording: Trajectories
    _: KW_ONLY
    far: Annotated[float, Field(ge=0.0), Unit("mm")] = 10.0


def moved(recording: Trajectories, step: list[float]) -> Trajectories:
    return replace(recording, positions=recording.positions + step)


@node("camera.left", shares=Moved)
def left(moved_by: Moved) -> Trajectories:
    """Move the camera to the left."""
    return moved(moved_by.recording, [-moved_by.far, 0.0, 0.0])


@node("camera.up", shares=Moved)
def up(*, turns: int = 1, moved_by: Moved) -> Trajectories:
    """Move the camera up, several times.

    Depends on the axes.

    Parameters
    ----------
    turns
        How many times.
    """
    return moved(moved_by.recording, [0.0, turns * moved_by.far, 0.0])
'''
GRAPH = """
nodegraph: 1
nodes:
  face: {use: synthesize.face, with: {seconds: 1}}
  camera:
    in: {recording: face.captured}
    with: {far: 4.0}
    alternatives: {left: {use: camera.left}, up: {use: camera.up, with: {turns: 2}}}
"""


@dataclass(frozen=True)
class Asked:
    """What is asked.

    Attributes
    ----------
    recording : float
        A recording.
    count, share : float
        How many, and which
        part of them.

    Returns
    -------
    line : str
        All that is asked.
    kind : str
        A kind.

    Raises
    ------
    ValueError
        If nothing is asked.
    """

    recording: float
    _: KW_ONLY
    count: Annotated[int, Field(ge=1)]
    share: Annotated[float, Unit("share")] = 0.5


@dataclass(frozen=True, kw_only=True)
class Limited(Asked):
    """What is asked, with another default.

    Attributes
    ----------
    share
        Half at least.
    """

    share: Annotated[float, Field(ge=0.5)] = 0.75


@dataclass(frozen=True, kw_only=True)
class Named:
    """A name.

    Attributes
    ----------
    name
        Any name.
    """

    name: str


def described(function: Any) -> Node:
    definition = node_of(function)
    assert definition is not None
    return definition.check()


@node("toy.first", shares=Asked)
def first(asked: Asked, floor: float | None = None, *, names: tuple[str, ...] = ()) -> str:
    """Put what is given in a line.

    Parameters
    ----------
    floor
        A floor.
    names
        Names.

    Returns
    -------
    kind : int
        Another kind.

    Examples
    --------
    One.
    """
    return f"{asked.recording} {asked.count} {asked.share} {floor} {names}"


@node("toy.last", shares=Limited)
def last(floor: float, *, names: tuple[str, ...] = (), asked: Limited) -> str:
    """Put it elsewhere."""
    return f"{floor} {names} {asked.recording} {asked.count} {asked.share}"


def test_fields_stand_where_the_argument_stands() -> None:
    assert [port.name for port in described(first).inputs] == ["recording", "floor"]
    assert list(described(first).settings) == ["count", "share", "names"]
    assert [port.name for port in described(last).inputs] == ["floor", "recording"]
    assert list(described(last).settings) == ["names", "count", "share"]
    assert described(first).settings["count"].required
    assert described(first).settings["share"].unit == "share"
    assert described(last).settings["share"].default == 0.75


def test_the_documentation_is_that_of_the_dataclass_and_of_the_function() -> None:
    assert described(first).doc.partition("Parameters\n----------\n")[2] == (
        "recording\n    A recording.\n"
        "floor\n    A floor.\n"
        "count, share\n    How many, and which\n    part of them.\n"
        "names\n    Names.\n\n"
        "Returns\n-------\nline : str\n    All that is asked.\nkind : int\n    Another kind.\n\n"
        "Raises\n------\nValueError\n    If nothing is asked.\n\n"
        "Examples\n--------\nOne."
    )
    assert described(last).doc.endswith("\nValueError\n    If nothing is asked.")
    assert meanings(described(last)) == {
        "recording": "A recording.",
        "count": "How many, and which part of them.",
        "share": "Half at least.",
    }


def test_whoever_calls_it_gives_the_fields() -> None:
    assert first(1.0, 2.0, count=3) == "1.0 3 0.5 2.0 ()"
    assert last(2.0, recording=1.0, count=3, share=0.9, names=("a",)) == "2.0 ('a',) 1.0 3 0.9"
    assert list(inspect.signature(first).parameters) == [
        "recording", "floor", "count", "share", "names",
    ]  # fmt: skip
    with pytest.raises(TypeError, match="missing a required argument: 'count'"):
        first(1.0)


def test_a_value_of_the_dataclass_gives_the_defaults() -> None:
    @node("toy.named", shares=Named(name="dot"))
    def named(recording: float, *, file: Named) -> str:
        """Return a name."""
        return f"{file.name} {recording}"

    assert named(1.0) == "dot 1.0"
    assert named(1.0, name="dash") == "dash 1.0"
    (text,) = describe_settings(described(named))
    assert (text.default_text, text.meaning) == ("dot", "Any name.")


def test_what_does_not_fit_the_dataclass_is_named() -> None:
    with pytest.raises(NodeError, match=r"toy\.none: no argument is annotated with Named, which"):

        @node("toy.none", shares=Named)
        def none(recording: float) -> float:
            return recording

    with pytest.raises(NodeError, match=r"toy\.twice: duplicate parameter name: 'name'"):

        @node("toy.twice", shares=Named)
        def twice(file: Named, *, name: str) -> str:
            return name + file.name


def test_a_plugin_shares_settings_among_its_nodes(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plugin, graph = tmp_path / "camera.py", tmp_path / "graph.yaml"
    plugin.write_text(PLUGIN)
    graph.write_text(GRAPH)
    loaded = ng.load(graph, plugins=[plugin])
    store = tmp_path / "store"
    run = ng.run(loaded, store=store)
    face = run["face.captured"].value.positions
    moved = [run["camera"].at(camera=label).positions - face for label in ("left", "up")]
    assert [float(step[0, 0].round(6).sum()) for step in moved] == [-4.0, 8.0]
    again = ng.run(ng.load(graph, plugins=[plugin]), store=store, executor="processes")
    assert again.ok
    assert {outcome.status.value for outcome in again.outcomes.values()} == {"stored"}

    assert main(["show", "camera.up", "--plugin", str(plugin)]) == 0
    text = capsys.readouterr().out
    assert "How far the camera goes." in text
    assert "How many times." in text
    assert main(["schema", "--plugin", str(plugin)]) == 0
    assert "How far the camera goes." in json.dumps(json.loads(capsys.readouterr().out))
    graph.write_text(GRAPH.replace("far: 4.0", "far: -4.0"))
    assert main(["check", str(graph), "--plugin", str(plugin)]) == 2
    assert "far" in capsys.readouterr().err


def test_shared_settings_keep_the_promises_of_nodes(tmp_path: Path) -> None:
    plugin = tmp_path / "camera.py"
    plugin.write_text(PLUGIN)
    registry = ng.plugin.registry.Registry.installed([plugin])
    check_node(registry.find("camera.left").node.function, registry=registry)
