"""Finding plugins: by entry point, or from a file that the user named."""

from __future__ import annotations

import importlib.util
import sys
import time
from dataclasses import dataclass
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any

import pluggy

from nodegraph import hooks
from nodegraph.errors import NodegraphError
from nodegraph.node import node_of
from nodegraph.started import LOADED


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
    """

    name: str
    module: Any
    distribution: str = ""


@dataclass(frozen=True)
class BrokenPlugin:
    """A plugin that could not be used, and why; the others go on without it."""

    name: str
    reason: str


def installed() -> tuple[list[Plugin], list[BrokenPlugin]]:
    """Import every installed plugin, each by itself, so that a bad one can be named."""
    good: list[Plugin] = []
    broken: list[BrokenPlugin] = []
    for entry in sorted(entry_points(group=hooks.GROUP), key=lambda one: one.name):
        try:
            good.append(Plugin(entry.name, entry.load(), _distribution(entry)))
        except (Exception, SystemExit) as error:
            broken.append(BrokenPlugin(entry.name, _reason(error, entry.value)))
    return good, broken


def from_file(path: Path) -> Plugin:
    """Import one Python file as a plugin.

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
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        if sys.modules.get(path.stem) is module:
            del sys.modules[path.stem]
            sys.modules.update({path.stem: before} if before else {})
        raise NodegraphError(f"{path}: the plugin does not import: {_reason(error)}") from error
    return Plugin(path.stem, _with_nodes(module))


def manager(plugins: list[Plugin]) -> pluggy.PluginManager:
    """Return a pluggy manager in which the plugins are registered."""
    made = pluggy.PluginManager(hooks.GROUP)
    made.add_hookspecs(hooks)
    for plugin in plugins:
        made.register(plugin.module, plugin.name)
    return made


def _with_nodes(module: Any) -> Any:
    """Let a file that only decorates functions give them as its nodes."""
    if hasattr(module, "nodegraph_nodes"):
        return module
    found = tuple(one for one in vars(module).values() if node_of(one) is not None)

    @hooks.hookimpl
    def nodegraph_nodes() -> tuple[Any, ...]:
        return found

    module.nodegraph_nodes = nodegraph_nodes
    return module


def _distribution(entry: EntryPoint) -> str:
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else ""


def _reason(error: BaseException, where: str = "") -> str:
    place = ""
    last = error.__traceback__
    while last is not None and last.tb_next is not None:
        last = last.tb_next
    if last is not None:
        place = f" ({Path(last.tb_frame.f_code.co_filename).name}:{last.tb_lineno})"
    module = f"{where}: " if where else ""
    return f"{module}{type(error).__name__}: {error}{place}"
