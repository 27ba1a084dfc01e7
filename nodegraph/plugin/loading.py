"""Finding plugins: by entry point, or from a file that the user named."""

from __future__ import annotations

import hashlib
import importlib.util
import sys
import time
from collections.abc import Container, Iterable
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from traceback import walk_tb
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.import_time import LOADED
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin import hooks


@dataclass(frozen=True)
class Plugin:
    """One plugin that was imported.

    Attributes
    ----------
    name : str
        The entry point's name, or the file's name without its suffix.
    module : Any
        What implements the hooks.
    distribution : str
        Name and version of the package that installed it; empty for a file.
    digest : str
        SHA-256 of the file, as it was when it was imported; empty for a package.
    """

    name: str
    module: Any
    distribution: str = ""
    digest: str = ""


@dataclass(frozen=True)
class BrokenPlugin:
    """A plugin that could not be used, and why; the others go on without it."""

    name: str
    reason: str


class HookError(NodegraphError):
    """The hook that gives a plugin's nodes raised something.

    Attributes
    ----------
    said : str
        What it raised.
    line : int
        Of the plugin's own code, the last that was reached; 0 if none was.
    """

    def __init__(self, error: BaseException, package: str) -> None:
        self.said = f"nodegraph_nodes raised {said_by(error)}"
        file, self.line = _place(error, package)
        super().__init__(f"{self.said} ({file}:{self.line})" if file else self.said)


def installed() -> tuple[list[Plugin], list[BrokenPlugin]]:
    """Import every installed plugin, each by itself, so that a bad one can be named."""
    good: list[Plugin] = []
    broken: list[BrokenPlugin] = []
    for entry in sorted(entry_points(group=hooks.GROUP), key=lambda one: one.name):
        try:
            good.append(Plugin(entry.name, entry.load(), _distribution(entry)))
        except (Exception, SystemExit) as error:
            reason = f"{entry.value}: {reason_of(error, _package(entry.module))}"
            broken.append(BrokenPlugin(entry.name, reason))
    return good, broken


def from_file(path: Path, *, but: Container[Node] = ()) -> Plugin:
    """Import one Python file as a plugin.

    Parameters
    ----------
    path
    but
        Nodes of other plugins, which the file may import to call them: they are not its own.

    Raises
    ------
    NodegraphError
        If the file is not there or does not import.
    """
    if not path.is_file():
        raise NodegraphError(f"{path}: no such plugin file")
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise NodegraphError(f"{path}: a plugin file is Python, with the suffix .py")
    module = importlib.util.module_from_spec(spec)
    vars(module)[LOADED] = time.time_ns()
    before = sys.modules.get(path.stem)
    if before is None or LOADED in vars(before):
        sys.modules[path.stem] = module  # classes of its values are found there by name
    try:
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        if sys.modules.get(path.stem) is module:
            del sys.modules[path.stem]
            sys.modules.update({path.stem: before} if before else {})
        reason = reason_of(error, path.stem)
        raise NodegraphError(f"{path}: the plugin does not import: {reason}") from error
    return Plugin(path.stem, _with_nodes(module, but), digest=digest)


def nodes_of(plugin: Plugin) -> tuple[Any, ...]:
    """Return the functions that a plugin gives as its nodes.

    Parameters
    ----------
    plugin
        One that was imported.

    Raises
    ------
    HookError
        If its hook raises.
    NodegraphError
        If its hook returns no list.
    """
    hook: Any = getattr(plugin.module, "nodegraph_nodes", tuple)
    try:
        found = hook()
        if isinstance(found, Iterable):
            return tuple(found)
    except (Exception, SystemExit) as error:
        raise HookError(error, package_of(hook)) from error
    kind = type(found).__name__
    raise NodegraphError(f"its hook nodegraph_nodes returned {kind}: return [node, ...]")


def said_by(error: BaseException) -> str:
    """Return what an error says; its kind too, if it is not written for users.

    Parameters
    ----------
    error
        Anything that was raised.
    """
    own = isinstance(error, NodegraphError)
    return str(error) if own else f"{type(error).__name__}: {error}"


def _with_nodes(module: Any, but: Container[Node]) -> Any:
    """Let a file that only decorates functions give them as its nodes."""
    if hasattr(module, "nodegraph_nodes"):
        return module
    nodes = ((one, node_of(one)) for one in vars(module).values())
    found = tuple(one for one, node in nodes if node is not None and node not in but)

    @hooks.hookimpl
    def nodegraph_nodes() -> tuple[Any, ...]:
        return found

    module.nodegraph_nodes = nodegraph_nodes
    return module


def _distribution(entry: EntryPoint) -> str:
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else ""


def reason_of(error: BaseException, package: str) -> str:
    """Return what an error of a plugin says, and where in the plugin's own code it arose.

    Parameters
    ----------
    error
        What was raised.
    package
        Whose code is the plugin's own.
    """
    file, line = _place(error, package)
    return said_by(error) + (f" ({file}:{line})" if file else "")


def _place(error: BaseException, package: str) -> tuple[str, int]:
    """Return file and line of the last step in the plugin's own code, not in what it calls."""
    place = ("", 0)
    for frame, line in walk_tb(error.__traceback__):
        if _package(frame.f_globals.get("__name__", "")) == package:
            place = (Path(frame.f_code.co_filename).name, line)
    return place


def package_of(hook: Any) -> str:
    """Return the package whose code a hook is.

    Parameters
    ----------
    hook
        A function.
    """
    return _package(getattr(hook, "__module__", ""))


def _package(module: str) -> str:
    return module.partition(".")[0]
