"""What plugins bring, guarded: whatever of it fails names the plugin, the hook and the line."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping
from copy import deepcopy
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, TypeVar

from nodegraph.errors import NodegraphError
from nodegraph.plugin.hook_types import Comparison, Conclusion, Rendered, Renderer, Storage
from nodegraph.plugin.loading import reason_of

Function = Callable[..., Any]


class PluginError(NodegraphError):
    """What a plugin brought has failed, or gave nonsense; says which, by which hook, and where."""


class Nonsense(NodegraphError):
    """What a plugin brought gave something of another kind than its hook's specification says."""

    def __init__(self, given: object, due: str) -> None:
        super().__init__(f"it gave {type(given).__name__} where {due} is due")


@dataclass(frozen=True)
class Source:
    """Who brought something.

    Attributes
    ----------
    plugin, hook : str
    package : str
        Whose code it is.
    """

    plugin: str
    hook: str
    package: str

    def failed(self, what: str, error: BaseException) -> str:
        """Return a sentence that tells of a failure: of what, whose, why and at which line.

        Parameters
        ----------
        what
            What the plugin brought, for a reader.
        error
            What it raised.
        """
        reason = reason_of(error, self.package)
        return f"plugin {self.plugin!r}: {what}, from its hook {self.hook}, failed: {reason}"

    def raising(self, what: str, function: Function, checked: Function) -> Function:
        """Return a function that raises `PluginError` where another one fails.

        Parameters
        ----------
        what
            What the function is called.
        function
            Whatever `nodegraph.NodegraphError` it raises are its own words, and pass.
        checked
            Returns what the function gave, ``checked(given, *arguments)``, or raises `Nonsense`.
        """

        def guarded(*arguments: Any) -> Any:
            try:
                return checked(function(*arguments), *arguments)
            except (Exception, SystemExit) as error:
                if isinstance(error, NodegraphError) and not isinstance(error, Nonsense):
                    raise
                raise PluginError(self.failed(what, error)) from error

        return guarded

    def telling(
        self,
        what: str,
        function: Function,
        checked: Function,
        instead: Function,
        told: str = "it is left out",
    ) -> Function:
        """Return a function that warns where another one fails, and gives something instead.

        Parameters
        ----------
        what, function, checked
            As for `raising`; but whatever is raised is told.
        instead
            Returns what is given instead, ``instead(*arguments)``.
        told
            What becomes of it.
        """

        def guarded(*arguments: Any) -> Any:
            try:
                return checked(function(*arguments), *arguments)
            except (Exception, SystemExit) as error:
                warnings.warn(f"{self.failed(what, error)}; {told}", stacklevel=2)
                return instead(*arguments)

        return guarded


T = TypeVar("T")


def guarded(one: T, source: Source) -> T:
    """Return an object of a hook whose functions are guarded; anything else as it is.

    Parameters
    ----------
    one
        Any object; those that are guarded are of the classes of `nodegraph.plugin.hook_types`.
    source
        Who brought it.
    """
    guard: Callable[[Any, Source], Any] | None = _GUARDS.get(type(one))
    made: T = one if guard is None else guard(one, source)
    return made


def guarded_executor(name: str, function: Function, source: Source) -> Function:
    """Return an executor that raises `PluginError` where another one fails, at whatever step.

    Parameters
    ----------
    name
        By which a command asks for it.
    function
        Called as a `nodegraph.execute.Executor`.
    source
        Who brought it.
    """
    what = f"executor {name!r}"
    start = source.raising(what, function, _steps)

    def executor(schedule: Any, how: Any) -> Iterator[Any]:
        steps = start(schedule, how)
        following = source.raising(what, lambda: next(steps, _END), _itself)
        try:
            while (step := following()) is not _END:
                yield step
        finally:
            if close := getattr(steps, "close", None):
                close()  # which gives up what still runs

    return executor


def guarded_place(name: str, function: Function, source: Source) -> Function:
    """Return what finds the files of a scheme, and raises `PluginError` where that fails.

    Parameters
    ----------
    name
        The scheme, without its colon.
    function
        Returns the path of a name; its own `NodegraphError` passes.
    source
        Who brought it.
    """
    return source.raising(f"what finds {name}:...", function, _path)


