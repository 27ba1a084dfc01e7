"""Names and the nodes behind them, whoever brought them."""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from typing import Any

from nodegraph import asked, plugins
from nodegraph.brought import Brought
from nodegraph.errors import NodeError, NodegraphError, UnknownNodeError, nearest
from nodegraph.node import Node, node_of
from nodegraph.plugins import BrokenPlugin, HookError, Plugin


@dataclass(frozen=True)
class Registered:
    """A node and the plugin that brought it."""

    node: Node
    plugin: str
    distribution: str = ""

    @property
    def full_name(self) -> str:
        """The name that always works: ``plugin:family.method``."""
        return f"{self.plugin}:{self.node.name}"


@dataclass
class Registry(Brought):
    """Everything that the plugins bring: nodes by their names, and all else.

    Attributes
    ----------
    loaded : list of Plugin
        Those whose hooks are asked.
    broken : list of BrokenPlugin
        Those that are left out.
    """

    broken: list[BrokenPlugin] = field(default_factory=list)
    _by_name: dict[str, list[Registered]] = field(default_factory=lambda: defaultdict(list))

    @classmethod
    def installed(cls, files: Iterable[Path] = ()) -> Registry:
        """Return the registry of all installed plugins and of the named files.

        Parameters
        ----------
        files
            Python files that are plugins as well.

        Raises
        ------
        NodegraphError
            If a named file cannot be used; an installed plugin that cannot is left out.
        """
        good, broken = plugins.installed()
        registry = cls(broken=broken)
        for plugin in good:
            try:
                registry._add_plugin(plugin)
            except Exception as error:
                broken.append(BrokenPlugin(plugin.name, plugins.said_by(error)))
        for one in broken:
            warnings.warn(f"plugin {one.name!r} is left out: {one.reason}", stacklevel=2)
        for file in {Path(one).resolve(): Path(one) for one in files}.values():
            registry._add_file(file)
        return registry

    @classmethod
    def of(cls, functions: Iterable[Callable[..., Any]], *, plugin: str = "given") -> Registry:
        """Return a registry of these nodes alone, for tests.

        Parameters
        ----------
        functions
            Decorated with `nodegraph.node`.
        plugin
            Who is said to have brought them.
        """
        registry = cls()
        registry._add_nodes(plugin, "", functions)
        return registry

    def __iter__(self) -> Iterator[Registered]:
        for name in sorted(self._by_name):
            yield from self._by_name[name]

    def find(self, name: str) -> Registered:
        """Return the node of that name.

        Parameters
        ----------
        name
            ``family.method``, or ``plugin:family.method``.

        Raises
        ------
        UnknownNodeError
            If no plugin has it, or several do; the message says which.
        """
        plugin, colon, bare = name.rpartition(":")
        claimed = self._by_name.get(bare, [])
        found = [one for one in claimed if not colon or one.plugin == plugin]
        if len(found) == 1:
            return found[0]
        if found:
            raise UnknownNodeError(
                f"node {bare!r} is claimed by {_full_names(found)}; write one of these"
            )
        instead = f"{self._instead(bare)}; those of a plugin file come with --plugin FILE"
        raise UnknownNodeError(f"no node {name!r}; {instead}{self._excuse()}")

    def family(self, family: str) -> Mapping[str, Registered]:
        """Return every method of a family by its label.

        Two methods of one name are labelled ``plugin:method``.

        Parameters
        ----------
        family
            The first word of its nodes' names.
        """
        methods: dict[str, Registered] = {}
        for name in sorted(self._by_name):
            if name.partition(".")[0] == family:
                claimed = self._by_name[name]
                for one in claimed:
                    method = one.node.method
                    methods[method if len(claimed) == 1 else f"{one.plugin}:{method}"] = one
        return methods

    @property
    def families(self) -> tuple[str, ...]:
        """The families that there are."""
        return tuple(sorted({name.partition(".")[0] for name in self._by_name}))

    def without(self, hidden: Callable[[Registered], bool]) -> Registry:
        """Return the registry as if some of its nodes were not there.

        Parameters
        ----------
        hidden
            Tells of each node whether it is left out.
        """
        kept = {
            name: [one for one in claimed if not hidden(one)]
            for name, claimed in self._by_name.items()
        }
        return replace(self, _by_name={name: found for name, found in kept.items() if found})

    def _add_file(self, file: Path) -> None:
        plugin = plugins.from_file(file, but={one.node for one in self})
        try:
            self._add_plugin(plugin)
        except HookError as error:
            place = f"{file}:{error.line}" if error.line else file
            raise NodegraphError(f"{place}: {error.said}") from error
        except Exception as error:
            raise NodegraphError(f"{file}: {plugins.said_by(error)}") from error
        empty = not any(one.plugin == plugin.name for one in self)
        if empty and not asked.has_other_hooks(plugin):
            said = 'brings no node; write @node("family.method") above a function'
            warnings.warn(f"{file}: {said}", stacklevel=3)

    def _add_plugin(self, plugin: Plugin) -> None:
        if any(one.name == plugin.name for one in self.loaded):
            raise NodegraphError(f"a plugin {plugin.name!r} is there already; give it another name")
        for one in self.loaded:
            if one.module is plugin.module:
                raise NodegraphError(f"plugin {one.name!r} is the same module, by another name")
        self._add_nodes(plugin.name, plugin.distribution, plugins.nodes_of(plugin))
        self.loaded.append(plugin)

    def _add_nodes(
        self, plugin: str, distribution: str, functions: Iterable[Callable[..., Any]]
    ) -> None:
        """Add what a plugin brings, all of it or nothing."""
        brought: dict[str, Node] = {}
        for one in map(_described, functions):
            if brought.setdefault(one.name, one) is not one:
                raise NodegraphError(f"it has two nodes of the name {one.name}; rename one")
        for name, described in brought.items():
            self._by_name[name].append(Registered(described, plugin, distribution))

    def _instead(self, name: str) -> str:
        """Return what there is instead: methods of the family, or families."""
        family = name.partition(".")[0]
        if family in self.families:
            methods = [one for one in sorted(self._by_name) if one.startswith(f"{family}.")]
            return nearest(name, methods)
        return nearest(family, self.families, what=f"no family {family!r}; families")

    def _excuse(self) -> str:
        if not self.broken:
            return ""
        return "; left out: " + ", ".join(
            f"plugin {one.name!r} ({one.reason})" for one in self.broken
        )


@lru_cache(maxsize=1)
def default_registry() -> Registry:
    """Return the registry of what is installed, made once."""
    return Registry.installed()


def get_node(name: str) -> Callable[..., Any]:
    """Return an installed node's function, to be called as it is.

    Parameters
    ----------
    name
        ``family.method``, or ``plugin:family.method``.

    Raises
    ------
    UnknownNodeError
        If no plugin has it, or several do.
    """
    return default_registry().find(name).node.function


def _described(function: Callable[..., Any]) -> Node:
    described = node_of(function)
    if described is None:
        name = getattr(function, "__name__", repr(function))
        raise NodegraphError(f"{name} is not a node; decorate it with @node(...)")
    try:
        return described.check()
    except NodeError:
        raise
    except Exception as error:
        raise NodeError(f"{described.name}: {error}") from error


def _full_names(found: Iterable[Registered]) -> str:
    return " and ".join(one.full_name for one in found)
