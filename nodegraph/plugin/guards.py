"""Guards around the functions that hooks return: a failure names the plugin, the hook and the line.

If the program cannot continue without the result of a function, `PluginError` is raised; any other
failure is a warning, and a neutral result stands in.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.plugin.hook_types import Command, Detail, Fact, Format, Rendered, Viewer, expect
from nodegraph.plugin.hooks import GROUP
from nodegraph.plugin.kind import Kind
from nodegraph.plugin.loading import error_text
from nodegraph.plugin.streaming import LiveView, Streamable

Function = Callable[..., Any]
_END = object()


class PluginError(NodegraphError):
    """A function of a plugin has failed; the message names plugin, hook and line."""


@dataclass(frozen=True)
class HookSource:
    """The plugin and the hook that something comes from.

    Attributes
    ----------
    plugin, hook : str
    package : str
        The top-level package of the hook's code.
    """

    plugin: str
    hook: str
    package: str

    def failure(self, what: str, error: BaseException) -> str:
        """Return a sentence on a failure: what failed, of which plugin, why, and at which line."""
        reason = error_text(error, self.package)
        return f"plugin {self.plugin!r}: {what}, from hook {self.hook}, failed: {reason}"

    def raising(
        self,
        what: str,
        function: Function,
        passes: tuple[type[Exception], ...] = (NodegraphError,),
    ) -> Function:
        """Return a function that raises `PluginError` where another fails.

        Parameters
        ----------
        what
            The function, as the error names it.
        function
        passes
            Errors that are messages which the plugin wrote for its users.
        """

        def guarded(*arguments: object, **options: object) -> object:
            try:
                return function(*arguments, **options)
            except passes:
                raise
            except (Exception, SystemExit) as error:
                raise PluginError(self.failure(what, error)) from error

        return guarded

    def warning(self, what: str, function: Function, default: Function, outcome: str) -> Function:
        """Return a function that warns where another fails, and returns a default.

        Parameters
        ----------
        what
            The function, as the warning names it.
        function
        default
            Returns the default; called with the same arguments.
        outcome
            The consequence that the warning states.
        """

        def guarded(*arguments: object) -> object:
            try:
                return function(*arguments)
            except (Exception, SystemExit) as error:
                warnings.warn(f"{self.failure(what, error)}; {outcome}", stacklevel=2)
                return default(*arguments)

        return guarded


@dataclass(frozen=True)
class _Rule:
    """The rule by which one function of a record is guarded.

    Attributes
    ----------
    what : str
        The function in messages; ``{}`` stands for the record's type or name.
    result : type or callable, optional
        The type of its result, or ``result(owner, value)``, which returns the value, or raises
        TypeError; the owner is the `Kind` or `Format`.
    default : callable, optional
        Returns the result where the function fails, which is then a warning and not an error;
        called with the same arguments.
    outcome : str
        The consequence that the warning states.
    passes : tuple of exception types
        Errors that are messages which the plugin wrote for its users.
    """

    what: str
    result: Any = object
    default: Function | None = None
    outcome: str = "it is left out"
    passes: tuple[type[Exception], ...] = (NodegraphError,)


def _of_its_type(owner: Any, value: object) -> object:
    return expect(value, owner.type)


def _restored(owner: Kind, value: object) -> object:
    return expect(value, owner.type) if owner.faithful else value


def _sentences(owner: object, value: object) -> tuple[str, ...]:
    return tuple(expect(sentence, str) for sentence in expect(value, Iterable))


def _nothing(*arguments: object) -> None:
    return None


def _facts(owner: object, value: object) -> tuple[Fact, ...]:
    return tuple(expect(fact, Fact) for fact in expect(value, Iterable))


def _no_items(*arguments: object) -> tuple[object, ...]:
    return ()


_OF_FILES = (NodegraphError, ValueError, OSError)
"""The errors by which readers refuse files."""

_RULES: Mapping[type, Mapping[str, _Rule]] = {
    Kind: {
        "render": _Rule("the renderer of {}", Rendered),
        "render_in_run": _Rule("the renderer of {}", Rendered),
        "take_apart": _Rule("take_apart of {}"),
        "put_together": _Rule("put_together of {}", _restored),
        "lend": _Rule("lend of {}", _of_its_type, deepcopy, "a copy is lent"),
        "compare": _Rule("the comparison of {}", _sentences, _no_items),
        "conclude": _Rule("the conclusion of {}", _sentences, _no_items),
        "numbers": _Rule("the numbers of {}", str, lambda value: ""),
        "data": _Rule("the data of {}", Mapping, lambda value: {}),
        "facts": _Rule("the facts of {}", _facts, _no_items),
        "stream": _Rule("the stream of {}", Streamable),
        "live_view": _Rule("the view of {} on a stream", LiveView, _nothing, "it is not shown"),
        "detail": _Rule("the view of blocks of {}", Detail, _nothing, "it is not shown"),
        "specimens": _Rule("the specimens of {}", Mapping, dict),
    },
    Detail: {
        "pack": _Rule("the view of a block of {}", Mapping | None, _nothing, "it is not shown"),
        "layout": _Rule("the layout of {}", Mapping | None, _nothing, "it is not shown"),
    },
    Viewer: {"view": _Rule("the viewer of {}", Rendered)},
    Streamable: {
        "header": _Rule("header of {}"),
        "split": _Rule("split of {}"),
        # a type itself refuses frames that are not values of it
        "join": _Rule("join of {}", _of_its_type, passes=(NodegraphError, ValueError)),
        "missing": _Rule("missing of {}"),
    },
    LiveView: {
        "begin": _Rule("the view of {} on a stream"),
        "pack": _Rule("the view of {} on a stream", bytes),
    },
    Format: {
        "read": _Rule("the format {}", _of_its_type, passes=_OF_FILES),
        "recognizes": _Rule("the format {}", default=lambda start: False),
    },
}
_MADE_LATE = ("stream", "live_view", "detail")
"""Fields of a `Kind` whose functions return a record that is guarded as well."""


def guard(record: Any, source: HookSource, owner: Any = None) -> Any:
    """Return a `Kind`, a `Format` or a `Viewer`, or a record of one, with guarded functions."""
    owner = record if owner is None else owner
    about = _name_of(owner)
    guarded: dict[str, Function] = {}
    for name, rule in _RULES[type(record)].items():
        function = getattr(record, name)
        if function is not None:
            guarded[name] = _guarded(owner, function, rule, about, source)
            if isinstance(record, Kind) and name in _MADE_LATE:
                guarded[name] = _made_once(guarded[name], source, record)
    return replace(record, **guarded)


def _name_of(owner: Any) -> str:
    if isinstance(owner, Viewer):
        return ", ".join(each.__name__ for each in owner.types)
    return str(owner.name if isinstance(owner, Format) else owner.type.__name__)


def _made_once(make: Function, source: HookSource, owner: Kind) -> Function:
    @cache
    def call() -> Any:
        made = make()
        return None if made is None else guard(made, source, owner)

    return call


def _guarded(
    owner: object, function: Function, rule: _Rule, about: str, source: HookSource
) -> Function:
    is_check = callable(rule.result) and not isinstance(rule.result, type)

    def call(*arguments: object, **options: object) -> object:
        value = function(*arguments, **options)
        return rule.result(owner, value) if is_check else expect(value, rule.result)

    what = rule.what.format(about)
    if rule.default is None:
        return source.raising(what, call, rule.passes)
    return source.warning(what, call, rule.default, rule.outcome)


def guard_item(hook: str, name: str, item: Any, source: HookSource) -> Any:
    """Return an item of a hook that names its items, guarded as the hook needs."""
    if hook in ("sources", "sinks"):
        return source.raising(f"{name}:...", item)
    if hook == "node_finders":
        return source.raising(f"the nodes {name}:...", lambda word: expect(item(word), Callable))
    if hook == "places":
        return source.raising(f"the place {name}:...", lambda word: expect(item(word), Path))
    if hook == "readers":
        what = f"the function of {name} that recognizes files"
        return source.raising(what, lambda path: expect(item(path), str | None), _OF_FILES)
    if hook == "executors":
        return _guard_executor(name, item, source)
    if hook == "commands":
        return _guard_command(name, item, source)
    return item


def _guard_executor(name: str, executor: Function, source: HookSource) -> Function:
    """Return an executor that raises `PluginError` where another fails, at whatever step."""
    if source.plugin == GROUP:
        return executor  # a failure is an internal error, or a listener's
    what = f"executor {name!r}"
    start = source.raising(what, lambda *arguments: iter(executor(*arguments)))

    def guarded(schedule: object, how: object) -> Iterator[object]:
        steps = start(schedule, how)
        following = source.raising(what, lambda: next(steps, _END))
        try:
            while (step := following()) is not _END:
                yield step
        finally:
            if close := getattr(steps, "close", None):
                close()  # cancels what still runs

    return guarded


def _guard_command(name: str, command: Command, source: HookSource) -> Command:
    """Return a command that raises `PluginError` where another fails."""
    what = f"command {name!r}"
    return replace(
        command,
        add_arguments=source.raising(what, command.add_arguments),
        call=source.raising(what, lambda arguments: expect(command.call(arguments), int)),
    )
