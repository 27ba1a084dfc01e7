"""Graphs of locks, built from what is installed."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import pytest

from nodegraph import NodegraphError
from nodegraph.execute.results import Run
from nodegraph.execute.resume import StoredSteps
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.restore import StoreWithoutResults, unlocked
from nodegraph.plugin.loading import BrokenPlugin, Plugin
from nodegraph.plugin.registry import Registry
from tests.nodegraph.lock.conftest import Frozen


def locked_with(lock: Lock, distribution: str) -> Lock:
    """Return a lock whose methods came from a distribution."""
    nodes = {
        name: replace(
            node,
            methods={
                label: replace(method, distribution=distribution)
                for label, method in node.methods.items()
            },
        )
        for name, node in lock.record.nodes.items()
    }
    return replace(lock, record=replace(lock.record, nodes=nodes))


def installed(toys: Registry, version: str) -> Registry:
    toys.loaded.append(Plugin("toys", ModuleType("toys"), f"toy-nodes {version}"))
    return toys


def test_the_graph_of_a_lock_is_the_locked_one(frozen: Frozen, toys: Registry) -> None:
    run, lock, path = frozen
    graph = unlocked(lock, path, toys, {})
    assert {name: axis.labels for name, axis in graph.axes.items()} == {
        "length": (3, 7),
        "fill": ("hold", "scale"),
    }
    assert graph.inputs == run.plan.graph.inputs
    assert unlocked(lock, path, toys, {"start": 4}).inputs == {"start": 4}


def test_an_old_plugin_is_reported_with_the_missing_node(frozen: Frozen, toys: Registry) -> None:
    _, lock, path = frozen
    lock = locked_with(lock, "toy-nodes 2.0")
    old = installed(toys.without(lambda node: node.node.name == "fill.scale"), "1.0")
    with pytest.raises(
        NodegraphError, match=r"toys .*toy-nodes 1\.0 .*toy-nodes 2\.0.*: fill\.scale"
    ):
        unlocked(lock, path, old, {})


def test_a_plugin_of_another_version_is_reported_if_the_graph_is_not_valid(
    frozen: Frozen, toys: Registry
) -> None:
    _, lock, path = frozen
    (name, text), *_ = lock.text.items()
    newer = text.replace("{length: $length}", "{length: $length, depth: 4}")
    lock = replace(locked_with(lock, "toy-nodes 2.0"), text={name: newer})
    with pytest.raises(NodegraphError, match=r"(?s)'depth'.*toy-nodes 1\.0"):
        unlocked(lock, path, installed(toys, "1.0"), {})


@pytest.mark.parametrize(
    ("broken", "reason"),
    [
        ([], "plugin toys .*install toy-nodes 2.0"),
        ([BrokenPlugin("toys", "no module x")], r"plugin toys .*no module x"),
    ],
)
def test_a_missing_plugin_is_reported_with_what_to_install(
    frozen: Frozen, broken: list[BrokenPlugin], reason: str
) -> None:
    _, lock, path = frozen
    with pytest.raises(NodegraphError, match=reason):
        unlocked(locked_with(lock, "toy-nodes 2.0"), path, Registry(broken=broken), {})


def test_a_store_without_results_has_the_audits(run_of: Callable[..., Run], tmp_path: Path) -> None:
    run = run_of(
        "nodes: {a: {use: read.number}, b: {use: fill.hold, in: a}}", store=tmp_path / "store"
    )
    assert run.cache is not None
    empty = StoredSteps(
        run.plan, StoreWithoutResults(tmp_path / "empty", run.cache.store, pytest.fail)
    )
    assert empty.known == {}
    run.cache.distrust(run.plan.steps[0], "a second call")
    later = StoredSteps(
        run.plan, StoreWithoutResults(tmp_path / "later", run.cache.store, pytest.fail)
    )
    assert "in a second call" in later.distrusted(run.plan.steps[0])