def guarded_specimens(held: type, make: Function, source: Source) -> Function:
    """Return what makes specimens of a type, and none, which is told, where that fails.

    Parameters
    ----------
    held
        The type.
    make
        Returns its specimens by name.
    source
        Who brought it.
    """
    return source.telling(f"what makes specimens of {held.__name__}", make, _mapping, _nothing({}))


_END = object()


def _renderer(one: Renderer, source: Source) -> Renderer:
    what = f"the rendering of {one.type.__name__}"
    return replace(one, render=source.raising(what, one.render, _rendered))


def _storage(one: Storage, source: Source) -> Storage:
    def own(given: Any, *_: Any) -> Any:
        return _due(given, one.type, f"a {one.type.__name__}")

    name, copied = one.type.__name__, "a copy is lent"
    together = own if one.faithful else _itself  # a stand-in may be of any type
    return replace(
        one,
        take_apart=source.raising(f"the taking apart of {name}", one.take_apart, _itself),
        put_together=source.raising(f"the putting together of {name}", one.put_together, together),
        lend=one.lend and source.telling(f"the lending of {name}", one.lend, own, deepcopy, copied),
    )


def _comparison(one: Comparison, source: Source) -> Comparison:
    compare, parts = (f"the {word} of {one.type.__name__}" for word in ("comparison", "parts"))
    return replace(
        one,
        compare=source.telling(compare, one.compare, _sentences, _nothing(())),
        parts=one.parts and source.telling(parts, one.parts, _parts, _nothing({})),
    )


def _conclusion(one: Conclusion, source: Source) -> Conclusion:
    name = one.type.__name__
    return replace(
        one,
        conclude=source.telling(
            f"the conclusion of {name}", one.conclude, _sentences, _nothing(())
        ),
        numbers=source.telling(f"the numbers of {name}", one.numbers, _text, _nothing("")),
    )


_GUARDS: Mapping[type, Callable[[Any, Source], Any]] = {
    Renderer: _renderer,
    Storage: _storage,
    Comparison: _comparison,
    Conclusion: _conclusion,
}


def _nothing(nothing: Any) -> Function:
    return lambda *_: nothing


def _due(given: Any, kind: Any, said: str) -> Any:
    if not isinstance(given, kind):
        raise Nonsense(given, said)
    return given


def _itself(given: Any, *_: Any) -> Any:
    return given


def _text(given: Any, *_: Any) -> str:
    return str(_due(given, str, "a text"))


def _path(given: Any, *_: Any) -> Path:
    return Path(_due(given, Path, "a path"))


def _mapping(given: Any, *_: Any) -> Mapping[Any, Any]:
    found: Mapping[Any, Any] = _due(given, Mapping, "a mapping")
    return found


def _rendered(given: Any, *_: Any) -> Rendered:
    found: Rendered = _due(given, Rendered, "a Rendered")
    return found


def _steps(given: Any, *_: Any) -> Iterator[Any]:
    return iter(_due(given, Iterable, "an iterator of steps and their outcomes"))


def _sentences(given: Any, *_: Any) -> tuple[str, ...]:
    if isinstance(given, str):
        raise Nonsense(given, "a list of sentences")
    return tuple(_text(one) for one in _due(given, Iterable, "a list of sentences"))


def _parts(given: Any, value: Any) -> Mapping[str, Any]:
    """Return what the first axes of a value's arrays are, if it has such arrays."""
    for name, axes in _mapping(given).items():
        shape = getattr(getattr(value, _text(name), None), "shape", None)
        if not isinstance(shape, tuple):
            raise NodegraphError(f"{type(value).__name__} has no array {name!r}")
        if len(axes) > len(shape):
            raise NodegraphError(f"{name!r} has {len(shape)} axes, and {len(axes)} are told")
        for size, (word, members) in zip(shape, axes, strict=False):
            if len(members) not in (0, size):
                raise NodegraphError(
                    f"of {name!r} it names {len(members)} of {size}: {_text(word)}"
                )
    return _mapping(given)
