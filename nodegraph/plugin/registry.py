"""Names and the nodes behind them, whoever brought them."""

from __future__ import annotations

import warnings
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from functools import cache, cached_property, lru_cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, get_origin, get_type_hints

import pluggy

from nodegraph.errors import NodeError, NodegraphError, UnknownNodeError, nearest
from nodegraph.node.decorator import Node, node_of
from nodegraph.plugin import hooks, loading
from nodegraph.plugin.guards import (
    Source,
    guarded,
    guarded_executor,
    guarded_place,
    guarded_specimens,
)
from nodegraph.plugin.hook_types import brief
from nodegraph.plugin.loading import BrokenPlugin, HookError, Plugin, package_of, reason_of

if TYPE_CHECKING:
    from nodegraph.plugin.hook_types import Comparison, Conclusion, Contract, Renderer, Storage


_WORDS: Mapping[Any, str] = {
    str: "a text",
    type: "a type",
    Path: "a path",
    Iterable: "a list",
    Mapping: "a mapping",
    Callable: "a function",
}
"""What the types of what hooks return are called."""


def manager(plugins: list[Plugin]) -> pluggy.PluginManager:
    """Return a pluggy manager in which the plugins are registered.

    Parameters
    ----------
    plugins
        One whose hooks take arguments is told and left out.
    """
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


def results(made: pluggy.PluginManager, hook: str) -> Iterator[tuple[Source, Any]]:
    """Yield who brings something by a hook, and what it returns, the last plugin first.

    A hook that raises, or returns something of another kind than its specification says, is told
    and left out; those of the other plugins go on.

    Parameters
    ----------
    made
        Of `manager`.
    hook
        Its name.
    """
    kind = _kinds()[hook]
    for one in reversed(getattr(made.hook, hook).get_hookimpls()):
        source = Source(one.plugin_name, hook, package_of(one.function))
        try:
            returned = one.function()
            is_list = kind is Iterable and not isinstance(returned, str | Mapping)
            found = tuple(returned) if is_list and isinstance(returned, Iterable) else returned
        except (Exception, SystemExit) as error:
            reason = reason_of(error, source.package)
            _tell(one.plugin_name, f"its hook {hook} is", reason)
            continue
        if isinstance(found, tuple if kind is Iterable else kind):
            yield source, found
        else:
            said = f"it returned {type(found).__name__} where {_WORDS[kind]} is due"
            _tell(one.plugin_name, f"its hook {hook} is", said)


def listed(made: pluggy.PluginManager, hook: str, kind: type) -> tuple[Any, ...]:
    """Return what the plugins' hooks list, guarded, the last plugin first.

    Parameters
    ----------
    made
        Of `manager`.
    hook
        Its name.
    kind
        What each must be; what is of another type is told and left out.
    """
    brought = results(made, hook)
    return tuple(
        guarded(one, source) for source, many in brought for one in only(many, kind, source)
    )


def named(
    made: pluggy.PluginManager,
    hook: str,
    kind: Any,
    guard: Callable[[str, Any, Source], Any] = lambda name, one, source: one,
) -> dict[str, Any]:
    """Return what the plugins' hooks give by name; the first plugin's stays.

    Parameters
    ----------
    made
        Of `manager`.
    hook
        Its name.
    kind
        What each must be: a path, a function; what is none, or has no text for a name, or one
        that is taken, is told and left out.
    guard
        Returns each guarded, ``guard(name, one, source)``.
    """
    found: dict[str, Any] = {}
    owner: dict[str, str] = {}
    for source, many in reversed(list(results(made, hook))):
        for name, one in fitting(many, str, kind, source):
            if name in owner:
                why = f"plugin {owner[name]!r} has that name"
                _tell(source.plugin, f"{name!r} of {hook} is", why)
            else:
                found[name], owner[name] = guard(name, one, source), source.plugin
    return found


def only(many: Iterable[Any], kind: Any, source: Source) -> Iterator[Any]:
    """Yield those of many that are of the type that is due; the others are told and left out.

    Parameters
    ----------
    many
        What a hook listed.
    kind
        What each must be.
    source
        Whose hook it was.
    """
    due = _WORDS.get(kind) or f"a {kind.__name__}"
    for one in many:
        if isinstance(one, kind):
            yield one
        else:
            why = f"{brief(one)} is not {due}"
            _tell(source.plugin, f"what {source.hook} lists is", why)


def fitting(many: Mapping[Any, Any], key: type, kind: Any, source: Source) -> Iterator[Any]:
    """Yield those items that are of the types that are due; the others are told and left out.

    Parameters
    ----------
    many
        What a hook returned.
    key, kind
        What each key and each value must be.
    source
        Whose hook it was.
    """
    for one, value in many.items():
        due = _WORDS[kind] if isinstance(one, key) else _WORDS[key]
        if isinstance(one, key) and isinstance(value, kind):
            yield one, value
        else:
            wrong = value if isinstance(one, key) else one
            what = f"{brief(one)} of {source.hook} is"
            _tell(source.plugin, what, f"{brief(wrong)} is not {due}")


