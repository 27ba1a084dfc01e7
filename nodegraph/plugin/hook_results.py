"""The results of the hooks of the loaded plugins, checked, guarded and combined.

A hook that fails, or an item of another type than the hook's specification declares, is left out
with a warning that names the plugin and the hook; everything else continues.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from pathlib import Path
from typing import Any, get_args, get_origin, get_type_hints

import pluggy

from nodegraph.errors import nearest
from nodegraph.plugin import hooks
from nodegraph.plugin.guards import (
    Source,
    guard,
    guard_command,
    guard_executor,
    guard_node_finder,
    guard_place,
    guard_specimens,
    guard_stream_end,
)
from nodegraph.plugin.hook_types import (
    Command,
    Comparison,
    Conclusion,
    Contract,
    Detail,
    Format,
    Renderer,
    Storage,
    expect,
)
from nodegraph.plugin.loading import Plugin, error_text, package_of
from nodegraph.plugin.streaming import LiveView, Streamable


@dataclass
class HookResults:
    """The hook results except nodes; each hook is called when its result is first needed."""

    plugins: list[Plugin]

    @cached_property
    def renderers(self) -> tuple[Renderer, ...]:
        """Renderers of values in a report; the last plugin comes first."""
        return self._guarded("nodegraph_renderers")

    @cached_property
    def details(self) -> tuple[Detail, ...]:
        """Views of single blocks of a comparison; the last plugin comes first."""
        return self._guarded("nodegraph_details")

    @cached_property
    def comparisons(self) -> tuple[Comparison, ...]:
        """Descriptions of differences; the last plugin comes first."""
        return self._guarded("nodegraph_comparisons")

    @cached_property
    def conclusions(self) -> tuple[Conclusion, ...]:
        """Conclusions that a study draws from values; the last plugin comes first."""
        return self._guarded("nodegraph_conclusions")

    @cached_property
    def storages(self) -> tuple[Storage, ...]:
        """Forms in which values are stored; the last plugin comes first."""
        return self._guarded("nodegraph_storages")

    @cached_property
    def formats(self) -> tuple[Format, ...]:
        """Formats of files; the last plugin comes first."""
        return tuple(guard(*pair) for pair in self._formats)

    @property
    def unguarded_formats(self) -> tuple[Format, ...]:
        """The formats with the plugins' own functions, whose code counts in the keys of steps."""
        return tuple(form for form, _ in self._formats)

    @cached_property
    def streamables(self) -> tuple[Streamable, ...]:
        """Types whose values are split into frames; the last plugin comes first."""
        return self._guarded("nodegraph_streamables")

    @cached_property
    def live_views(self) -> tuple[LiveView, ...]:
        """Views on the page of a stream; the last plugin comes first."""
        return self._guarded("nodegraph_live_views")

    @cached_property
    def sources(self) -> Mapping[str, Callable[[str], object]]:
        """Functions that open a source of frames at an address, by scheme."""
        return self._named("nodegraph_sources", guard_stream_end)

    @cached_property
    def sinks(self) -> Mapping[str, Callable[[str], object]]:
        """Functions that open a sink of frames at an address, by scheme."""
        return self._named("nodegraph_sinks", guard_stream_end)

    @cached_property
    def executors(self) -> Mapping[str, Callable[..., Any]]:
        """Ways to compute steps, by name."""
        return self._named("nodegraph_executors", guard_executor)

    @cached_property
    def node_finders(self) -> Mapping[str, Callable[[str], Callable[..., Any]]]:
        """Functions from names to nodes, by scheme."""
        return self._named("nodegraph_node_finders", guard_node_finder)

    @cached_property
    def bibtex(self) -> tuple[str, ...]:
        """The BibTeX of each plugin; the last plugin comes first."""
        return tuple(text for text, _ in self._results("nodegraph_bibtex"))

    @cached_property
    def graphs(self) -> Mapping[str, Path]:
        """Example graphs by name."""
        paths = sorted(path for path, _ in self._listed("nodegraph_graphs"))
        return {path.stem: path for path in paths}

    @cached_property
    def templates(self) -> Mapping[str, Path]:
        """Folders that ``nodegraph new`` copies, by kind."""
        return self._named("nodegraph_templates")

    @cached_property
    def commands(self) -> Mapping[str, Command]:
        """Commands of the command line, by name."""
        return self._named("nodegraph_commands", guard_command)

    def place(self, path: str) -> Path | None:
        """Return the file or folder that ``scheme:name`` names, or None for an unknown scheme.

        Raises
        ------
        NodegraphError
            If the scheme has no such name, or its plugin fails.
        """
        scheme, _, name = path.partition(":")
        find = self._places.get(scheme) if name else None
        return find(name) if find else None

    def is_place(self, path: str) -> bool:
        """Return whether a path is ``scheme:name`` with the scheme of a plugin."""
        scheme, _, name = path.partition(":")
        return bool(name) and scheme in self._places

    def contracts(self, family: str) -> Iterator[tuple[Contract, Source]]:
        """Yield the promises of a family, the last plugin's first."""
        for name, promises, source in self._items("nodegraph_contracts"):
            if name == family:
                yield from _of_type(promises, Contract, source)

    def specimens(self) -> Iterator[tuple[type, Callable[[], Mapping[str, object]]]]:
        """Yield types with functions that make small values by name, the last plugin's first."""
        for kind, make, source in self._items("nodegraph_specimens"):
            yield kind, guard_specimens(kind, make, source)

    @cached_property
    def _formats(self) -> tuple[tuple[Format, Source], ...]:
        return tuple(self._listed("nodegraph_formats"))

    @cached_property
    def _places(self) -> Mapping[str, Callable[[str], Path]]:
        return self._named("nodegraph_places", guard_place)

    def _guarded(self, hook: str) -> tuple[Any, ...]:
        return tuple(guard(*pair) for pair in self._listed(hook))

    def _named(
        self,
        hook: str,
        guard: Callable[[str, Any, Source], object] = lambda name, value, source: value,
    ) -> dict[str, Any]:
        """Return the items of a hook that returns a mapping; of one name, the first plugin's."""
        named: dict[str, object] = {}
        owner: dict[str, str] = {}
        for name, value, source in reversed(list(self._items(hook))):
            if name in named:
                why = f"plugin {owner[name]!r} has that name"
                _warn_left_out(source.plugin, f"{name!r} of {hook}", why)
            else:
                named[name], owner[name] = guard(name, value, source), source.plugin
        return named

    def _items(self, hook: str) -> Iterator[tuple[Any, Any, Source]]:
        """Yield the items of a hook that returns a mapping: key, value and source."""
        key_type, value_type = get_args(declared_hooks()[hook])
        for mapping, source in self._results(hook):
            for key, value in mapping.items():
                try:
                    expect(key, key_type)
                    expect(value, value_type)
                except TypeError as error:
                    _warn_left_out(source.plugin, f"{key!r} of {hook}", str(error))
                else:
                    yield key, value, source

    def _listed(self, hook: str) -> Iterator[tuple[Any, Source]]:
        """Yield the items of a hook that returns an iterable, with their source."""
        (item_type,) = get_args(declared_hooks()[hook])
        for items, source in self._results(hook):
            yield from _of_type(items, item_type, source)

    def _results(self, hook: str) -> Iterator[tuple[Any, Source]]:
        """Yield the result of each plugin's hook, the last plugin's first."""
        declared = declared_hooks()[hook]
        for implementation in reversed(getattr(self._manager.hook, hook).get_hookimpls()):
            package = package_of(implementation.function)
            source = Source(implementation.plugin_name, hook, package)
            try:
                result = expect(implementation.function(), declared)
                result = tuple(result) if get_origin(declared) is Iterable else result
            except (Exception, SystemExit) as error:
                reason = error_text(error, package)
                _warn_left_out(source.plugin, f"its hook {hook}", reason)
            else:
                yield result, source

    @cached_property
    def _manager(self) -> pluggy.PluginManager:
        manager = pluggy.PluginManager(hooks.GROUP)
        manager.add_hookspecs(hooks)
        for plugin in self.plugins:
            try:
                manager.register(plugin.module, plugin.name)
            except pluggy.PluginValidationError as error:
                manager.unregister(name=plugin.name)
                reason = " ".join(str(error).split())
                _warn_left_out(plugin.name, "each of its hooks", reason)
            else:
                _warn_of_unknown_hooks(manager, plugin)
        return manager


@cache
def declared_hooks() -> Mapping[str, object]:
    """Return the type that each hook returns, by the hook's name."""
    return {
        name: get_type_hints(specification)["return"]
        for name, specification in vars(hooks).items()
        if name.startswith(f"{hooks.GROUP}_")
    }


def _of_type(items: Iterable[object], kind: object, source: Source) -> Iterator[tuple[Any, Source]]:
    for number, item in enumerate(items):
        try:
            yield expect(item, kind), source
        except TypeError as error:
            _warn_left_out(source.plugin, f"item {number} of {source.hook}", str(error))


def _warn_of_unknown_hooks(manager: pluggy.PluginManager, plugin: Plugin) -> None:
    """Warn of functions that are marked as hooks but have a misspelled name."""
    for name in dir(plugin.module):
        options = manager.parse_hookimpl_opts(plugin.module, name)
        if options is not None and (options.get("specname") or name) not in declared_hooks():
            reason = f"there is no such hook; {nearest(name, declared_hooks())}"
            _warn_left_out(plugin.name, name, reason)


def _warn_left_out(plugin: str, what: str, reason: str) -> None:
    warnings.warn(f"plugin {plugin!r}: {what} is left out: {reason}", stacklevel=2)
