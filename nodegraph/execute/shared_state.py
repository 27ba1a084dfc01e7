"""State that all nodes of a process share: what a node changes there is put back after its step."""

from __future__ import annotations

import ctypes
import io
import os
import pickle
import random
import stat
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import lru_cache
from operator import itemgetter
from typing import Any

import numpy as np

from nodegraph.execute.call_notes import environment_changes


@dataclass(frozen=True)
class SharedState:
    """State of a process, which is read as values that compare with ``==``.

    Attributes
    ----------
    name : str
        With a verb: ``changes os.environ``.
    instead : str
        Advice to the node's author.
    read : callable
        Returns the state.
    restore : callable
        Takes what `read` returned.
    """

    name: str
    instead: str
    read: Callable[[], object]
    restore: Callable[[Any], object]


_unwatched: set[str] = set()


def unwatch_random() -> None:
    """Leave the state of `random` alone from now on, because other threads draw from it."""
    _unwatched.add("random")


class StateBefore:
    """The shared state as it was when none of the calls was being made that are being made now.

    What a node changes in the state of a library, beyond numpy, is not seen.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._calls: set[object] = set()
        self._marks: tuple[object, ...] = ()
        self._files: list[tuple[int, int] | None] = []
        self._before: list[object] = []

    def forget(self) -> None:
        """Read all of the state before the next call, as a run begins.

        In a run, files of the standard streams are looked at after each call alone.
        """
        self._marks = ()

    def begin(self, call: object) -> None:
        """Note that a call begins."""
        with self._lock:
            if not self._calls and (marks := _marks()) != self._marks:
                self._marks, self._files = marks, _files()
                self._before = [state.read() for state in SHARED]
                _copy_descriptors()
            self._calls.add(call)

    def put_back(self, call: object) -> list[str]:
        """Put back what has changed when a call ends or is given up; return a warning for each."""
        with self._lock:
            if call not in self._calls:
                return []
            self._calls.remove(call)
            if _marks() == self._marks and _files() == self._files:
                return []
            return list(self._put_back())

    def _put_back(self) -> Iterator[str]:
        for state, before in zip(SHARED, self._before, strict=True):
            if state.read() != before:
                try:
                    state.restore(before)
                except OSError as error:
                    yield f"it {state.name}, which cannot be put back: {error.strerror}"
                else:
                    yield f"it {state.name}, which is put back: {state.instead}"


def _marks() -> tuple[object, ...]:
    """Return what differs if any of the state does but files, in a tenth of the time to read that.

    Nodes of a chain may take less time than the states of the generators alone, which are compared
    by their memory.
    """
    engine = _numpy().get_bit_generator()
    numpys, own, pythons = _memory_of_generators(engine)
    errors, printing = _OPTIONS
    return (
        engine,
        object() if numpys is None else numpys.raw,
        own.raw,
        *(() if _unwatched else (pythons.raw, _PYTHON.gauss_next)),
        errors.get(),
        printing.get(),
        environment_changes(),
        _folder(),
        sys.path.copy(),
        sys.getrecursionlimit(),
        sys.stdin,
        sys.stdout,
        sys.stderr,
        getattr(sys.stdin, "closed", False),
        getattr(sys.stdout, "closed", False),
        getattr(sys.stderr, "closed", False),
    )


def _folder() -> str:
    try:
        return os.getcwd()
    except FileNotFoundError:
        return ""


def _enter(folder: str) -> None:
    if folder:
        os.makedirs(folder, exist_ok=True)
        os.chdir(folder)


def _environment() -> dict[Any, Any]:
    """Return the variables as `os.environ` holds them: as texts, each would cost a read of it."""
    data: dict[Any, Any] = vars(os.environ)["_data"]
    return data.copy()


def _set_environment(original: dict[Any, Any]) -> None:
    os.environ.clear()
    os.environ.update({os.fsdecode(name): os.fsdecode(value) for name, value in original.items()})


_CORE: Any = vars(np)["_core"]
_OPTIONS = (_CORE.umath._extobj_contextvar, _CORE.arrayprint.format_options)
"""The variables in which numpy has its treatment of errors and its print options."""
_PYTHON: Any = vars(random)["getstate"].__self__
_STATE = 4 * 625
"""Bytes of a Mersenne Twister: 624 words and the position, first in Python's, last in numpy's."""
_ENOUGH = 64
"""Bytes around the position that differ after any draw, which moves it, and after any seed."""


def _random_states() -> tuple[object, bytes]:
    """Return numpy's engine and the states of the generators."""
    own = None if _unwatched else random.getstate()
    states = own, np.random.get_state(legacy=False)  # noqa: NPY002
    return _numpy().get_bit_generator(), pickle.dumps(states)