def has_other_hooks(plugin: Plugin) -> bool:
    """Return whether a plugin brings anything else than nodes.

    Parameters
    ----------
    plugin
        One that was imported.
    """
    return any(hasattr(plugin.module, name) for name in _kinds() if name != "nodegraph_nodes")


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


@dataclass
class Brought:
    """What plugins bring beside nodes.

    Attributes
    ----------
    loaded : list of Plugin
        Those whose hooks are asked.
    """

    loaded: list[Plugin] = field(default_factory=list)

    @cached_property
    def hooks(self) -> pluggy.PluginManager:
        """The pluggy manager of the loaded plugins."""
        return manager(self.loaded)

    @cached_property
    def renderers(self) -> tuple[Renderer, ...]:
        """How values appear in a report; the last plugin comes first."""
        return listed(self.hooks, "nodegraph_renderers", hooks.Renderer)

    @cached_property
    def comparisons(self) -> tuple[Comparison, ...]:
        """How values are told apart; the last plugin comes first."""
        return listed(self.hooks, "nodegraph_comparisons", hooks.Comparison)

    @cached_property
    def conclusions(self) -> tuple[Conclusion, ...]:
        """What a study concludes from values; the last plugin comes first."""
        return listed(self.hooks, "nodegraph_conclusions", hooks.Conclusion)

    @cached_property
    def storages(self) -> tuple[Storage, ...]:
        """How values are kept; the last plugin comes first."""
        return listed(self.hooks, "nodegraph_storages", hooks.Storage)

    @cached_property
    def executors(self) -> Mapping[str, Callable[..., Any]]:
        """Ways to compute steps that plugins bring, by name."""
        return named(self.hooks, "nodegraph_executors", Callable, guarded_executor)

    @cached_property
    def bibtex(self) -> tuple[str, ...]:
        """The BibTeX that each plugin ships."""
        return tuple(text for _, text in results(self.hooks, "nodegraph_bibtex"))

    @cached_property
    def graphs(self) -> Mapping[str, Path]:
        """Example graphs by name."""
        paths = listed(self.hooks, "nodegraph_graphs", Path)
        return {path.stem: path for path in sorted(paths)}

    @cached_property
    def templates(self) -> Mapping[str, Path]:
        """What ``nodegraph new`` writes: folders by kind."""
        return named(self.hooks, "nodegraph_templates", Path)

    def place(self, path: str) -> Path | None:
        """Return where ``scheme:name`` lies, or None when no plugin has the scheme.

        Parameters
        ----------
        path
            As a graph has it.

        Raises
        ------
        NodegraphError
            If the scheme has no such name, or its plugin fails.
        """
        scheme, _, name = path.partition(":")
        finder = self._places.get(scheme) if name else None
        return finder(name) if finder else None

    def contracts(self, family: str) -> Iterator[tuple[Source, Contract]]:
        """Yield what every node of a family promises, and who says so.

        Parameters
        ----------
        family
            The first word of its nodes' names.
        """
        for source, every in results(self.hooks, "nodegraph_contracts"):
            for name, promised in fitting(every, str, Iterable, source):
                if name == family:
                    yield from ((source, one) for one in only(promised, Callable, source))

    def specimens(self) -> Iterator[tuple[type, Callable[[], Mapping[str, Any]]]]:
        """Yield types, and what makes small values of them by name, the last plugin first."""
        for source, makers in results(self.hooks, "nodegraph_specimens"):
            for held, make in fitting(makers, type, Callable, source):
                yield held, guarded_specimens(held, make, source)

    @cached_property
    def _places(self) -> Mapping[str, Callable[[str], Path]]:
        return named(self.hooks, "nodegraph_places", Callable, guarded_place)


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
        good, broken = loading.installed()
        registry = cls(broken=broken)
        for plugin in good:
            try:
                registry._add_plugin(plugin)
            except Exception as error:
                broken.append(BrokenPlugin(plugin.name, loading.said_by(error)))
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
            Decorated with `nodegraph.node.decorator`.
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
        plugin = loading.from_file(file, but={one.node for one in self})
        try:
            self._add_plugin(plugin)
        except HookError as error:
            place = f"{file}:{error.line}" if error.line else file
            raise NodegraphError(f"{place}: {error.said}") from error
        except Exception as error:
            raise NodegraphError(f"{file}: {loading.said_by(error)}") from error
        empty = not any(one.plugin == plugin.name for one in self)
        if empty and not has_other_hooks(plugin):
            said = 'brings no node; write @node("family.method") above a function'
            warnings.warn(f"{file}: {said}", stacklevel=3)

    def _add_plugin(self, plugin: Plugin) -> None:
        if any(one.name == plugin.name for one in self.loaded):
            raise NodegraphError(f"a plugin {plugin.name!r} is there already; give it another name")
        for one in self.loaded:
            if one.module is plugin.module:
                raise NodegraphError(f"plugin {one.name!r} is the same module, by another name")
        self._add_nodes(plugin.name, plugin.distribution, loading.nodes_of(plugin))
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
