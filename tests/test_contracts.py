"""Every installed node keeps its promises, with its defaults and with each choice of a setting."""

from __future__ import annotations

import gc
import re
import warnings
from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import pytest

from nodegraph.node.decorator import Node
from nodegraph.plugin.bibliography import entry_keys
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import default_registry
from nodegraph.testing import check_node
from nodegraph.testing.specimens import variants
from nodegraph_files import sample_folder

HERE = Path(__file__).parent
REQUIRED: Mapping[str, Callable[[], Mapping[str, object]]] = {
    "blendshapes.from_frames": lambda: {"frames": {"smile": 15, "jawOpen": 30}},
    "compare.bayes": lambda: {"clusters": ("gap",)},
    "compare.curve": lambda: {"x": "frames"},
    "gaps.from_matrix": lambda: {"path": HERE / "plugins" / "nodegraph_gaps" / "matrix.txt"},
    "markers.rename": lambda: {"names": {"nose": "forehead", "forehead": "nose"}},
    "plot.scatter": lambda: {"x": "rmse"},
    "points.literal": lambda: {"points": {"a": [1.0, 2.0], "b": [3.0, 4.0, 5.0]}},
    "read.animation": lambda: {"path": HERE / "plugins" / "nodegraph_files" / "animation.glb"},
    "read.head": lambda: {"path": HERE / "plugins" / "nodegraph_files" / "head.obj"},
    "read.model": lambda: {"path": sample_folder("face")},
    "read.recording": lambda: {"path": sample_folder("face")},
    "read.marker_set": lambda: {"path": sample_folder("face")},
    "read.marks": lambda: {"path": HERE / "plugins" / "nodegraph_markers" / "marks.csv"},
    "read.selection": lambda: {"path": HERE / "plugins" / "nodegraph_files" / "selection.yaml"},
    "read.truth": lambda: {"path": sample_folder("face")},
    "recording.resample": lambda: {"rate": 44.1},
    "read.weights": lambda: {"path": HERE / "plugins" / "nodegraph_files" / "weights.csv"},
    "select.greedy": lambda: {"k": 5},
    "select.pfa": lambda: {"k": 5},
    "select.qr": lambda: {"k": 5},
    "select.random": lambda: {"k": 5},
    "select.variance": lambda: {"k": 5},
}
"""Values for settings that have no default."""

SMALL: Mapping[str, Mapping[str, object]] = {"gaps.cut": {"length": 2, "count": 3}}
"""Values for choices of settings, with which a node accepts more of the specimens."""

TUNED = {"settings": "tuned"}
"""One choice of all fills, checked with one of them: tests of tuning tune each."""

TAKES_AND_GIVES_ANSWERS = {
    "gaps.cut": (["truth"], ["truth"]),
    "gaps.dropout": (["truth"], ["truth"]),
    "gaps.from_matrix": (["truth"], ["truth"]),
    "impulses.add": (["truth"], ["truth", "impulses"]),
    "noise.add": (["truth"], ["truth"]),
    "plot.alignment": (["head_motion"], []),
    "plot.error_map": (["truth"], []),
    "plot.faces": (["truth"], []),
    "plot.playback": (["truth"], []),
    "plot.spectra": (["truth"], []),
    "plot.trajectories": (["truth"], []),
    "points.scatter": (["truth"], ["truth"]),
    "read.truth": ([], ["output"]),
    "score.alignment": (["head_motion"], []),
    "score.calibration": (["truth"], []),
    "score.distance": (["reference"], []),
    "score.gaps": (["truth"], []),
    "score.head_motion": (["truth"], []),
    "score.impulses": (["truth", "impulses"], []),
    "score.realism": (["recordings"], []),
    "score.smoothness": (["truth"], []),
    "score.steps": (["truth"], []),
    "score.tracking": (["truth"], []),
    "score.unselected": (["reference"], []),
    "score.weights_mse": (["reference"], []),
    "synthesize.face": ([], ["truth", "weights", "head_motion", "impulses"]),
    "write.rrd": (["truth"], []),
}
"""The ports that take and give the answer, of the nodes that have such."""

INSTALLED = default_registry()
BY_NAME = ("sklearn:sklearn.impute.KNNImputer",)
"""Nodes that no plugin lists."""


def required(node: Node) -> Mapping[str, object]:
    return REQUIRED[node.name]() if node.name in REQUIRED else {}


def cases() -> Iterator[object]:
    # from the last, because the studies that run beside begin with the first: both would compile
    # the same kernels at the same time
    for registered in sorted(INSTALLED, key=lambda each: each.full_name, reverse=True):
        for label, choice in variants(registered.node):
            if choice == TUNED and registered.node.name != "fill.muscle":
                continue
            settings = {**SMALL.get(registered.node.name, {}), **choice} if choice else {}
            full_name = registered.full_name
            yield pytest.param(full_name, settings, id=f"{full_name}{label}")


def begin() -> None:
    warnings.simplefilter("error")
    gc.set_threshold(20_000, 20, 20)  # to look for garbage as often as Python does takes a tenth


@pytest.fixture(scope="module")
def process() -> Iterator[ProcessPoolExecutor]:
    """A process that checks nodes: where their kernels are compiled, it takes half a gigabyte."""
    with ProcessPoolExecutor(1, get_context("spawn"), initializer=begin) as pool:
        yield pool


def check(name: str, settings: Mapping[str, object]) -> None:
    node = INSTALLED.find(name).node
    check_node(node.function, settings={**required(node), **settings})


def test_every_plugin_is_installed_and_imports() -> None:
    assert not INSTALLED.broken
    assert list(INSTALLED)


@pytest.mark.parametrize(("name", "settings"), list(cases()))
def test_node_keeps_its_promises(
    process: ProcessPoolExecutor, name: str, settings: Mapping[str, object]
) -> None:
    process.submit(check, name, settings).result()


def test_what_takes_and_gives_the_answer_is_marked() -> None:
    marked = {}
    for node in (registered.node for registered in INSTALLED):
        ports = [[port.name for port in side if port.truth] for side in (node.inputs, node.outputs)]
        if any(ports):
            marked[node.name] = tuple(ports)
    assert marked == TAKES_AND_GIVES_ANSWERS


@pytest.mark.parametrize("plugin", INSTALLED.loaded, ids=lambda plugin: plugin.name)
def test_a_plugin_ships_what_its_nodes_cite_and_nothing_else(plugin: Plugin) -> None:
    nodes = [registered for registered in INSTALLED if registered.plugin == plugin.name]
    nodes += [INSTALLED.find(name) for name in BY_NAME if name.startswith(f"{plugin.name}:")]
    hook: Callable[[], str] = getattr(plugin.module, "nodegraph_bibtex", str)
    assert set(entry_keys([hook()])) == {key for node in nodes for key in node.node.cite}


@pytest.mark.parametrize("family", ["align", "despike", "smooth"])
def test_every_method_says_how_far_it_looks_ahead(family: str) -> None:
    nodes = [node.node for node in INSTALLED.family(family).values()]
    assert nodes
    assert not [node.name for node in nodes if not re.search("Looks (ahead|at)", node.doc)]


def test_every_contract_states_what_it_promises_and_has_a_family() -> None:
    for plugin in INSTALLED.loaded:
        hook: Callable[[], Any] = getattr(plugin.module, "nodegraph_contracts", dict)
        for family, contracts in hook().items():
            assert family in INSTALLED.families
            assert all((contract.__doc__ or "").strip() for contract in contracts)
