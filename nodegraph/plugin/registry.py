"""The registry: names, and the installed nodes that have them."""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache, partial
from pathlib import Path
from typing import Any

from nodegraph.errors import NodeError, NodegraphError, UnknownNodeError, closest, listed, quoted
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin import loading
from nodegraph.plugin.hook_results import HookResults
from nodegraph.plugin.hooks import HOOKS
from nodegraph.plugin.loading import BrokenPlugin, NodesHookError, Plugin, error_text


@dataclass(frozen=True)
class Registered:
    """A node and the plugin that defines it."""

    node: Node
    plugin: str
    distribution: str = ""

    @property
    def full_name(self) -> str:
        """The name that is never ambiguous: ``plugin:family.method``."""
        return f"{self.plugin}:{self.node.name}"


@dataclass
class Registry:
    """The loaded plugins and their nodes by name.

    Attributes
    ----------
    loaded : list of Plugin
    broken : list of BrokenPlugin
        Plugins that are left out.
    """

    loaded: list[Plugin] = field(default_factory=list)
    broken: list[BrokenPlugin] = field(default_factory=list)
    _by_name: dict[str, list[Registered]] = field(default_factory=lambda: defaultdict(list))
    _by_scheme: dict[tuple[str, str], Registered] = field(default_factory=dict)

    @classmethod
    def installed(cls, files: Iterable[Path] = (), *, nodes_with: str = "") -> Registry:
        """Return the registry of all installed plugins and of Python files that are plugins.

        Parameters
        ----------
        files
        nodes_with
            A hook: the nodes of installed plugins without it are left out, and not imported.

        Raises
        ------
        NodegraphError
            If a file cannot be used; an installed plugin that cannot is left out with a warning.
        """
        plugins, broken = loading.installed()
        registry = cls(broken=broken)
        for plugin in plugins:
            try:
                needed = not nodes_with or plugin.has(nodes_with)
                registry._add_plugin(plugin, with_nodes=needed)
            except Exception as error:
                broken.append(BrokenPlugin(plugin.name, error_text(error)))
        for each in broken:
            warnings.warn(f"plugin {each.name!r} is left out: {each.reason}", stacklevel=2)
        for file in {Path(file).resolve(): Path(file) for file in files}.values():
            registry._add_file(file)
        return registry

    @classmethod
    def of(cls, functions: Iterable[Callable[..., object]], *, plugin: str = "given") -> Registry:
        """Return a registry of these nodes alone, as if a plugin of that name defined them."""
        registry = cls()
        registry._add_nodes(plugin, "", functions)
        return registry

    @cached_property
    def hooks(self) -> HookResults:
        """The hook results of this package and the loaded plugins, except nodes."""
        return HookResults([loading.built_in(), *self.loaded])

    @cached_property
    def shipped(self) -> frozenset[str]:
        """The names of the plugins of this package's own distribution, and of itself."""
        names = (each.name for each in self.loaded if _is_shipped(each.distribution))
        return frozenset([loading.built_in().name, *names])

    def __iter__(self) -> Iterator[Registered]:
        for name in sorted(self._by_name):
            yield from self._by_name[name]

    def find(self, name: str) -> Registered:
        """Return the node of a name, ``family.method`` or ``plugin:family.method``.

        Raises
        ------
        UnknownNodeError
            If no plugin defines it, or several do.
        """
        plugin, colon, bare_name = name.rpartition(":")
        if colon and plugin in self.hooks.of("node_finders"):
            return self._of_scheme(plugin, bare_name)
        nodes = self._by_name.get(bare_name, [])
        matches = [node for node in nodes if not colon or node.plugin == plugin]
        if len(matches) == 1:
            return matches[0]
        if matches:
            claimed = " and ".join(node.full_name for node in matches)
            raise UnknownNodeError(
                f"node {bare_name!r} is claimed by {claimed}", "write one of these"
            )
        raise UnknownNodeError(f"no node {quoted(name)}", partial(self._instead_of, bare_name))

    def family(self, family: str) -> Mapping[str, Registered]:
        """Return every method of a family by its label.

        Two methods of the same name are labelled ``plugin:method``.
        """
        methods: dict[str, Registered] = {}
        for name in sorted(self._by_name):
            if name.partition(".")[0] == family:
                claims = self._by_name[name]
                for registered in claims:
                    method = registered.node.method
                    label = method if len(claims) == 1 else f"{registered.plugin}:{method}"
                    methods[label] = registered
        return methods

    def used(self, name: str) -> list[Registered]:
        """Return the nodes for which ``use: name`` stands, of ``family.*`` all; none if unknown."""
        if name.endswith(".*"):
            return list(self.family(name[:-2]).values())
        try:
            return [self.find(name)]
        except UnknownNodeError:
            return []

    @property
    def families(self) -> tuple[str, ...]:
        """The first words of the nodes' names."""
        return tuple(sorted({name.partition(".")[0] for name in self._by_name}))

    def without(self, is_hidden: Callable[[Registered], bool]) -> Registry:
        """Return a copy without the nodes for which a function is true."""
        visible = {
            name: [node for node in nodes if not is_hidden(node)]
            for name, nodes in self._by_name.items()
        }
        return replace(self, _by_name={name: nodes for name, nodes in visible.items() if nodes})

    def _of_scheme(self, scheme: str, name: str) -> Registered:
        """Return the node that the plugin of a scheme makes of a name."""
        if (scheme, name) not in self._by_scheme:
            try:
                node = _checked_node(self.hooks.of("node_finders")[scheme](name))
            except NodegraphError as error:
                message, _, instead = f"no node '{scheme}:{name}': {error}".partition("; ")
                raise UnknownNodeError(message, instead) from error
            self._by_scheme[scheme, name] = Registered(replace(node, name=name), scheme)
        return self._by_scheme[scheme, name]

    def _add_file(self, file: Path) -> None:
        plugin = loading.from_file(file, known={registered.node for registered in self})
        try:
            self._add_plugin(plugin)
        except NodesHookError as error:
            place = f"{file}:{error.line}" if error.line else file
            raise NodegraphError(f"{place}: {error.reason}") from error
        except Exception as error:
            raise NodegraphError(f"{file}: {error_text(error)}") from error
        has_nodes = any(registered.plugin == plugin.name for registered in self)
        has_other_hooks = any(plugin.has(hook) for hook in HOOKS if hook != "nodes")
        if not has_nodes and not has_other_hooks:
            hint = 'write @node("family.method") above a function'
            warnings.warn(f"{file}: defines no nodes; {hint}", stacklevel=3)

    def _add_plugin(self, plugin: Plugin, *, with_nodes: bool = True) -> None:
        for other in (loading.built_in(), *self.loaded):
            if other.name == plugin.name:
                raise NodegraphError(
                    f"a plugin {plugin.name!r} is already registered; choose another name"
                )
            if other.module is plugin.module:
                raise NodegraphError(f"it is the same module as plugin {other.name!r}")
        if with_nodes:
            self._add_nodes(plugin.name, plugin.distribution, loading.nodes_of(plugin))
        self.loaded.append(plugin)

    def _add_nodes(
        self, plugin: str, distribution: str, functions: Iterable[Callable[..., object]]
    ) -> None:
        """Add the nodes of a plugin, all of them or none.

        Those of this package's own distribution are read when they are used; its tests check them.
        """
        nodes: dict[str, Node] = {}
        for node in map(_node if _is_shipped(distribution) else _checked_node, functions):
            if nodes.setdefault(node.name, node) is not node:
                raise NodegraphError(f"it has two nodes of the name {node.name}; rename one")
        for name, node in nodes.items():
            self._by_name[name].append(Registered(node, plugin, distribution))

    def _instead_of(self, name: str) -> str:
        """Return a hint for an unknown name: the nearest, and what else may be missing."""
        family, dot, method = name.partition(".")
        names = sorted(self._by_name)
        if family in self.families:
            methods = [each for each in names if each.startswith(f"{family}.")]
            close = closest(method, [each.partition(".")[2] for each in methods])
            guess = repr(f"{family}.{close}") if close else ""
            there = f"there is: {listed(methods)}" if dot else f"it is a family: {listed(methods)}"
        else:
            same = [each for each in names if each.endswith(f".{name}")] or [closest(name, names)]
            guess = " or ".join(map(repr, filter(None, same)))
            there = f"families: {listed(self.families)}"
        if guess:
            there = f"did you mean {guess}? {there}; nodes of a plugin file need --plugin FILE"
        elif dot:
            there = f"a node of a plugin file needs --plugin FILE; {there}"
        reasons = (f"plugin {each.name!r} ({each.reason})" for each in self.broken)
        return f"{there}; left out: {', '.join(reasons)}" if self.broken else there


@lru_cache(maxsize=1)
def default_registry() -> Registry:
    """Return the registry of all installed plugins, which is built once."""
    return Registry.installed()


def get_node(name: str) -> Callable[..., Any]:
    """Return an installed node's function, which can be called as it is.

    Parameters
    ----------
    name
        ``family.method``, or ``plugin:family.method``.

    Raises
    ------
    UnknownNodeError
        If no plugin defines it, or several do.
    """
    return default_registry().find(name).node.function


def _is_shipped(distribution: str) -> bool:
    return distribution.partition(" ")[0] == loading.built_in().name


def _node(function: Callable[..., object]) -> Node:
    node = node_of(function)
    if node is None:
        name = getattr(function, "__name__", repr(function))
        raise NodegraphError(f"{name} is not a node; decorate it with @node(...)")
    return node


def _checked_node(function: Callable[..., object]) -> Node:
    node = _node(function)
    try:
        return node.check()
    except NodeError:
        raise
    except Exception as error:
        raise NodeError(f"{node.name}: {error}") from error
