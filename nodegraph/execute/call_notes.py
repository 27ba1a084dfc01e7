"""Notes of a call while it is made: warnings, threads, and files it reads that are in no key.

That is files and folders that no setting names, and environment variables.
"""

from __future__ import annotations

import os
import site
import sys
import sysconfig
import threading
from collections.abc import Mapping
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from types import FrameType

from nodegraph.node.decorator import Node

_CODE = (".py", ".pyc", ".pyi", ".so", ".pyd", ".dll", ".nbi", ".nbc")
_BETWEEN = ("os", "collections.abc", "pathlib", "pathlib._local", "glob", "threading", __name__)
"""Modules between this one and a line that reads a variable, lists a folder, starts a thread."""
_LISTINGS = ("os.listdir", "os.scandir")
_FORKS = ("os.fork", "os.forkpty")
_EVENTS = frozenset({"open", "os.mkdir", *_LISTINGS, *_FORKS})

notes_of_call: ContextVar[Notes | None] = ContextVar("notes_of_call", default=None)
"""The notes of the call that is being made."""


class Notes:
    """The warnings and files of a call, noted while this is in `notes_of_call`.

    What other threads or C code read is not seen.

    Parameters
    ----------
    node
    settings
    with_reads
        Whether reads are noted.

    Attributes
    ----------
    warnings : list of str
    reads : dict of str to None
        Names of what was read that is not in the call's key, in the order in which it was.
    """

    # made for every call: what is seldom needed is a tuple, which costs nothing
    __slots__ = ("_node", "_settings", "_threads", "_written", "reads", "warnings", "with_reads")

    def __init__(self, node: Node, settings: Mapping[str, object], *, with_reads: bool) -> None:
        if with_reads:
            _install()
        self.with_reads = with_reads
        self.warnings: list[str] = []
        self.reads: dict[str, None] = {}
        self._node = node
        self._settings = settings
        self._written: tuple[str, ...] = ()
        self._threads: tuple[threading.Thread, ...] = ()

    def file(self, path: str, *, writes: bool) -> None:
        """Note that a file was opened."""
        if writes:
            self._written += (path,)
        elif not path.endswith(_CODE) and self._is_read(path):
            self.reads[os.path.basename(path)] = None

    def folder(self, path: str) -> None:
        """Note that a folder was listed, if the node's own package does."""
        if self._is_by_package() and self._is_read(path):
            self.reads[f"{os.path.basename(path)}{os.sep}"] = None

    def new_folder(self, path: str) -> None:
        """Note a folder whose content is the call's own."""
        self._written += (path,)

    def variable(self, name: str) -> None:
        """Note an environment variable, if the node's own package reads it."""
        if self._is_by_package():
            self.reads[f"${name}"] = None

    def fork(self) -> None:
        """Refuse a fork by the node's own package, after which two processes would go on.

        Raises
        ------
        RuntimeError
        """
        if self._is_by_package():
            raise RuntimeError("a step cannot fork; use multiprocessing or subprocess")

    def thread(self, thread: threading.Thread) -> None:
        """Note a thread that the node's own package starts.

        Those of libraries may wait for the next call.
        """
        if self._is_by_package():
            self._threads += (thread,)

    def check_threads(self) -> None:
        """Check that no thread of the node's own package is left, which could write to values.

        Raises
        ------
        RuntimeError
        """
        for thread in self._threads:
            if thread.is_alive():
                raise RuntimeError(f"it has returned while its thread {thread.name} still runs")

    def _is_read(self, path: str) -> bool:
        kept = (*self._written, *self._in_key(), *_installed())
        return not _is_in(path, kept)

    def _is_by_package(self) -> bool:
        frame: FrameType | None = sys._getframe(1)
        while frame is not None and frame.f_globals.get("__name__") in _BETWEEN:
            frame = frame.f_back
        module = str(frame.f_globals.get("__name__", "")) if frame is not None else ""
        return module.partition(".")[0] == self._node.function.__module__.partition(".")[0]

    def _in_key(self) -> tuple[str, ...]:
        """Return the files that settings name."""
        return tuple(
            os.path.abspath(str(self._settings[name]))
            for name, setting in self._node.settings.items()
            if setting.is_file and self._settings.get(name) is not None
        )


def _is_in(path: str, folders: tuple[str, ...]) -> bool:
    return any(path == folder or path.startswith(folder + os.sep) for folder in folders)


@cache
def _installed() -> tuple[str, ...]:
    """Return the folders of the system, of installed packages, and of what these keep for later."""
    from platformdirs import user_cache_dir

    names = ("stdlib", "platstdlib", "purelib", "platlib", "data")
    return (
        *(sysconfig.get_path(name) for name in names),
        sys.base_prefix,
        site.getusersitepackages(),
        user_cache_dir(),
        str(Path(__file__).parents[2] / "plugins"),
        *("/proc", "/sys", "/dev", "/etc", "/usr"),
    )


class _Environment(type(os.environ)):  # type: ignore[misc]
    """``os.environ``, whose reads are noted."""

    def __getitem__(self, name: str) -> object:
        if notes := _noting_reads():
            notes.variable(name)
        return super().__getitem__(name)


@cache
def _install() -> None:
    """Have reads and threads noted from now on; Python cannot remove an audit hook again."""
    sys.addaudithook(_note)
    os.environ.__class__ = _Environment
    start = threading.Thread.start

    def start_noted(thread: threading.Thread) -> None:
        start(thread)
        if notes := _noting_reads():
            notes.thread(thread)

    threading.Thread.start = start_noted  # type: ignore[assignment, method-assign]


def _noting_reads() -> Notes | None:
    notes = notes_of_call.get()
    return notes if notes is not None and notes.with_reads else None


def _note(event: str, arguments: tuple[object, ...]) -> None:
    if event not in _EVENTS or not (notes := _noting_reads()):
        return
    if event in _FORKS:
        notes.fork()
        return
    path, *how = arguments
    if path is None:  # that of a listing
        path = "."
    if not isinstance(path, (str, os.PathLike)):
        return
    if event == "os.mkdir":
        notes.new_folder(os.path.abspath(path))
    elif event in _LISTINGS:
        notes.folder(os.path.abspath(path))
    else:
        mode, flags = how
        by_mode = isinstance(mode, str) and not set(mode).isdisjoint("wax+")
        by_flags = isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR))
        notes.file(os.path.abspath(path), writes=by_mode or by_flags)
