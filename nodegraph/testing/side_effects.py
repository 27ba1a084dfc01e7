"""Side effects that no node may have: on random states, libraries, the process, the disk."""

from __future__ import annotations

import io
import os
import random
import sys
import threading
import warnings
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph.equality import difference
from nodegraph.execute.shared_state import SHARED, SharedState

_PRINTS = (
    "prints: nobody reads that among a thousand steps; use warnings.warn(...), which the report "
    "lists"
)
_LETS_WARNINGS_OUT = (
    "lets warnings of numpy out, which the report shows to users: keep such samples out of the "
    "calculation, or put `with numpy.errstate(...):` around the line; for users, write a plain "
    "warnings.warn(...)"
)
_WRITES = (
    "writes files itself: only the machine writes, so that a stored result reaches the run's "
    "folder as well; return nodegraph.Files({name: bytes}) from a node write.NAME"
)


@contextmanager
def side_effects(seed: int) -> Iterator[dict[str, str]]:
    """Watch a call, restore what it changes, and fill a mapping of fault to detail at the end.

    Parameters
    ----------
    seed
        The seed of the global random states during the call.
    """
    effects: dict[str, str] = {}
    with warnings.catch_warnings(record=True) as caught, _seeded(seed):
        # not "ignore", which a node that silences all warnings would leave unchanged
        warnings.simplefilter("always")
        shared = _shared_states()
        before = [state.read() for state in shared]
        printed = io.StringIO()
        try:
            with _files_written() as written, redirect_stdout(printed), redirect_stderr(printed):
                yield effects
        finally:
            effects.update(_put_back(shared, before))
            effects.update(_emitted(printed.getvalue(), caught, written))


@contextmanager
def _seeded(seed: int) -> Iterator[None]:
    """Seed the global random states, and restore them."""
    original, numpys = random.getstate(), np.random.get_state(legacy=False)  # noqa: NPY002
    random.seed(seed)
    np.random.seed(seed)  # noqa: NPY002  (it is what is watched)
    try:
        yield
    finally:
        random.setstate(original)
        np.random.set_state(numpys)  # noqa: NPY002


def _put_back(shared: Iterable[SharedState], before: Iterable[object]) -> Iterator[tuple[str, str]]:
    """Restore what has changed, and yield what that is."""
    for state, value in zip(shared, before, strict=True):
        now = state.read()
        if now == value:
            continue
        if changed := difference(value, now, name="it"):
            yield (
                f"{state.name} for everything else in the process: {state.instead}",
                changed.removeprefix("it"),
            )
        state.restore(value)


def _emitted(
    printed: str, caught: Iterable[warnings.WarningMessage], written: Iterable[str]
) -> Iterator[tuple[str, str]]:
    if printed:
        yield _PRINTS, repr(printed[:60])
    if numeric := [each for each in caught if issubclass(each.category, RuntimeWarning)]:
        yield _LETS_WARNINGS_OUT, str(numeric[0].message)
    if paths := [path for path in dict.fromkeys(written) if Path(path).is_file()]:
        # a file that is gone again, a library needed for a moment
        yield _WRITES, ", ".join(paths)


def _shared_states() -> tuple[SharedState, ...]:
    """Return the shared states, of libraries those that are imported already."""
    return (
        *SHARED,
        SharedState(
            "changes the filters of warnings",
            "put `with warnings.catch_warnings():` around the line",
            lambda: [str(each) for each in warnings.filters],
            lambda original: None,  # catch_warnings restores them
        ),
        *_states_of_matplotlib(),
    )


def _states_of_matplotlib() -> Iterator[SharedState]:
    matplotlib, pyplot = sys.modules.get("matplotlib"), sys.modules.get("matplotlib.pyplot")
    if matplotlib is not None:
        parameters: Any = getattr(matplotlib, "rcParams", {})
        yield SharedState(
            "changes matplotlib.rcParams",
            "put `with matplotlib.rc_context(...):` around the drawing",
            lambda: dict(dict.items(parameters)),  # its own methods warn, and choose a backend
            lambda original: dict.update(parameters, original),
        )
    if pyplot is not None:
        yield SharedState(
            "leaves a figure open in pyplot",
            "draw on matplotlib.figure.Figure()",
            lambda: list(pyplot.get_fignums()),
            lambda original: [
                pyplot.close(number) for number in pyplot.get_fignums() if number not in original
            ],
        )


_written_paths: dict[int, list[str]] = {}
"""Paths that each watched thread has opened to write."""


@contextmanager
def _files_written() -> Iterator[list[str]]:
    """Collect the paths that this thread opens to write."""
    if not hasattr(_note_opened, "is_installed"):
        sys.addaudithook(_note_opened)  # which Python cannot remove again
        _note_opened.is_installed = True  # type: ignore[attr-defined]
    paths: list[str] = []
    thread = threading.get_ident()
    _written_paths[thread] = paths
    try:
        yield paths
    finally:
        del _written_paths[thread]


def _note_opened(event: str, arguments: tuple[object, ...]) -> None:
    if event != "open" or not _written_paths:
        return
    path, mode, flags = arguments
    paths = _written_paths.get(threading.get_ident())
    by_mode = isinstance(mode, str) and not set(mode).isdisjoint("wax+")
    by_flags = isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR))
    if paths is not None and (by_mode or by_flags) and isinstance(path, (str, os.PathLike)):
        paths.append(os.path.abspath(path))
