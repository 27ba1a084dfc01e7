"""Notes of a call while it is made: warnings, and what it reads that is in no key.

That is files and folders that no setting names, and environment variables. What other threads or
C code read is not seen.
"""

from __future__ import annotations

import os
import site
import sys
import sysconfig
import threading
from collections.abc import Iterator, Mapping
from contextvars import ContextVar
from functools import cache
from pathlib import Path
from types import FrameType

from nodegraph.node.decorator import Node

_CODE = (".py", ".pyc", ".pyi", ".so", ".pyd", ".dll", ".nbi", ".nbc")
_BETWEEN = ("os", "collections.abc", "pathlib", "pathlib._local", "glob", "threading", __name__)
"""Modules between this one and a line that reads a variable, lists a folder, starts a thread."""
_LISTINGS = ("os.listdir", "os.scandir")
_EVENTS = frozenset({"open", "os.mkdir", *_LISTINGS})
_CHANGES = ("os.putenv", "os.unsetenv")

notes_of_call: ContextVar[Notes | None] = ContextVar("notes_of_call", default=None)
"""The notes of the call that is being made."""


class Notes:
    """The warnings and files of a call, noted while this is in `notes_of_call`.

    Attributes
    ----------
    node : Node
    warnings : list of str
    reads : dict of str to None, or None
        Names of what was read that is not in the call's key, in the order in which it was; None
        if reads are not noted.
    """

    # one is made for every call
    __slots__ = ("_kept", "_threads", "node", "process", "reads", "warnings")

    def __init__(self, node: Node, settings: Mapping[str, object], *, with_reads: bool) -> None:
        self.node = node
        self.process = os.getpid()
        self.warnings: list[str] = []
        self.reads: dict[str, None] | None = None
        self._threads: list[threading.Thread] = []
        if with_reads:
            _install()
            self.reads = {}
            self._kept = []  # files that settings name, and from here on what the call writes
            for name, setting in node.settings.items():
                if setting.is_file and settings.get(name) is not None:
                    self._kept.append(os.path.abspath(str(settings[name])))

    def note(self, event: str, path: object, *how: object) -> None:
        """Note what Python reports before it opens a file, lists or makes a folder."""
        path = "." if path is None else path
        if self.reads is None or not isinstance(path, (str, os.PathLike)):
            return
        path = os.path.abspath(path)
        is_listing = event in _LISTINGS
        if event == "os.mkdir" or (event == "open" and _writes(*how)):
            self._kept.append(path)
        elif not _is_in(path, (*self._kept, *_installed())) and (
            self._is_by_package() if is_listing else not path.endswith(_CODE)
        ):
            self.reads[f"{os.path.basename(path)}{os.sep if is_listing else ''}"] = None

    def variable(self, name: str) -> None:
        """Note an environment variable, if the node's own package reads it."""
        if self.reads is not None and self._is_by_package():
            self.reads[f"${name}"] = None

    def _is_by_package(self) -> bool:
        """Return whether the line that has led here is in the node's own package."""
        callers = (name for name in _modules_from(sys._getframe(1)) if name not in _BETWEEN)
        return _package(next(callers, "")) == _package(self.node.function.__module__)

    def thread(self, thread: threading.Thread) -> None:
        """Note a thread that the node's own package starts; those of libraries may wait."""
        if self.reads is not None and self._is_by_package():
            self._threads.append(thread)

    def check_threads(self) -> None:
        """Check that no thread of the node's own package is left, which could write to values.

        Raises
        ------
        RuntimeError
        """
        for thread in self._threads:
            if thread.is_alive():
                raise RuntimeError(f"it has returned while its thread {thread.name} still runs")


def _modules_from(frame: FrameType | None) -> Iterator[str]:
    """Yield the modules of a frame and of those that have called it."""
    while frame is not None:
        yield str(frame.f_globals.get("__name__", ""))
        frame = frame.f_back


def _package(module: str) -> str:
    return module.partition(".")[0]


def _is_in(path: str, folders: tuple[str, ...]) -> bool:
    return any(path == folder or path.startswith(folder + os.sep) for folder in folders)


def _writes(mode: object, flags: object) -> bool:
    by_mode = isinstance(mode, str) and not set(mode).isdisjoint("wax+")
    return by_mode or (isinstance(flags, int) and bool(flags & (os.O_WRONLY | os.O_RDWR)))


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
        if notes := notes_of_call.get():
            notes.variable(name)
        return super().__getitem__(name)


@cache
def _install() -> None:
    """Have reads and threads noted from now on, and calls not end the process."""
    _installed()  # which imports, and so opens files
    sys.addaudithook(_note)  # which Python cannot remove again
    os.environ.__class__ = _Environment
    start, end = threading.Thread.start, os._exit

    def start_noted(thread: threading.Thread) -> None:
        start(thread)
        if notes := notes_of_call.get():
            notes.thread(thread)

    def refuse(status: int) -> None:
        notes = notes_of_call.get()
        if notes and notes.reads is not None and notes.process == os.getpid():
            raise RuntimeError(f"a step cannot end the process, with status {status}")
        end(status)

    threading.Thread.start = start_noted  # type: ignore[assignment, method-assign]
    os._exit = refuse  # type: ignore[assignment]


_changes = 0


def environment_changes() -> int:
    """Return the number of changes of environment variables since reads are noted."""
    return _changes


def _note(event: str, arguments: tuple[object, ...]) -> None:
    global _changes
    if event in _EVENTS and (notes := notes_of_call.get()):
        notes.note(event, *arguments)
    elif event in _CHANGES:
        _changes += 1
