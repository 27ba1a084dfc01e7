"""The results of the hooks of the loaded plugins, checked, guarded and combined.

A hook that fails, or an item of another type than the hook declares, is left out with a warning
that names the plugin and the hook; everything else continues.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from inspect import getattr_static, getdoc
from pathlib import Path
from types import FunctionType, ModuleType
from typing import Any, NoReturn

import pluggy

from nodegraph.errors import nearest
from nodegraph.node.declaration import UNDECLARED
from nodegraph.node.decorator import Node
from nodegraph.plugin.guards import HookSource, guard, guard_item
from nodegraph.plugin.hook_types import Contract, Format, Tried, Viewer, expect
from nodegraph.plugin.hooks import GROUP, HOOKS, Shape, specifications
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.loading import Plugin, error_text, package_of


@dataclass
class HookResults:
    """The hook results except nodes; each hook is called when its result is first needed."""

    plugins: list[Plugin]
    _known: dict[str, Any] = field(default_factory=dict, repr=False)

    def of(self, hook: str) -> Any:
        """Return the results of all plugins of one hook of `HOOKS`.

        Returns
        -------
        tuple, or mapping by name
            The last plugin's items first; of one name, the first plugin's.
        """
        if hook not in self._known:
            shape = HOOKS[hook].shape
            if shape is Shape.NAMED:
                self._known[hook] = self._named(hook)
            elif shape is Shape.TEXT:
                self._known[hook] = tuple(text for text, _ in self._results(hook))
            else:
                self._known[hook] = tuple(item for item, _ in self._listed(hook))
        return self._known[hook]

    @cached_property
    def kinds(self) -> tuple[Kind, ...]:
        """What plugins know of types, with guarded functions; the last plugin comes first."""
        return tuple(guard(*pair) for pair in self._listed("kinds"))

    @cached_property
    def formats(self) -> tuple[Format, ...]:
        """Formats of files, with guarded functions; the last plugin comes first.

        The code of the plugins' own functions, those of ``of("formats")``, counts in keys of steps.
        """
        return tuple(guard(*pair) for pair in self._listed("formats"))

    @cached_property
    def viewers(self) -> tuple[Viewer, ...]:
        """What shows values together, with guarded functions; the last plugin comes first."""
        return tuple(guard(*pair) for pair in self._listed("viewers"))

    def viewer(self, value: object) -> Viewer | None:
        """Return the last plugin's viewer of values of that type; else None."""
        return next((each for each in self.viewers if isinstance(value, each.types)), None)

    @cached_property
    def graphs(self) -> dict[str, Path]:
        """Example graphs by name."""
        return {path.stem: path for path in sorted(self.of("graphs"))}

    def kind(self, value_type: type, what: str) -> Kind | None:
        """Return the last plugin's record of a type, or of a base, that has a field; else None."""
        return next((kind for kind in self.having(what) if issubclass(value_type, kind.type)), None)

    def having(self, what: str) -> tuple[Kind, ...]:
        """Return the records of types that have a field, the last plugin's first."""
        return tuple(kind for kind in self.kinds if getattr(kind, what) is not None)

    def place(self, path: str) -> Path | None:
        """Return the file or folder that ``scheme:name`` names, or None for an unknown scheme.

        Raises
        ------
        NodegraphError
            If the scheme has no such name, or its plugin fails.
        """
        scheme, _, name = path.partition(":")
        find = self.of("places").get(scheme) if name else None
        return find(name) if find else None

    def is_place(self, path: str) -> bool:
        """Return whether a path is ``scheme:name`` with the scheme of a plugin."""
        scheme, _, name = path.partition(":")
        return bool(name) and scheme in self.of("places")

    def broken_promises(
        self,
        node: Node,
        inputs: Mapping[str, object],
        outputs: Mapping[str, object],
        settings: Mapping[str, object],
        again: Callable[..., Mapping[str, Any] | None] | None = None,
    ) -> Iterator[tuple[str, str]]:
        """Yield what a call of a node breaks of its family's promises: the promise, and where.

        Parameters
        ----------
        node
        inputs, outputs
            The values at its ports.
        settings
            Those that it was called with; the others have their defaults.
        again
            Calls it with other inputs, as a contract needs it: see `Tried`. None: no contract is
            followed beyond the point where it does that.
        """
        contracts = self._contracts.get(node.family)
        if contracts is None:
            return
        settings = {**node.defaults, **settings}
        lookahead = node.lookahead(settings)
        tried = Tried(
            inputs=inputs,
            outputs=outputs,
            settings=settings,
            units={name: setting.unit for name, setting in node.settings.items() if setting.unit},
            doc=node.doc,
            lookahead=None if lookahead is UNDECLARED else lookahead,
            meets_ends=bool(node.meets_ends(settings)),
            again=again or _not_again,
        )
        for contract, source in contracts:
            try:
                for violation in contract(tried):
                    yield _promise(contract), violation
            except _CalledAgain:
                continue
            except Exception as error:
                yield _promise(contract), source.failure(_name(contract), error)

    @cached_property
    def _contracts(self) -> Mapping[str, Sequence[tuple[Contract, HookSource]]]:
        """Promises by family, the last plugin's first."""
        contracts: dict[str, list[tuple[Contract, HookSource]]] = {}
        for family, promises, source in self._items("contracts"):
            contracts.setdefault(family, []).extend(_of_type(promises, Contract, source))
        return contracts

    def _named(self, hook: str) -> dict[str, Any]:
        """Return the items of a hook that returns a mapping; of one name, the first plugin's."""
        named: dict[str, object] = {}
        owner: dict[str, str] = {}
        for name, value, source in reversed(list(self._items(hook))):
            if name in named:
                why = f"plugin {owner[name]!r} has that name"
                _warn_left_out(source.plugin, f"{name!r} of {source.hook}", why)
            else:
                named[name], owner[name] = guard_item(hook, name, value, source), source.plugin
        return named

    def _items(self, hook: str) -> Iterator[tuple[str, Any, HookSource]]:
        """Yield the items of a hook that returns a mapping: name, value and source."""
        for mapping, source in self._results(hook):
            for name, value in mapping.items():
                try:
                    expect(name, str)
                    expect(value, HOOKS[hook].item)
                except TypeError as error:
                    _warn_left_out(source.plugin, f"{name!r} of {source.hook}", str(error))
                else:
                    yield name, value, source

    def _listed(self, hook: str) -> Iterator[tuple[Any, HookSource]]:
        """Yield the items of a hook that returns an iterable, with their source."""
        for items, source in self._results(hook):
            yield from _of_type(items, HOOKS[hook].item, source)

    def _results(self, hook: str) -> Iterator[tuple[Any, HookSource]]:
        """Yield the result of each plugin's hook, the last plugin's first."""
        name, shape = f"{GROUP}_{hook}", HOOKS[hook].shape
        for implementation in reversed(getattr(self._manager.hook, name).get_hookimpls()):
            package = package_of(implementation.function)
            source = HookSource(implementation.plugin_name, name, package)
            try:
                result = expect(implementation.function(), shape.value)
                result = tuple(result) if shape is Shape.LIST else result
            except (Exception, SystemExit) as error:
                _warn_left_out(source.plugin, f"its hook {name}", error_text(error, package))
            else:
                yield result, source

    @cached_property
    def _manager(self) -> pluggy.PluginManager:
        manager = _Manager(GROUP)
        manager.add_hookspecs(specifications())
        for plugin in self.plugins:
            try:
                manager.register(plugin.module, plugin.name)
            except pluggy.PluginValidationError as error:
                manager.unregister(name=plugin.name)
                _warn_left_out(plugin.name, "each of its hooks", " ".join(str(error).split()))
            else:
                _warn_of_unknown_hooks(manager, plugin)
        return manager


