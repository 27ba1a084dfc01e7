"""The graph that a command names, with what its options choose."""

from __future__ import annotations

import os
import re
import shlex
import sys
import tempfile
from argparse import Namespace
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.cli.progress import progress
from nodegraph.errors import GraphError, NodegraphError
from nodegraph.formatting import size_text
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_file
from nodegraph.graphfile.yaml_text import read_yaml
from nodegraph.node.ports import Label
from nodegraph.plugin.registry import Registry

if TYPE_CHECKING:
    from nodegraph.execute import Run
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
    from nodegraph.lock.lockfile import is_lock

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


def written(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, with the folders that it needs.

    Raises
    ------
    NodegraphError
        If it cannot be written there.
    """
    unfinished = path.with_name(f"{path.name}.part")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        unfinished.write_bytes(content)
        unfinished.replace(path)
    except OSError as error:
        raise _unwritable(path, error) from error
    finally:
        with suppress(OSError):
            unfinished.unlink(missing_ok=True)


def written_and_told(path: Path, content: bytes) -> None:
    """Write a file whole or not at all, and print where it is and how large."""
    written(path, content)
    print(f"{path} ({size_text(len(content))})")


def refuse_unwritable(path: Path) -> None:
    """Refuse a place where no file can be written, before long work is done for it.

    Nothing is left there, neither a file nor a folder.

    Raises
    ------
    NodegraphError
        If it cannot be written there.
    """
    try:
        if path.is_dir():
            raise IsADirectoryError
        with tempfile.TemporaryFile(dir=next(one for one in path.parents if one.exists())):
            pass
    except OSError as error:
        raise _unwritable(path, error) from error


def _unwritable(path: Path, error: OSError) -> NodegraphError:
    # paths of which nothing can be asked, such as too long ones, are neither
    in_the_way = [one for one in path.parents if os.path.isfile(one)]
    if in_the_way:
        reason = f"{in_the_way[0]} is a file, and no folder"
    elif os.path.isdir(path):
        reason = "it is a folder; name a file"
    else:
        reason = error.strerror or str(error)
    return NodegraphError(f"{path}: cannot be written: {reason}; name another place with --out")


def left_out_lines(graph: Graph) -> list[str]:
    """Return which nodes are left out: ``left out: faces, playback: why``."""
    return [
        f"left out: {', '.join(nodes)}: {reason}"
        for reason, nodes in graph.left_out_together().items()
    ]


def completed(arguments: Namespace, graph: Graph, store: Store) -> Run:
    """Run a graph as the command says, and show how far it is."""
    from nodegraph.api import reported
    from nodegraph.execute import HowToRun, execute
    from nodegraph.plan import plan

    how = HowToRun(arguments.executor, arguments.jobs, arguments.scheduler)
    for line in left_out_lines(graph):
        say(line)
    with progress() as shown:
        return execute(
            plan(graph), how=how, store=store, keep=reported(graph), listeners=[shown.hear]
        )


MOST = 12
"""Things of a kind that are told one by one."""


def counted(counts: Counter[str]) -> str:
    """Return how many combinations of each node there are: ``fill (4), total (1)``."""
    return ", ".join(f"{node} ({count})" for node, count in counts.items() if count)


def first_and_more(first: str, count: int, whole: str) -> str:
    """Return the name of the first of some, and how many more of a whole there are."""
    return f"{first} and {count - 1} more of {whole}" if count > 1 else first


def few(lines: Sequence[str], what: str = "") -> Iterator[str]:
    """Yield the first lines, and how many more there are of what."""
    yield from lines[:MOST]
    if len(lines) > MOST:
        yield f"and {len(lines) - MOST} more{f' {what}' if what else ''}"
