"""What plugins give when they are asked: each by itself, so that one that fails can be named."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import cache
from pathlib import Path
from typing import Any, get_origin, get_type_hints

import pluggy

from nodegraph import hooks
from nodegraph.errors import nearest
from nodegraph.guarded import guarded
from nodegraph.hook_objects import brief
from nodegraph.plugins import Plugin, package_of, reason_of
from nodegraph.source import Source

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
