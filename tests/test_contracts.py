"""Every installed node keeps its promises, a stranger's as well as ours."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache
from typing import Any

import pytest

from nodegraph.bibliography import references
from nodegraph.registry import Registered, Registry, default_registry
from nodegraph.testing import check_node
from nodegraph_mocap import sample_folder

NEEDS: Mapping[str, Any] = {"read.recording": lambda: {"path": sample_folder("face")}}
"""Values for settings that have no default."""


@cache
def installed() -> Registry:
    return default_registry()


def names() -> list[str]:
    return sorted(one.full_name for one in installed())


def found(name: str) -> Registered:
    return installed().find(name)


def test_every_plugin_is_installed_and_imports() -> None:
    assert not installed().broken
    assert names()


@pytest.mark.parametrize("name", names())
def test_node_keeps_its_promises(name: str) -> None:
    node = found(name).node
    needs = NEEDS.get(node.name, dict)
    check_node(node.function, settings=needs())


@pytest.mark.parametrize("name", names())
def test_node_cites_what_its_plugin_ships(name: str) -> None:
    told = references(installed().bibtex, found(name).node.cite)
    absent = [key for key, text in told.items() if text.startswith(f"{key} (")]
    assert not absent, f"no plugin ships a BibTeX entry {', '.join(absent)}"


def test_every_contract_says_what_it_promises() -> None:
    for promised in installed().hooks.hook.nodegraph_contracts():
        for family, contracts in promised.items():
            assert family in installed().families
            assert all((one.__doc__ or "").strip() for one in contracts)
