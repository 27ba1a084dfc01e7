"""Every installed node keeps its promises, a stranger's as well as ours."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

import pytest

from nodegraph.node.decorator import Node
from nodegraph.plugin.bibliography import references
from nodegraph.plugin.registry import Registered, Registry, default_registry
from nodegraph.testing import check_node
from nodegraph_files import sample_folder

HERE = Path(__file__).parent
NEEDS: Mapping[str, Callable[[], Mapping[str, Any]]] = {
    "blendshapes.from_frames": lambda: {"frames": {"smile": 15, "jawOpen": 30}},
    "compare.curve": lambda: {"x": "frames"},
    "markers.rename": lambda: {"names": {"nose": "forehead", "forehead": "nose"}},
    "plot.scatter": lambda: {"x": "rmse"},
    "points.literal": lambda: {"points": {"a": [1.0, 2.0], "b": [3.0, 4.0, 5.0]}},
    "read.head": lambda: {"path": HERE / "plugins" / "nodegraph_mocap" / "head.obj"},
    "read.model": lambda: {"path": sample_folder("face")},
    "read.recording": lambda: {"path": sample_folder("face")},
    "read.marker_set": lambda: {"path": sample_folder("face")},
    "recording.resample": lambda: {"rate": 44.1},
    "read.weights": lambda: {"path": HERE / "plugins" / "nodegraph_mocap" / "weights.csv"},
    "select.greedy": lambda: {"k": 5},
    "select.pfa": lambda: {"k": 5},
    "select.qr": lambda: {"k": 5},
    "select.random": lambda: {"k": 5},
    "select.variance": lambda: {"k": 5},
}
"""Values for settings that have no default."""

SMALL: Mapping[str, Mapping[str, Any]] = {"gaps.cut": {"length": 2, "count": 3}}
"""Values with which more of the specimens, which are short, can be done."""


@cache
def installed() -> Registry:
    return default_registry()


def names() -> list[str]:
    return sorted(one.full_name for one in installed())


def choices() -> Iterator[tuple[str, str, Any]]:
    """Yield every node, setting and choice that is not the default."""
    for name in names():
        for setting in found(name).node.settings.values():
            kind = setting.annotation
            options = (True, False) if kind is bool else get_args(kind)
            if kind is bool or get_origin(kind) is Literal:
                yield from ((name, setting.name, one) for one in options if one != setting.default)


def found(name: str) -> Registered:
    return installed().find(name)


def test_every_plugin_is_installed_and_imports() -> None:
    assert not installed().broken
    assert names()


@pytest.mark.parametrize("name", names())
def test_node_keeps_its_promises(name: str) -> None:
    node = found(name).node
    check_node(node.function, settings=needs(node))


@pytest.mark.parametrize(("name", "setting", "choice"), list(choices()))
def test_node_keeps_its_promises_with_each_choice(name: str, setting: str, choice: Any) -> None:
    node = found(name).node
    settings = {**needs(node), **SMALL.get(node.name, {}), setting: choice}
    check_node(node.function, settings=settings)


@pytest.mark.parametrize("name", names())
def test_node_cites_what_its_plugin_ships(name: str) -> None:
    told = references(installed().hooks.bibtex, found(name).node.cite)
    absent = [key for key, text in told.items() if text.startswith(f"{key} (")]
    assert not absent, f"no plugin ships a BibTeX entry {', '.join(absent)}"


def test_every_contract_says_what_it_promises() -> None:
    for promised in installed().hooks._manager.hook.nodegraph_contracts():
        for family, contracts in promised.items():
            assert family in installed().families
            assert all((one.__doc__ or "").strip() for one in contracts)


def needs(node: Node) -> Mapping[str, Any]:
    return NEEDS[node.name]() if node.name in NEEDS else {}
