"""What plugins give when they are asked: each by itself, so that one that fails can be named."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Iterator, Mapping
from functools import cache
from typing import Any, get_origin, get_type_hints

import pluggy

from nodegraph import hooks
from nodegraph.errors import nearest
from nodegraph.plugins import Plugin, package_of, reason_of

_WORDS: Mapping[Any, str] = {str: "text", Iterable: "a list", Mapping: "a mapping"}
"""What the types that hooks return are called."""


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
            reason = reason_of(error, package_of(one.function))
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


def has_other_hooks(plugin: Plugin) -> bool:
    """Return whether a plugin brings anything else than nodes."""
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
