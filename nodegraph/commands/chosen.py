"""The graph that a command names, with what its options choose."""

from __future__ import annotations

import shlex
from argparse import Namespace
from typing import Any

from nodegraph.errors import GraphError, NodegraphError
from nodegraph.graph import Choices, Graph, build
from nodegraph.ports import Label
from nodegraph.registry import Registry
from nodegraph.spec import read_graph_file
from nodegraph.spec.yaml_text import read_yaml


def graph_of(arguments: Namespace) -> Graph:
    """Return the checked graph that the command names, with what its options choose."""
    registry = Registry.installed(arguments.plugin)
    choices = Choices(
        inputs={name: _value(f"--set {name}", text) for name, text in _pairs(arguments, "set")},
        axes={name: _labels(f"--axis {name}", text) for name, text in _pairs(arguments, "axis")},
        only={name: _kept(f"--only {name}", text) for name, text in _pairs(arguments, "only")},
    )
    return build(read_graph_file(arguments.graph), registry, choices)


def command_of(arguments: Namespace) -> str:
    """Return the command that runs the same again, quoted for a shell."""
    words = ["nodegraph", "run", str(arguments.graph)]
    for option in ("set", "axis", "only", "plugin"):
        for one in getattr(arguments, option):
            words += [f"--{option}", str(one)]
    return shlex.join(words)


def _pairs(arguments: Namespace, option: str) -> list[tuple[str, str]]:
    pairs: list[tuple[str, str]] = []
    for word in getattr(arguments, option):
        name, equals, text = word.partition("=")
        if not equals or not name:
            raise NodegraphError(f"--{option} {word}: write --{option} NAME=VALUE")
        if name in dict(pairs):
            raise NodegraphError(f"--{option} {name} is given twice")
        pairs.append((name, text))
    return pairs


def _value(option: str, text: str) -> Any:
    try:
        return read_yaml(text, option).plain()
    except GraphError:
        return text  # a path may hold what YAML would read as its own marks


def _labels(option: str, text: str) -> Any:
    return read_yaml(text if text.startswith(("[", "{")) else f"[{text}]", option).plain()


def _kept(option: str, text: str) -> tuple[Label, ...]:
    found = _labels(option, text)
    return tuple(found)
