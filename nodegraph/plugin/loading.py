"""Import plugins: those that are installed, by their entry points, and files that a user names."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
import time
from collections.abc import Container, Iterable
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.machinery import SourceFileLoader
from importlib.metadata import Distribution, PackageNotFoundError, distribution, entry_points
from pathlib import Path
from traceback import walk_tb
from typing import Any

from nodegraph.errors import NodegraphError, message_of, nearest
from nodegraph.import_time import LOADED
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin import hooks

_MOST_BYTES = 10_000_000  # of a plugin file


@dataclass(frozen=True)
class Plugin:
    """One plugin that was imported.

    Attributes
    ----------
    name : str
        The entry point's name, or the file's name without its suffix.
    module : Any
        The module that implements the hooks.
    distribution : str
        Name and version of the package that installed it; empty for a file.
    digest : str
        SHA-256 of the file when it was imported; empty for a package.
    """

    name: str
    module: Any
    distribution: str = ""
    digest: str = ""

    def has(self, hook: str) -> bool:
        """Return whether it implements a hook."""
        return hasattr(self.module, f"{hooks.GROUP}_{hook}")


@dataclass(frozen=True)
class BrokenPlugin:
    """A plugin that cannot be used, and why; the others continue without it."""

    name: str
    reason: str


class NodesHookError(NodegraphError):
    """The hook that returns a plugin's nodes has failed.

    Attributes
    ----------
    reason : str
        The error that it raised.
    line : int
        The last line of the plugin's own code that was reached; 0 if none was.
    """

    def __init__(self, error: BaseException, package: str) -> None:
        self.reason = f"nodegraph_nodes raised {error_text(error)}"
        file, self.line = _last_line(error, package)
        super().__init__(f"{self.reason} ({file}:{self.line})" if file else self.reason)


@cache
def built_in() -> Plugin:
    """Return the plugin of this package itself, whose entry point has a group of its own.

    Raises
    ------
    NodegraphError
        If this package is not installed, or was before it had this entry point.
    """
    with suppress(PackageNotFoundError):
        for entry in distribution(hooks.GROUP).entry_points.select(group=hooks.BUILT_IN):
            return Plugin(hooks.GROUP, entry.load())
    raise NodegraphError("nodegraph is not installed as it is here: pip install it again")


def installed() -> tuple[list[Plugin], list[BrokenPlugin]]:
    """Import every installed plugin, and collect those that fail."""
    plugins: list[Plugin] = []
    broken: list[BrokenPlugin] = []
    for entry in sorted(entry_points(group=hooks.GROUP), key=lambda entry: entry.name):
        try:
            module = entry.load()
            plugins.append(Plugin(entry.name, module, _name_and_version(entry.dist)))
        except (Exception, SystemExit) as error:
            reason = f"{entry.value}: {error_text(error, _top_package(entry.module))}"
            broken.append(BrokenPlugin(entry.name, reason))
    return plugins, broken


def from_file(path: Path, *, known: Container[Node] = ()) -> Plugin:
    """Import one Python file as a plugin.

    Parameters
    ----------
    path
    known
        Nodes of other plugins, which the file may import to call them: they are not its own.

    Raises
    ------
    NodegraphError
        If the file does not exist or does not import.
    """
    if not path.is_file():
        if path.exists():
            raise NodegraphError(f"{path}: not a regular file")
        hint = nearest(path.name, [file.name for file in sorted(path.parent.glob("*.py"))])
        raise NodegraphError(f"{path}: no such plugin file; {hint}")
    if path.stat().st_size > _MOST_BYTES:
        raise NodegraphError(f"{path}: too large to be a plugin file")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or not isinstance(spec.loader, SourceFileLoader):
        raise NodegraphError(f"{path}: a plugin file is Python, with the suffix .py")
    module = importlib.util.module_from_spec(spec)
    vars(module)[LOADED] = time.time_ns()
    previous = sys.modules.get(path.stem)
    if previous is None or LOADED in vars(previous):
        sys.modules[path.stem] = module  # where classes of its values are looked up by name
    try:
        # the bytes of the digest, and no bytecode of an edit less than a second before
        source = path.read_bytes()
        exec(spec.loader.source_to_code(source, str(path)), vars(module))
    except (Exception, SystemExit) as error:
        if sys.modules.get(path.stem) is module:
            del sys.modules[path.stem]
            sys.modules.update({path.stem: previous} if previous else {})
        reason = error_text(error, path.stem)
        raise NodegraphError(f"{path}: the plugin does not import: {reason}") from error
    if not hasattr(module, "nodegraph_nodes"):
        _add_nodes_hook(module, known)
    return Plugin(path.stem, module, digest=hashlib.sha256(source).hexdigest())


def nodes_of(plugin: Plugin) -> tuple[Any, ...]:
    """Return what a plugin's hook ``nodegraph_nodes`` lists.

    Raises
    ------
    NodesHookError
        If the hook raises.
    NodegraphError
        If the hook returns no list.
    """
    hook: Any = getattr(plugin.module, "nodegraph_nodes", tuple)
    try:
        nodes = hook()
        if isinstance(nodes, Iterable):
            return tuple(nodes)
    except (Exception, SystemExit) as error:
        raise NodesHookError(error, package_of(hook)) from error
    kind = type(nodes).__name__
    raise NodegraphError(f"its hook nodegraph_nodes returned {kind}: return [node, ...]")


def error_text(error: BaseException, package: str = "") -> str:
    """Return the message of an error, with its type unless the message is written for users.

    With the package of a plugin, also the last line of that package's code that was reached.
    """
    message = message_of(error)
    text = message if isinstance(error, NodegraphError) else f"{type(error).__name__}: {message}"
    file, line = _last_line(error, package) if package else ("", 0)
    return f"{text} ({file}:{line})" if file else text


def package_of(function: object) -> str:
    """Return the top-level package of a function's code."""
    return _top_package(getattr(function, "__module__", ""))


def _add_nodes_hook(module: Any, known: Container[Node]) -> None:
    """Let a file that only decorates functions return them as its nodes."""
    nodes = ((value, node_of(value)) for value in vars(module).values())
    own = tuple(value for value, node in nodes if node is not None and node not in known)

    @hooks.hookimpl
    def nodegraph_nodes() -> tuple[object, ...]:
        return own

    module.nodegraph_nodes = nodegraph_nodes


@cache  # most plugins are of one distribution, whose metadata is parsed at each look
def _name_and_version(distribution: Distribution | None) -> str:
    return f"{distribution.name} {distribution.version}" if distribution else ""


def _last_line(error: BaseException, package: str) -> tuple[str, int]:
    """Return file and line of the last frame in a package's own code, not in what it calls."""
    place = ("", 0)
    for frame, line in walk_tb(error.__traceback__):
        if _top_package(frame.f_globals.get("__name__", "")) == package:
            place = (Path(frame.f_code.co_filename).name, line)
    return place


def _top_package(module: str) -> str:
    return module.partition(".")[0]
