"""The graph that a command names, with what its options choose."""

from __future__ import annotations

import re
import shlex
import sys
from argparse import Namespace
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.errors import GraphError, NodegraphError
from nodegraph.graph import Choices, Graph, build
from nodegraph.ports import Label
from nodegraph.registry import Registry
from nodegraph.spec import read_graph_file
from nodegraph.spec.yaml_text import read_yaml

if TYPE_CHECKING:
    from nodegraph.store import Store

_FORMS = {
    "set": "INPUT=VALUE",
    "axis": "AXIS=LABELS",
    "only": "AXIS=LABELS",
    "at": "AXIS=LABEL",
}
"""How options are written, as their help says."""


def graph_of(arguments: Namespace) -> Graph:
    """Return the checked graph that the command names, with what its options choose."""
    _refuse_lock(arguments.graph)
    registry = Registry.installed(arguments.plugin)
    choices = Choices(
        inputs=set_values(arguments),
        axes={name: _labels(f"--axis {name}", text) for name, text in _pairs(arguments, "axis")},
        only={name: _kept(f"--only {name}", text) for name, text in _pairs(arguments, "only")},
    )
    graph = build(read_graph_file(arguments.graph), registry, choices)
    for one in graph.notices:
        say(str(one))
    return graph


def set_values(arguments: Namespace) -> dict[str, Any]:
    """Return the inputs' values that the command gives."""
    return {name: _value(f"--set {name}", text) for name, text in _pairs(arguments, "set")}


def run_folder(arguments: Namespace) -> Path:
    """Return where runs of the graph lie unless the command says otherwise."""
    return Path("runs") / str(arguments.graph.stem)


def say(text: str) -> None:
    """Tell the user something that is no result."""
    print(text, file=sys.stderr)


def store_of(arguments: Namespace, graph: Graph, hears: Callable[[str], None] = say) -> Store:
    """Return the store that the command uses; whoever hears is told what is wrong with it."""
    from nodegraph.execute import open_store

    return open_store(graph.registry, arguments.store, hears)


def command_of(arguments: Namespace) -> str:
    """Return the command that runs the same again, quoted for a shell."""
    words = ["nodegraph", "run", str(arguments.graph)]
    for option in ("set", "axis", "only", "plugin"):
        for one in getattr(arguments, option):
            words += [f"--{option}", str(one)]
    words += ["--store", str(arguments.store)] if arguments.store else []
    # what ends its process, or fails on the way to another, does so only where it ran
    if arguments.executor != "threads":
        words += ["--executor", arguments.executor]
    words += ["--scheduler", arguments.scheduler] if arguments.scheduler else []
    return shlex.join(words)


def labels_of(option: str, words: Iterable[str]) -> dict[str, str]:
    """Return the label of each axis: from ``fill=muscle``, or from several joined by commas."""
    single = (one for word in words for one in re.split(r",(?=[^,=]+=)", word))
    return dict(_split(option, single))


def _refuse_lock(path: Path) -> None:
    if path.suffix in (".yaml", ".yml") or not path.is_file():
        return
    from nodegraph.paper.frozen.lock import is_lock

    if is_lock(path):
        raise NodegraphError(f"{path}: this is a lock; use `nodegraph verify {path}`")


def _pairs(arguments: Namespace, option: str) -> list[tuple[str, str]]:
    return _split(option, getattr(arguments, option))


def _split(option: str, words: Iterable[str]) -> list[tuple[str, str]]:
    pairs: list[tuple[str, str]] = []
    for word in words:
        name, equals, text = word.partition("=")
        if not equals or not name:
            raise NodegraphError(f"--{option} {word}: write --{option} {_FORMS[option]}")
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
