"""What is wrong with a plugin's hooks is told as such, and never raised raw by a node's test."""

from __future__ import annotations

from typing import Any

import pytest

import nodegraph_mocap
from nodegraph import Kind, hookimpl, node
from nodegraph.plugin.loading import Plugin
from nodegraph.plugin.registry import Registry
from nodegraph.testing import check_node
from nodegraph_mocap import Trajectories


@node("hold.on", cite="mine2026")
def cites(recording: Trajectories) -> Trajectories:
    """Hold on."""
    return recording


@node("hold.still")
def holds(recording: Trajectories) -> Trajectories:
    """Hold still."""
    return recording


def registry_with(hook: str, function: Any, *nodes: Any) -> Registry:
    """Return a registry with a plugin that has one hook, beside the one that ships specimens."""
    module = type("bad_module", (), {hook: staticmethod(hookimpl(function))})
    registry = Registry.of(nodes, plugin="bad")
    registry.loaded.extend([Plugin("mocap", nodegraph_mocap), Plugin("bad", module)])
    return registry


def faults_of(function: Any, registry: Registry) -> str:
    with pytest.raises(AssertionError) as caught:
        check_node(function, registry=registry)
    return str(caught.value)


def raising() -> object:
    raise RuntimeError("out of ink")


@pytest.mark.parametrize(
    ("hook", "message"),
    [
        (raising, "RuntimeError: out of ink (test_check_hooks.py:"),
        (lambda: None, "TypeError: expected str, got NoneType"),
        (lambda: ["@misc{mine2026}"], "TypeError: expected str, got list"),
    ],
)
def test_a_bibtex_hook_that_fails_is_a_fault(hook: object, message: str) -> None:
    text = faults_of(cites, registry_with("nodegraph_bibtex", hook, cites))
    assert f"- its plugin's hook nodegraph_bibtex failed: {message}" in text
    assert "fix it, or nobody learns what the node cites" in text


def test_a_contract_that_fails_is_named_with_its_plugin_and_line() -> None:
    def stays(tried: object) -> object:
        """Stay."""
        raise RuntimeError("out of ink")

    text = faults_of(holds, registry_with("nodegraph_contracts", lambda: {"hold": [stays]}, holds))
    assert "breaks what every hold.* node promises: Stay" in text
    message = "plugin 'bad': stays, from hook nodegraph_contracts, failed: RuntimeError: out of ink"
    assert f"{message} (test_check_hooks.py:" in text


@pytest.mark.parametrize(
    ("contracts", "message"),
    [
        ({"hold": 5}, "'hold' of nodegraph_contracts is left out: expected Iterable, got int"),
        ({"hold": [5]}, "item 0 of nodegraph_contracts is left out: expected Callable, got int"),
        ({5: []}, "5 of nodegraph_contracts is left out: expected str, got int"),
    ],
)
def test_contracts_of_another_type_are_left_out(contracts: object, message: str) -> None:
    with pytest.warns(UserWarning, match=f"^plugin 'bad': {message}$"):
        check_node(holds, registry=registry_with("nodegraph_contracts", lambda: contracts, holds))


@pytest.mark.parametrize(
    ("kinds", "message"),
    [
        ([Trajectories], "item 0 of nodegraph_kinds is left out: expected Kind, got type"),
        (
            [Kind(Trajectories, specimens=raising)],  # type: ignore[arg-type]
            "the specimens of Trajectories, from hook nodegraph_kinds, failed: "
            r"RuntimeError: out of ink \(test_check_hooks.py:\d+\); it is left out",
        ),
        (
            [Kind(Trajectories, specimens=list)],  # type: ignore[arg-type]
            ".* failed: TypeError: expected Mapping, got list; it is left out",
        ),
    ],
)
def test_specimens_that_cannot_be_made_are_left_out(kinds: object, message: str) -> None:
    with pytest.warns(UserWarning, match=f"^plugin 'bad': {message}"):
        check_node(holds, registry=registry_with("nodegraph_kinds", lambda: kinds, holds))


def test_a_node_that_returns_its_input_declines_nothing() -> None:
    check_node(holds, registry=registry_with("nodegraph_bibtex", lambda: "", holds))