@lru_cache(maxsize=1)
def _memory_of_generators(engine: Any) -> tuple[Any, Any, Any]:
    """Return memory of numpy's engine, where that is known, and of numpy's and Python's own."""
    words: Any = None
    if type(engine) is np.random.MT19937:
        words = _memory(engine.ctypes.state_address + _STATE - _ENOUGH, _ENOUGH)
    own, head = _numpy().get_state.__self__, object.__basicsize__
    fields = _memory(id(own) + head, type(own).__basicsize__ - head)
    return words, fields, _memory(id(_PYTHON) + head, _ENOUGH)


def _memory(address: int, size: int) -> Any:
    return (ctypes.c_char * size).from_address(address)


def _numpy() -> Any:
    """Return a module with more than its declarations say; importing it here would take 20 ms."""
    return np.random


def _set_random_states(original: tuple[object, bytes]) -> None:
    engine, states = original
    own, numpy = pickle.loads(states)
    if own is not None:
        random.setstate(own)
    _numpy().set_bit_generator(engine)
    np.random.set_state(numpy)  # noqa: NPY002


_STREAMS = {
    name: number
    for number, name in enumerate(("stdin", "stdout", "stderr"))
    if getattr(sys, f"__{name}__") is not None  # else the number is that of any other file
}
_FILE_OF: Callable[[Any], tuple[int, int]] = itemgetter(stat.ST_INO, stat.ST_DEV)
_copies: dict[int, tuple[int, tuple[int, int]]] = {}
"""The descriptor of each standard stream, another for the same file, and this file."""


def _streams() -> tuple[list[object], list[bool], list[tuple[int, int] | None]]:
    """Return the standard streams, which of them are closed, and the files of their descriptors."""
    streams = [getattr(sys, name) for name in _STREAMS]
    return streams, [getattr(stream, "closed", False) for stream in streams], _files()


def _files() -> list[tuple[int, int] | None]:
    try:
        return list(map(_FILE_OF, map(os.fstat, _STREAMS.values())))
    except OSError:
        return [_file(number) for number in _STREAMS.values()]


def _set_streams(original: tuple[list[Any], list[bool], list[tuple[int, int] | None]]) -> None:
    for (name, number), stream, was_closed, file in zip(_STREAMS.items(), *original, strict=True):
        copy, _ = _copies.get(number, (-1, None))
        if _file(number) != file and _file(copy) == file:
            os.dup2(copy, number)
        if stream.closed and not was_closed:
            raw = io.FileIO(number, "r" if name == "stdin" else "w", closefd=False)
            buffered = io.BufferedReader(raw) if name == "stdin" else io.BufferedWriter(raw)
            stream = io.TextIOWrapper(
                buffered, stream.encoding, stream.errors, line_buffering=name != "stdin"
            )
        setattr(sys, name, stream)


def _file(number: int) -> tuple[int, int] | None:
    """Return the number and the device of the file that a descriptor stands for."""
    try:
        return _FILE_OF(os.fstat(number))
    except OSError:
        return None


def _copy_descriptors() -> None:
    """Have another descriptor of each standard stream, so that it can be opened again."""
    for number in _STREAMS.values():
        file = _file(number)
        if file is not None and (number not in _copies or _copies[number][1] != file):
            # an earlier one is not closed: if a node has, its number is another file's by now
            _copies[number] = os.dup(number), file


SHARED = (
    SharedState(
        "draws from the global random state",
        "draw from numpy.random.default_rng(seed), where `seed: int = 0` is a setting",
        _random_states,
        _set_random_states,
    ),
    SharedState(
        "changes numpy's treatment of errors",
        "put `with numpy.errstate(...):` around the line",
        np.geterr,
        lambda original: np.seterr(**original),
    ),
    SharedState(
        "changes numpy's print options",
        "put `with numpy.printoptions(...):` around the line",
        np.get_printoptions,
        lambda original: np.set_printoptions(**original),
    ),
    SharedState(
        "changes os.environ",
        "pass what a library needs as an argument",
        _environment,
        _set_environment,
    ),
    SharedState("changes the working directory", "use whole paths", _folder, _enter),
    SharedState(
        "changes sys.path",
        "import from installed packages",
        sys.path.copy,
        lambda original: sys.path.__setitem__(slice(None), original),
    ),
    SharedState(
        "changes the limit of recursion",
        "use a loop",
        sys.getrecursionlimit,
        sys.setrecursionlimit,
    ),
    SharedState(
        "closes or replaces standard streams",
        "use contextlib.redirect_stdout",
        _streams,
        _set_streams,
    ),
)
"""Everything that is put back, with what a node should do instead."""
