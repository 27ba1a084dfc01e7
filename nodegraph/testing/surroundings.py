"""What a node must leave as it found it: chance, settings of libraries, the process, the disk."""

from __future__ import annotations

import io
import os
import random
import sys
import threading
import warnings
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from nodegraph.equality import difference

_DRAWS = (
    "draws from the global random state, so that no run can be repeated: draw from "
    "numpy.random.default_rng(seed), where `seed: int = 0` is a setting"
)
_PRINTS = (
    "prints: nobody reads that among a thousand steps; tell the user with warnings.warn(...), "
    "which the report lists"
)
_LETS_OUT = (
    "lets warnings of numpy out, which the report shows to users: keep such samples out of the "
    "calculation, or put `with numpy.errstate(...):` around the line; what users should know is a "
    "plain warnings.warn(...)"
)
_WRITES = (
    "writes files itself: only the machine writes, so that a stored result reaches the run's "
    "folder as well; return nodegraph.Files({name: bytes}) from a node write.NAME"
)


@dataclass(frozen=True)
class _Thing:
    """Something that every node in the process shares: how it is read, put back, complained of."""

    fault: str
    read: Callable[[], Any]
    put_back: Callable[[Any], object]


@dataclass
class Left:
    """What a call has left otherwise than it was: each fault with what shows it."""

    faults: dict[str, str] = field(default_factory=dict)


@contextmanager
def surroundings(seed: int) -> Iterator[Left]:
    """Watch what is called in there, and put back whatever it changes.

    Parameters
    ----------
    seed
        Of the global random states, which nobody should see.
    """
    left = Left()
    with warnings.catch_warnings(record=True) as heard:
        # not "ignore", which a node that silences all warnings would leave as it is
        warnings.simplefilter("always")
        things = _things()
        kept = [thing.read() for thing in things]
        random.seed(seed)
        np.random.seed(seed)  # noqa: NPY002  (it is what is watched)
        began = [thing.read() for thing in things]
        said = io.StringIO()
        try:
            with _files_written() as written, redirect_stdout(said), redirect_stderr(said):
                yield left
        finally:
            left.faults.update(_changed(things, began))
            for thing, original in zip(things, kept, strict=True):
                thing.put_back(original)
            left.faults.update(_heard(said.getvalue(), heard, written))


def _changed(things: Iterable[_Thing], began: Iterable[Any]) -> Iterator[tuple[str, str]]:
    for thing, before in zip(things, began, strict=True):
        if changed := difference(before, thing.read(), name="it"):
            yield thing.fault, changed.removeprefix("it")


def _heard(
    said: str, heard: Iterable[warnings.WarningMessage], written: Iterable[str]
) -> Iterator[tuple[str, str]]:
    if said:
        yield _PRINTS, repr(said[:60])
    if numeric := [one for one in heard if issubclass(one.category, RuntimeWarning)]:
        yield _LETS_OUT, str(numeric[0].message)
    if there := [path for path in dict.fromkeys(written) if Path(path).is_file()]:
        # one that is gone again, a library has needed for a moment
        yield _WRITES, ", ".join(there)


def _things() -> tuple[_Thing, ...]:
    """Return what is watched: of libraries, those that are imported already."""
    return (
        _Thing(_DRAWS, _random_states, _set_random_states),
        _Thing(
            _leaves("numpy's treatment of errors", "with numpy.errstate(...): around the line"),
            np.geterr,
            lambda kept: np.seterr(**kept),
        ),
        _Thing(
            _leaves("numpy's print options", "with numpy.printoptions(...): around the line"),
            np.get_printoptions,
            lambda kept: np.set_printoptions(**kept),
        ),
        _Thing(
            _leaves("the filters of warnings", "with warnings.catch_warnings(): around the line"),
            lambda: [str(one) for one in warnings.filters],
            lambda kept: None,  # whoever watches has caught them
        ),
        _Thing(
            _leaves("os.environ", "pass what a library needs as an argument"),
            lambda: dict(os.environ),
            _set_environment,
        ),
        _Thing(_leaves("the working directory", "use whole paths"), os.getcwd, os.chdir),
        _Thing(_leaves("sys.path", "import from installed packages"), sys.path.copy, _set_path),
        *_of_matplotlib(),
    )


def _leaves(what: str, instead: str) -> str:
    return f"changes {what} for everybody else in the process: {instead}"


def _of_matplotlib() -> Iterator[_Thing]:
    matplotlib, pyplot = sys.modules.get("matplotlib"), sys.modules.get("matplotlib.pyplot")
    if matplotlib is not None:
        with_context = "with matplotlib.rc_context(...): around the drawing"
        parameters: Any = getattr(matplotlib, "rcParams", {})
        yield _Thing(
            _leaves("matplotlib.rcParams", with_context),
            lambda: dict(dict.items(parameters)),  # its own methods warn, and choose a backend
            lambda kept: dict.update(parameters, kept),
        )
    if pyplot is not None:
        yield _Thing(
            "leaves a figure open in pyplot, which keeps it in memory for good: draw on "
            "matplotlib.figure.Figure()",
            lambda: list(pyplot.get_fignums()),
            lambda kept: [pyplot.close(one) for one in pyplot.get_fignums() if one not in kept],
        )


def _random_states() -> tuple[Any, ...]:
    return random.getstate(), np.random.get_state(legacy=False)  # noqa: NPY002


def _set_random_states(kept: tuple[Any, ...]) -> None:
    random.setstate(kept[0])
    np.random.set_state(kept[1])  # noqa: NPY002


def _set_environment(kept: dict[str, str]) -> None:
    if dict(os.environ) != kept:
        os.environ.clear()
        os.environ.update(kept)


def _set_path(kept: list[str]) -> None:
    sys.path[:] = kept


_written: dict[int, list[str]] = {}
"""Per thread that is watched, what it has opened to write."""


@contextmanager
def _files_written() -> Iterator[list[str]]:
    """Note the files that this thread opens to write."""
    _listen()
    found: list[str] = []
    here = threading.get_ident()
    outer = _written.get(here)
    _written[here] = found
    try:
        yield found
    finally:
        del _written[here]
        if outer is not None:
            _written[here] = outer


def _listen() -> None:
    """Hear of every file that is opened; Python offers no way to stop again."""
    if not hasattr(_note_opened, "listens"):
        sys.addaudithook(_note_opened)
        _note_opened.listens = True  # type: ignore[attr-defined]


def _note_opened(event: str, arguments: tuple[Any, ...]) -> None:
    if event != "open" or not _written:
        return
    path, mode, flags = arguments
    found = _written.get(threading.get_ident())
    by_mode = isinstance(mode, str) and not set(mode).isdisjoint("wax+")
    by_flags = isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR))
    if found is not None and (by_mode or by_flags) and isinstance(path, (str, os.PathLike)):
        found.append(os.path.abspath(path))
