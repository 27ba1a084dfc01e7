"""Small and large files, read in one go and written whole or not at all.

Paths are texts here, and calls go to the system directly: a result is looked up in some
microseconds, of which paths as objects would take most.

Several users may share a store, and each can put a symbolic link in the place of a folder. What is
written, dated or removed is therefore named relative to an open `Folder`, which is reached without
following links; what is only read is checked by its digest, and is named by its path.
"""

from __future__ import annotations

import errno
import hashlib
import itertools
import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import suppress
from io import IOBase
from pathlib import Path
from typing import Any

UNFINISHED = re.compile(r"[0-9a-f]{8}-\d+-\d+\.part")
"""The name of a file that is not yet whole."""
_OPENS_FOLDERS = os.open in os.supports_dir_fd
_DATES_LINKS = os.utime in os.supports_follow_symlinks
_NO_LINK = getattr(os, "O_NOFOLLOW", 0)
# without waiting: a pipe in place of a file is empty
READ = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
_LONGEST = 2**28
_WRITE = os.O_WRONLY | os.O_CREAT | os.O_EXCL
_own = secrets.token_hex(4)
_numbers = itertools.count()


def read(path: str) -> tuple[bytes, float]:
    """Return the content of a small file, and when it was last changed.

    Raises
    ------
    OSError
        If it cannot be read, or is far from small.
    """
    opened = os.open(path, READ)
    try:
        status = os.fstat(opened)
        if status.st_size > _LONGEST:
            raise OSError(errno.EFBIG, os.strerror(errno.EFBIG), path)
        content = os.read(opened, status.st_size + 1)
        while len(content) < status.st_size and (more := os.read(opened, status.st_size)):
            content += more
    finally:
        os.close(opened)
    return content, status.st_mtime


def write(folder: str, name: str, content: object) -> None:
    """Write a file whole or not at all, over any that is there; links to the folder are followed.

    Raises
    ------
    OSError
        If that is not possible; nothing of it is left then, and no folder that was made for it.
    """
    path = Path(os.path.realpath(folder))
    missing = [each for each in (path, *path.parents) if not each.exists()]
    try:
        with Folder(str(path), make=True) as opened:
            opened.write(name, content)
    except OSError:
        with suppress(OSError):
            for each in missing:
                each.rmdir()
        raise


def why_unchanged(folder: str, error: OSError) -> str:
    """Return why a store cannot be changed: whose folder it is, if that is the reason."""
    reason = error.strerror or str(error)
    if error.errno not in (errno.EACCES, errno.EPERM, errno.EROFS):
        return f"{folder}: {reason}"
    owner = ""
    with suppress(OSError, NotImplementedError):  # a system without owners
        try:
            owner = f"; it belongs to {Path(folder).owner()}"
        except KeyError:  # a user without a name
            owner = f"; it belongs to user {os.stat(folder).st_uid}"
    return f"{folder}: {reason}{owner}; name another folder with --store or NODEGRAPH_STORE"


class Folder:
    """An open folder. Its names mean the same files, whoever renames or links folders meanwhile.

    Parameters
    ----------
    root
        Its path, or that of a folder above it. The last name in it must not be a link.
    *inner
        Names that lead on from there. None of them may be a link.
    make
        Whether to make folders that are not there.

    Attributes
    ----------
    path : str
        For messages and for reading.

    Raises
    ------
    OSError
        If it cannot be opened, or is reached through a link.
    """

    def __init__(self, root: str, *inner: str, make: bool = False) -> None:
        self.path = root
        self._number = self._opened(root, None, make=make)
        for name in inner:
            above, self.path = self._number, f"{self.path}/{name}"
            try:
                self._number = self._opened(name, above, make=make)
            finally:
                if above is not None:
                    os.close(above)
        self._before = f"{self.path}/" if self._number is None else ""

    def __enter__(self) -> Folder:
        return self

    def __exit__(self, *error: object) -> None:
        if self._number is not None:
            os.close(self._number)

    def _opened(self, name: str, above: int | None, *, make: bool) -> int | None:
        """Return the open folder, or None on a system that opens none: paths are used there."""
        try:
            try:
                return _open_folder(name, above, self.path)
            except FileNotFoundError:
                if not make:
                    raise
            if above is None:
                os.makedirs(self.path, exist_ok=True)
            else:
                with suppress(FileExistsError):
                    os.mkdir(name, dir_fd=above)
            return _open_folder(name, above, self.path)
        except OSError as error:
            if os.path.islink(self.path):
                text = f"{self.path} is a symbolic link, which is not followed"
                raise OSError(text) from error
            raise

    def open(self, name: str, flags: int) -> int:
        """Open a file that is not a link, as `os.open` does."""
        flags |= _NO_LINK | getattr(os, "O_BINARY", 0)
        return os.open(f"{self._before}{name}", flags, 0o666, dir_fd=self._number)

    def write(self, name: str, content: Any) -> None:
        """Write a file whole or not at all, over any that is there.

        Raises
        ------
        OSError
            If that is not possible; nothing of it is left then.
        """
        unfinished = f"{_own}-{os.getpid()}-{next(_numbers)}.part"
        try:
            opened = self.open(unfinished, _WRITE)
            try:
                left = memoryview(content)
                while left:
                    left = left[os.write(opened, left) :]
            finally:
                os.close(opened)
            os.replace(
                f"{self._before}{unfinished}",
                f"{self._before}{name}",
                src_dir_fd=self._number,
                dst_dir_fd=self._number,
            )
        except BaseException:
            with suppress(OSError):
                self.remove(unfinished)
            raise

    def status(self, name: str) -> os.stat_result:
        """Return the status of a file."""
        return os.stat(f"{self._before}{name}", dir_fd=self._number, follow_symlinks=False)

    def touch(self, name: str) -> None:
        """Note that a file is used now."""
        path = f"{self._before}{name}"
        os.utime(path, dir_fd=self._number, follow_symlinks=not _DATES_LINKS)

    def remove(self, name: str) -> None:
        """Remove a file, or a link itself."""
        os.unlink(f"{self._before}{name}", dir_fd=self._number)

    def files(self, form: re.Pattern[str]) -> Iterator[tuple[str, os.stat_result]]:
        """Yield name and status of each file in it whose name has a form; links are left out."""
        with os.scandir(self.path if self._number is None else self._number) as items:
            names = [item.name for item in items if form.fullmatch(item.name)]
        for name in names:
            with suppress(FileNotFoundError):  # another program was quicker
                status = self.status(name)
                if stat.S_ISREG(status.st_mode):
                    yield name, status


def _open_folder(name: str, above: int | None, path: str) -> int | None:
    if _OPENS_FOLDERS:
        return os.open(name, os.O_RDONLY | os.O_DIRECTORY | _NO_LINK, dir_fd=above)
    if os.path.islink(path) or not os.path.isdir(path):
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
    return None


def seal(text: str) -> bytes:
    """Return a text after a line with its SHA-256."""
    content = text.encode("ascii")
    return hashlib.sha256(content).hexdigest().encode("ascii") + b"\n" + content


def unseal(content: bytes) -> bytes | None:
    """Return the content that `seal` was given, or None if it has changed."""
    rest = content[65:]
    whole = hashlib.sha256(rest).hexdigest().encode("ascii") == content[:64]
    return rest if whole and content[64:65] == b"\n" else None


def lock(file: IOBase) -> bool:
    """Lock a file for as long as it is open; return False if another program holds it."""
    try:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        return False
    except (ImportError, OSError):
        pass  # this system or this disk has no locks
    return True
