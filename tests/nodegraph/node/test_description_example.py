"""The example that ``show`` gives of a node is YAML, and uses only what the node has."""

from __future__ import annotations

import re
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

import pytest
import yaml
from pydantic import Field

from nodegraph import Across, Deprecated, InputFile, Truth, node
from nodegraph.graph import Choices, build
from nodegraph.graphfile import read_graph_text
from nodegraph.node.decorator import Node, node_of
from nodegraph.node.description import FILE, example_of, has_example, without_parameters
from nodegraph.node.ports import Port
from nodegraph.plugin.registry import Registered, Registry


def described(function: object) -> Node:
    node_ = node_of(function)
    assert node_ is not None
    return node_


@node("fill.one")
def one_port(
    fill: float,
    floor: float | None = None,
    *,
    length: Annotated[int, Deprecated("use frames")] = 3,
    gate: float | None = None,
    names: tuple[str, ...] = (),
    bounds: tuple[float, float] = (0.0, 1.5),
    other: int = 4,
) -> float:
    """Fill."""
    return fill


@node("score.several")
def several(
    estimate: Across[float],
    truth: Truth[float],
    *,
    kind: Literal["no", "yes"],
    count: Annotated[int, Field(ge=3)],
    share: Annotated[float, Field(gt=0, lt=1)],
    most: Annotated[float, Field(le=-2)],
    path: InputFile,
    pairs: Annotated[list[int], Field(min_length=2)],
    labels: dict[str, bool],
    shown: Annotated[int, Field(examples=[7])],
    text: str | None,
) -> float:
    """Score."""
    return 0.0


@node("make.nothing")
def without_anything() -> float:
    """Make."""
    return 0.0


@node("make.optional")
def optional(left: float | None = None, right: float | None = None) -> float:
    """Make.

    Examples
    --------
    >>> optional(1.0)
    0.0
    """
    return 0.0


@node("make.own")
def with_its_own() -> float:
    """Make.

    Examples
    --------
    Twice the same::

        one: {use: make.own}

    Notes
    -----
    None.
    """
    return 0.0


def test_a_first_port_needs_no_name_and_the_first_telling_default_is_shown() -> None:
    expected = "one: {use: fill.one, in: fill, with: {bounds: [0.0, 1.5]}}"
    assert example_of(described(one_port)) == expected
    assert example_of(described(one_port), "mine:fill.one").startswith("one: {use: 'mine:fill.one'")


def test_several_ports_are_named_and_what_must_be_set_has_a_value_that_will_do(
    tmp_path: Path,
) -> None:
    text = example_of(described(several))
    entry = yaml.safe_load(text)["score"]
    assert entry["in"] == {"estimate": "estimate", "truth": "truth"}
    settings = entry["with"]
    assert settings.pop("path") == FILE
    assert (settings["kind"], settings["count"], settings["pairs"]) == ("no", 3, [1, 1])
    assert (settings["labels"], settings["shown"]) == ({"NAME": True}, 7)
    assert 0 < settings["share"] < 1
    assert settings["most"] <= -2
    described(several).model.model_validate({**settings, "path": tmp_path})
    assert [line.partition(":")[0] for line in text.splitlines()] == [
        "score",
        "  use",
        "  in",
        "  with",
    ]


def test_what_a_node_does_not_have_is_not_shown() -> None:
    assert example_of(described(without_anything)) == "make: {use: make.nothing}"
    assert example_of(described(optional)) == "make: {use: make.optional, in: left}"


def test_a_node_s_own_example_counts_where_it_is_of_a_graph() -> None:
    assert has_example(described(with_its_own))
    assert not has_example(described(optional))
    assert not has_example(described(several))


INSTALLED = [
    registered
    for registered in Registry.installed()
    if registered.distribution.startswith("nodegraph ")
]


@pytest.fixture(scope="module")
def everything() -> Registry:
    """Every node that comes with the package, and one that gives each type that they take."""
    functions = [registered.node.function for registered in INSTALLED]
    ports = {_name(port): port for registered in INSTALLED for port in registered.node.inputs}
    return Registry.of([*functions, *(_giver(name, port) for name, port in ports.items())])


@pytest.mark.parametrize("registered", INSTALLED, ids=lambda registered: registered.node.name)
def test_the_example_of_every_node_stands_in_a_graph_that_is_well(
    registered: Registered, everything: Registry, tmp_path: Path
) -> None:
    (tmp_path / FILE).touch()
    for text in _shown(registered.node):
        (name,) = yaml.safe_load(text)
        feeding = [f"{port.name}: {{use: {_name(port)}}}" for port in registered.node.inputs]
        lines = [*text.splitlines(), *feeding]
        graph = "\n".join(["nodegraph: 1", "nodes:", *(f"  {line}" for line in lines)])
        spec = read_graph_text(graph, "graph.yaml", tmp_path)
        built = build(spec, everything, Choices(folder=tmp_path))
        (method,) = built.nodes[name].methods.values()
        assert method.node.function is registered.node.function


def _shown(node: Node) -> Iterable[str]:
    if not has_example(node):
        return [example_of(node)]
    written: list[str] = re.findall(
        r"^ *(\w+: \{use: .*\})$", without_parameters(node.doc), re.MULTILINE
    )
    assert written
    return written


def _name(port: Port) -> str:
    kind = re.sub(r"\W", "_", f"{port.type.__module__}_{port.type.__qualname__}".lower())
    return f"{'truth' if port.truth else 'give'}.{kind}"


def _giver(name: str, port: Port) -> Any:
    def give() -> Any:
        """Give a value of a type."""

    truth: Any = Truth
    give.__annotations__["return"] = truth[port.type] if port.truth else port.type
    return node(name)(give)
