"""Guards around the functions in hook results: a failure names the plugin, the hook and the line.

If the program cannot continue without the result of a function, `PluginError` is raised; any other
failure is a warning, and a neutral result stands in.
"""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from nodegraph.errors import NodegraphError
from nodegraph.plugin.hook_types import (
    Command,
    Comparison,
    Conclusion,
    Detail,
    Format,
    Rendered,
    Renderer,
    Storage,
    expect,
)
from nodegraph.plugin.hooks import GROUP
from nodegraph.plugin.loading import error_text
from nodegraph.plugin.streaming import LiveView, Streamable

Function = Callable[..., Any]
_END = object()


class PluginError(NodegraphError):
    """A function of a plugin has failed; the message names plugin, hook and line."""


@dataclass(frozen=True)
class Source:
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

    def warning(
        self, what: str, function: Function, default: Function, outcome: str = "it is left out"
    ) -> Function:
        """Return a function that warns where another fails, and returns a default.

        Parameters
        ----------
        what
            The function, as the warning names it.
        function
        default
            Returns the default; called with the same arguments.
        outcome
            What the warning states as the consequence.
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
    checked : callable
        ``checked(record, result)`` returns the result, or raises TypeError.
    default : callable, optional
        Returns the result where the function fails, which is then a warning and not an error;
        called with the same arguments.
    outcome : str
        What the warning states as the consequence.
    passes : tuple of exception types
        Errors that are messages which the plugin wrote for its users.
    """

    what: str
    checked: Callable[[Any, Any], object] = lambda record, result: result
    default: Function | None = None
    outcome: str = "it is left out"
    passes: tuple[type[Exception], ...] = (NodegraphError,)


def _is(hint: object) -> Callable[[Any, Any], object]:
    return lambda record, result: expect(result, hint)


def _is_of_its_type(record: Any, result: object) -> object:
    return expect(result, record.type)


def _is_restored(storage: Storage, result: object) -> object:
    return expect(result, storage.type) if storage.faithful else result


def _are_sentences(record: object, result: object) -> tuple[str, ...]:
    return tuple(expect(sentence, str) for sentence in expect(result, Iterable))


def _nothing(*arguments: object) -> None:
    return None


def _no_sentences(*arguments: object) -> tuple[str, ...]:
    return ()


_RULES: Mapping[type, Mapping[str, _Rule]] = {
    Renderer: {
        name: _Rule("the renderer of {}", _is(Rendered)) for name in ("render", "render_in_run")
    },
    Detail: {
        name: _Rule(f"the {what} of {{}}", _is(Mapping | None), _nothing, "it is not shown")
        for name, what in (("pack", "view of a block"), ("layout", "layout"))
    },
    Storage: {
        "take_apart": _Rule("take_apart of {}"),
        "put_together": _Rule("put_together of {}", _is_restored),
        "lend": _Rule("lend of {}", _is_of_its_type, deepcopy, "a copy is lent"),
    },
    Streamable: {
        "header": _Rule("header of {}"),
        "split": _Rule("split of {}"),
        # a type itself refuses frames that are not values of it
        "join": _Rule("join of {}", _is_of_its_type, passes=(NodegraphError, ValueError)),
        "missing": _Rule("missing of {}"),
    },
    LiveView: {
        "begin": _Rule("the view of {} on a stream"),
        "pack": _Rule("the view of {} on a stream", _is(bytes)),
    },
    Comparison: {
        "compare": _Rule("the comparison of {}", _are_sentences, _no_sentences),
    },
    Conclusion: {
        "conclude": _Rule("the conclusion of {}", _are_sentences, _no_sentences),
        "numbers": _Rule("the numbers of {}", _is(str), lambda value: ""),
    },
    Format: {
        # a reader refuses files by these errors
        "read": _Rule(
            "the format {}", _is_of_its_type, passes=(NodegraphError, ValueError, OSError)
        ),
        "recognizes": _Rule("the format {}", default=lambda start: False),
    },
}


def guard(record: Any, source: Source) -> Any:
    """Return a record of a hook whose functions are guarded, each as its rule says."""
    about = record.name if isinstance(record, Format) else record.type.__name__
    return replace(
        record,
        **{
            name: _guarded(record, getattr(record, name), rule, about, source)
            for name, rule in _RULES[type(record)].items()
            if getattr(record, name) is not None
        },
    )


def _guarded(
    record: object, function: Function, rule: _Rule, about: str, source: Source
) -> Function:
    def call(*arguments: object, **options: object) -> object:
        return rule.checked(record, function(*arguments, **options))

    what = rule.what.format(about)
    if rule.default is None:
        return source.raising(what, call, rule.passes)
    return source.warning(what, call, rule.default, rule.outcome)


def guard_stream_end(scheme: str, make: Function, source: Source) -> Function:
    """Return what makes a source or a sink, which raises `PluginError` where it fails."""
    return source.raising(f"{scheme}:...", make)


def guard_executor(name: str, executor: Function, source: Source) -> Function:
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


def guard_command(name: str, command: Command, source: Source) -> Command:
    """Return a command that raises `PluginError` where another fails."""
    what = f"command {name!r}"
    return replace(
        command,
        add_arguments=source.raising(what, command.add_arguments),
        call=source.raising(what, lambda arguments: expect(command.call(arguments), int)),
    )


def guard_node_finder(
    scheme: str, find: Callable[[str], Function], source: Source
) -> Callable[[str], Function]:
    """Return the function of a scheme, which raises `PluginError` where it fails."""
    return source.raising(f"the nodes {scheme}:...", lambda name: expect(find(name), Callable))


def guard_place(scheme: str, find: Function, source: Source) -> Function:
    """Return a function from a name in a scheme to a path that raises `PluginError` on failure."""
    return source.raising(f"the place {scheme}:...", lambda name: expect(find(name), Path))


def guard_specimens(kind: type, make: Function, source: Source) -> Function:
    """Return a function that makes specimens of a type, and none, with a warning, on failure."""
    what = f"the specimens of {kind.__name__}"
    return source.warning(what, lambda: expect(make(), Mapping), dict)
