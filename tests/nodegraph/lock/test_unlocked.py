"""A lock that cannot be run here says what is missing, or of another version."""

from __future__ import annotations

from dataclasses import replace
from types import ModuleType

import pytest

from nodegraph import NodegraphError
from nodegraph.execute import Run
from nodegraph.lock.lockfile import Lock
from nodegraph.lock.restore import unlocked
from nodegraph.plugin.loading import BrokenPlugin, Plugin
from nodegraph.plugin.registry import Registry

Frozen = tuple[Run, Lock]


def locked_with(lock: Lock, distribution: str) -> Lock:
    """Return a lock whose methods came from a distribution."""
    methods = {group: {**one, "from": distribution} for group, one in lock.data["methods"].items()}
    return replace(lock, data={**lock.data, "methods": methods})


def installed(toys: Registry, version: str) -> Registry:
    toys.loaded.append(Plugin("toys", ModuleType("toys"), f"toy-nodes {version}"))
    return toys


def test_a_lock_is_its_graph_again(frozen: Frozen, toys: Registry) -> None:
    run, lock = frozen
    graph = unlocked(lock, toys, {})
    assert {name: axis.labels for name, axis in graph.axes.items()} == {
        "length": (3, 7),
        "fill": ("hold", "scale"),
    }
    assert graph.inputs == run.plan.graph.inputs
    assert unlocked(lock, toys, {"start": 4}).inputs == {"start": 4}


def test_a_plugin_that_is_too_old_is_named_with_the_node_that_it_lacks(
    frozen: Frozen, toys: Registry
) -> None:
    _, lock = frozen
    lock = locked_with(lock, "toy-nodes 2.0")
    old = installed(toys.without(lambda one: one.node.name == "fill.scale"), "1.0")
    said = (
        "plugin toys is toy-nodes 1.0 here and was toy-nodes 2.0, and has no such node: fill.scale"
    )
    with pytest.raises(NodegraphError, match=said):
        unlocked(lock, old, {})


def test_a_plugin_of_another_version_is_named_where_its_nodes_do_not_fit(
    frozen: Frozen, toys: Registry
) -> None:
    _, lock = frozen
    (name, text), *_ = lock.data["text"].items()
    newer = text.replace("{length: $length}", "{length: $length, depth: 4}")
    lock = replace(lock, data={**locked_with(lock, "toy-nodes 2.0").data, "text": {name: newer}})
    with pytest.raises(
        NodegraphError, match=r"(?s)has no setting 'depth'.*toy-nodes 1.0 here and was"
    ):
        unlocked(lock, installed(toys, "1.0"), {})


@pytest.mark.parametrize(
    ("broken", "said"),
    [
        ([], "plugin toys is absent; install toy-nodes 2.0"),
        ([BrokenPlugin("toys", "no module x")], r"plugin toys is left out \(no module x\)"),
    ],
)
def test_a_plugin_that_is_absent_is_named_with_what_installs_it(
    frozen: Frozen, broken: list[BrokenPlugin], said: str
) -> None:
    _, lock = frozen
    with pytest.raises(NodegraphError, match=said):
        unlocked(locked_with(lock, "toy-nodes 2.0"), Registry(broken=broken), {})
