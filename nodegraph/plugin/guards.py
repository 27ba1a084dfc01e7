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
    Parts,
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

    def raising(self, what: str, function: Function) -> Function:
        """Return a function that raises `PluginError` where another fails.

        A `nodegraph.NodegraphError` is a message that the plugin wrote for its users, and passes.
        """

        def guarded(*arguments: object) -> object:
            try:
                return function(*arguments)
            except NodegraphError:
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


def guard_renderer(renderer: Renderer, source: Source) -> Renderer:
    """Return a renderer that raises `PluginError` where another fails."""

    def render(value: object, title: str) -> object:
        return expect(renderer.render(value, title), Rendered)

    def render_in_run(value: object, title: str, origin: Any) -> object:
        assert renderer.render_in_run is not None
        return expect(renderer.render_in_run(value, title, origin), Rendered)

    what = f"the renderer of {renderer.type.__name__}"
    return replace(
        renderer,
        render=source.raising(what, render),
        render_in_run=renderer.render_in_run and source.raising(what, render_in_run),
    )


def guard_detail(detail: Detail, source: Source) -> Detail:
    """Return a detail that warns where another fails, and then shows nothing."""
    name = detail.type.__name__

    def pack(block: Any, inputs: Any) -> object:
        return expect(detail.pack(block, inputs), Mapping | None)

    def layout(inputs: Any, column: str) -> object:
        return expect(detail.layout(inputs, column), Mapping | None)

    def nothing(*arguments: object) -> None:
        return None

    return replace(
        detail,
        pack=source.warning(f"the view of a block of {name}", pack, nothing, "it is not shown"),
        layout=source.warning(f"the layout of {name}", layout, nothing, "it is not shown"),
    )


def guard_storage(storage: Storage, source: Source) -> Storage:
    """Return a storage that raises `PluginError` where another fails; a failed loan is a copy."""
    name = storage.type.__name__

    def put_together(parts: object) -> object:
        value = storage.put_together(parts)
        return expect(value, storage.type) if storage.faithful else value

    def lend(value: object) -> object:
        assert storage.lend is not None
        return expect(storage.lend(value), storage.type)

    return replace(
        storage,
        take_apart=source.raising(f"take_apart of {name}", storage.take_apart),
        put_together=source.raising(f"put_together of {name}", put_together),
        lend=storage.lend and source.warning(f"lend of {name}", lend, deepcopy, "a copy is lent"),
    )


def guard_streamable(streamable: Streamable, source: Source) -> Streamable:
    """Return a streamable that raises `PluginError` where another fails.

    What the type itself raises for frames that are not values of it passes.
    """
    kind = streamable.type

    def join(header: object, payloads: Any) -> object:
        try:
            return expect(streamable.join(header, payloads), kind)
        except (NodegraphError, ValueError):
            raise
        except (Exception, SystemExit) as error:
            raise PluginError(source.failure(f"join of {kind.__name__}", error)) from error

    def guarded(name: str) -> Function:
        return source.raising(f"{name} of {kind.__name__}", getattr(streamable, name))

    return replace(
        streamable,
        header=guarded("header"),
        split=guarded("split"),
        join=join,
        missing=guarded("missing"),
    )


def guard_live_view(view: LiveView, source: Source) -> LiveView:
    """Return a view that raises `PluginError` where another fails."""
    what = f"the view of {view.type.__name__} on a stream"

    def pack(payload: object) -> object:
        return expect(view.pack(payload), bytes)

    return replace(view, begin=source.raising(what, view.begin), pack=source.raising(what, pack))


def guard_stream_end(scheme: str, make: Function, source: Source) -> Function:
    """Return what makes a source or a sink, which raises `PluginError` where it fails."""
    return source.raising(f"{scheme}:...", make)


def guard_comparison(comparison: Comparison, source: Source) -> Comparison:
    """Return a comparison that warns where another fails, and finds no difference."""
    name = comparison.type.__name__

    def compare(first: object, second: object) -> tuple[str, ...]:
        return _sentences(comparison.compare(first, second))

    def parts(value: object) -> Parts:
        assert comparison.parts is not None
        return _checked_parts(comparison.parts(value), value)

    return replace(
        comparison,
        compare=source.warning(f"the comparison of {name}", compare, lambda *_: ()),
        parts=comparison.parts and source.warning(f"the parts of {name}", parts, lambda *_: {}),
    )


def guard_conclusion(conclusion: Conclusion, source: Source) -> Conclusion:
    """Return a conclusion that warns where another fails, and concludes nothing."""
    name = conclusion.type.__name__

    def conclude(value: object) -> tuple[str, ...]:
        return _sentences(conclusion.conclude(value))

    def numbers(value: object) -> object:
        return expect(conclusion.numbers(value), str)

    return replace(
        conclusion,
        conclude=source.warning(f"the conclusion of {name}", conclude, lambda *_: ()),
        numbers=source.warning(f"the numbers of {name}", numbers, lambda *_: ""),
    )


def guard_format(form: Format, source: Source) -> Format:
    """Return a format that raises `PluginError` where another fails.

    What the reader raises for a file that it cannot read passes.
    """
    what = f"the format {form.name}"

    def read(path: Path, **options: object) -> object:
        try:
            return expect(form.read(path, **options), form.type)
        except (NodegraphError, ValueError, OSError):
            raise
        except (Exception, SystemExit) as error:
            raise PluginError(source.failure(what, error)) from error

    recognizes = source.warning(what, form.recognizes, lambda start: False)
    return replace(form, read=read, recognizes=recognizes)


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


def _sentences(value: object) -> tuple[str, ...]:
    return tuple(expect(sentence, str) for sentence in expect(value, Iterable))


def _checked_parts(parts: Any, value: object) -> Parts:
    """Return what the first axes of a value's arrays are, if it has such arrays."""
    for name, axes in expect(parts, Mapping).items():
        shape = getattr(getattr(value, expect(name, str), None), "shape", None)
        if not isinstance(shape, tuple):
            raise ValueError(f"{type(value).__name__} has no array {name!r}")
        if len(axes) > len(shape):
            axis_count = f"{len(shape)} {'axis' if len(shape) == 1 else 'axes'}"
            raise ValueError(f"{name!r} has {axis_count}, but {len(axes)} are described")
        for size, (word, members) in zip(shape, axes, strict=False):
            if len(members) not in (0, size):
                raise ValueError(
                    f"{name!r} has {size} along axis {expect(word, str)!r}, "
                    f"but {len(members)} are named"
                )
    described: Parts = parts
    return described
