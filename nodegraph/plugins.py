"""Finding plugins: by entry point, or from a file that the user named."""

from __future__ import annotations

import importlib.util
import sys
import time
import warnings
from collections.abc import Container, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from traceback import walk_tb
from typing import Any, get_origin, get_type_hints

import pluggy

from nodegraph import hooks
from nodegraph.errors import NodegraphError, nearest
from nodegraph.node import Node, node_of
from nodegraph.started import LOADED

_WORDS: Mapping[Any, str] = {str: "text", Iterable: "a list", Mapping: "a mapping"}
"""What the types that hooks return are called."""


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
            reason = f"{entry.value}: {_reason(error, _package(entry.module))}"
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
        spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        if sys.modules.get(path.stem) is module:
            del sys.modules[path.stem]
            sys.modules.update({path.stem: before} if before else {})
        reason = _reason(error, path.stem)
        raise NodegraphError(f"{path}: the plugin does not import: {reason}") from error
    return Plugin(path.stem, _with_nodes(module, but))


def nodes_of(plugin: Plugin) -> tuple[Any, ...]:
    """Return the functions that a plugin gives as its nodes.

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
        raise HookError(error, _package_of(hook)) from error
    kind = type(found).__name__
    raise NodegraphError(f"its hook nodegraph_nodes returned {kind}: return [node, ...]")


def has_other_hooks(plugin: Plugin) -> bool:
    """Return whether a plugin brings anything else than nodes."""
    return any(hasattr(plugin.module, name) for name in _kinds() if name != "nodegraph_nodes")


def manager(plugins: list[Plugin]) -> pluggy.PluginManager:
    """Return a pluggy manager in which the plugins are registered."""
    made = pluggy.PluginManager(hooks.GROUP)
    made.add_hookspecs(hooks)
    for plugin in plugins:
        try:
            made.register(plugin.module, plugin.name)
        except pluggy.PluginValidationError as error:
            made.unregister(name=plugin.name)
            _tell(plugin.name, "its hooks are", " ".join(str(error).split()))
        else:
            _tell_unknown(made, plugin)
    return made


def results(made: pluggy.PluginManager, hook: str) -> Iterator[tuple[str, Any]]:
    """Yield each plugin's name and what its hook returns, the last plugin first.

    A hook that raises, or returns something of another kind than its specification says, is told
    and left out; those of the other plugins go on.
    """
    kind = _kinds()[hook]
    for one in reversed(getattr(made.hook, hook).get_hookimpls()):
        try:
            returned = one.function()
            is_list = kind is Iterable and not isinstance(returned, str | Mapping)
            found = tuple(returned) if is_list and isinstance(returned, Iterable) else returned
        except (Exception, SystemExit) as error:
            reason = _reason(error, _package_of(one.function))
            _tell(one.plugin_name, f"its hook {hook} is", reason)
            continue
        if isinstance(found, tuple if kind is Iterable else kind):
            yield one.plugin_name, found
        else:
            said = f"it returned {type(found).__name__} where {_WORDS[kind]} is due"
            _tell(one.plugin_name, f"its hook {hook} is", said)


def listed(made: pluggy.PluginManager, hook: str, kind: type) -> tuple[Any, ...]:
    """Return what the plugins' hooks list, the last plugin first; what is of another type is told.

    Parameters
    ----------
    made
    hook
    kind
        What each must be.
    """
    found = []
    for name, many in results(made, hook):
        for one in many:
            if isinstance(one, kind):
                found.append(one)
            else:
                said = f"{one!r} is not a {kind.__name__}"
                _tell(name, f"what {hook} lists is", said)
    return tuple(found)


def named(made: pluggy.PluginManager, hook: str) -> dict[str, Any]:
    """Return what the plugins' hooks give by name; a name that is taken is told and left out."""
    found: dict[str, Any] = {}
    owner: dict[str, str] = {}
    for name, many in reversed(list(results(made, hook))):
        for key, one in many.items():
            if key in owner:
                _tell(name, f"{key!r} of {hook} is", f"plugin {owner[key]!r} has that name")
            else:
                found[key], owner[key] = one, name
    return found


def said_by(error: BaseException) -> str:
    """Return what an error says; its kind too, if it is not written for users."""
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


@cache
def _kinds() -> Mapping[str, Any]:
    """Return the type that each hook returns, as its specification says."""
    kinds = {}
    for name, specification in vars(hooks).items():
        if name.startswith(f"{hooks.GROUP}_"):
            returned = get_type_hints(specification)["return"]
            kinds[name] = get_origin(returned) or returned
    return kinds


def _tell_unknown(made: pluggy.PluginManager, plugin: Plugin) -> None:
    """Tell of what is marked as a hook, and is none: a name that is written wrongly."""
    known = _kinds()
    for name in dir(plugin.module):
        marked = made.parse_hookimpl_opts(plugin.module, name)
        if marked is not None and (marked.get("specname") or name) not in known:
            _tell(plugin.name, f"{name} is", f"there is no such hook; {nearest(name, known)}")


def _tell(plugin: str, what: str, why: str) -> None:
    warnings.warn(f"plugin {plugin!r}: {what} left out: {why}", stacklevel=2)


def _distribution(entry: EntryPoint) -> str:
    return f"{entry.dist.name} {entry.dist.version}" if entry.dist else ""


def _reason(error: BaseException, package: str) -> str:
    file, line = _place(error, package)
    return said_by(error) + (f" ({file}:{line})" if file else "")


def _place(error: BaseException, package: str) -> tuple[str, int]:
    """Return file and line of the last step in the plugin's own code, not in what it calls."""
    place = ("", 0)
    for frame, line in walk_tb(error.__traceback__):
        if _package(frame.f_globals.get("__name__", "")) == package:
            place = (Path(frame.f_code.co_filename).name, line)
    return place


def _package_of(hook: Any) -> str:
    return _package(getattr(hook, "__module__", ""))


def _package(module: str) -> str:
    return module.partition(".")[0]