def _name(contract: Contract) -> str:
    return getattr(contract, "__name__", repr(contract))


def _promise(contract: Contract) -> str:
    """Return what a contract states."""
    return (getdoc(contract) or _name(contract)).partition("\n")[0].rstrip(".")


class _CalledAgain(Exception):
    """A contract has called a node that may not be called again."""


def _not_again(*_: object, **__: object) -> NoReturn:
    raise _CalledAgain


class _Manager(pluggy.PluginManager):
    def parse_hookimpl_opts(self, plugin: object, name: str) -> Any:
        """Return the options of a hook; None for any other name, without pluggy's long look."""
        is_module = isinstance(plugin, ModuleType)
        value = vars(plugin).get(name) if is_module else getattr_static(plugin, name)
        function = value.__func__ if isinstance(value, staticmethod) else value
        is_hook = isinstance(function, FunctionType) and hasattr(function, f"{GROUP}_impl")
        return super().parse_hookimpl_opts(plugin, name) if is_hook else None


def _of_type(
    items: Iterable[object], kind: object, source: HookSource
) -> Iterator[tuple[Any, HookSource]]:
    for number, item in enumerate(items):
        try:
            yield expect(item, kind), source
        except TypeError as error:
            _warn_left_out(source.plugin, f"item {number} of {source.hook}", str(error))


def _warn_of_unknown_hooks(manager: pluggy.PluginManager, plugin: Plugin) -> None:
    """Warn of functions that are marked as hooks but have a misspelled name."""
    known = [f"{GROUP}_{hook}" for hook in HOOKS]
    for name in dir(plugin.module):
        options = manager.parse_hookimpl_opts(plugin.module, name)
        if options is not None and (options.get("specname") or name) not in known:
            _warn_left_out(plugin.name, name, f"there is no such hook; {nearest(name, known)}")


def _warn_left_out(plugin: str, what: str, reason: str) -> None:
    warnings.warn(f"plugin {plugin!r}: {what} is left out: {reason}", stacklevel=2)
