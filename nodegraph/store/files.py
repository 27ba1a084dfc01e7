"""Small and large files, read in one go and written whole or not at all.

Paths are texts here, and calls go to the system directly: a result is looked up in some
microseconds, of which paths as objects would take most.
"""

from __future__ import annotations

import errno
import hashlib
import itertools
import os
import secrets
import stat
from collections.abc import Iterable
from contextlib import suppress
from io import IOBase
from typing import TYPE_CHECKING, Any

from nodegraph.store.codec import Unreadable

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray


FORMAT = "format-1"
UNFINISHED = ".part"
_PIECE = 2**20
# without waiting: a pipe in place of a file is empty
_READ = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0)
_LONGEST = 2**28
_WRITE = os.O_WRONLY | os.O_CREAT | os.O_EXCL | getattr(os, "O_BINARY", 0)
_own = secrets.token_hex(4)
_numbers = itertools.count()


def read(path: str) -> tuple[bytes, float]:
    """Return the content of a small file, and when it was last changed.

    Raises
    ------
    OSError
        If it cannot be read, or is far from small.
    """
    opened = os.open(path, _READ)
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
    """Write a file whole or not at all, over any that is there.

    Raises
    ------
    OSError
        If that is not possible; nothing of it is left then.
    """
    write_parts(folder, name, (content,))


def write_parts(folder: str, name: str, parts: Iterable[object], *, durable: bool = False) -> None:
    """Write a file, part after part, as `write` does.

    Parameters
    ----------
    folder, name, parts
    durable
        Whether to return only when it would outlast a loss of power.

    Raises
    ------
    OSError
        If that is not possible; nothing of it is left then.
    """
    unfinished = f"{folder}/{_own}-{os.getpid()}-{next(_numbers)}{UNFINISHED}"
    try:
        opened = os.open(unfinished, _WRITE, 0o666)
    except FileNotFoundError:
        os.makedirs(folder, exist_ok=True)
        opened = os.open(unfinished, _WRITE, 0o666)
    try:
        try:
            for part in parts:
                _write_all(opened, part)
            if durable:
                os.fsync(opened)
        finally:
            os.close(opened)
        os.replace(unfinished, f"{folder}/{name}")
        if durable:
            _sync_folder(folder)
    except BaseException:
        with suppress(OSError):
            os.unlink(unfinished)
        raise


def read_checked(path: str, size: int, wanted: str) -> NDArray[np.uint8] | None:
    """Return the content of a file as memory that nobody can write to, or None.

    None says that it is not of that size, or its SHA-256 is another.
    """
    import numpy as np

    summed = hashlib.sha256()
    with open(os.open(path, _READ), "rb", buffering=0) as opened:
        if os.fstat(opened.fileno()).st_size != size:
            return None
        memory = np.empty(size, np.uint8)
        pieces = memory.data
        filled = 0
        while got := opened.readinto(pieces[filled : filled + _PIECE]):
            # what has just been read is still close to the processor
            summed.update(pieces[filled : filled + got])
            filled += got
    memory.flags.writeable = False
    return memory if filled == size and summed.hexdigest() == wanted else None


def is_whole(path: str, name: str) -> bool:
    """Return whether the SHA-256 of a file's content is its name; a device or a pipe is not."""
    with open(os.open(path, _READ), "rb") as opened:
        if not stat.S_ISREG(os.fstat(opened.fileno()).st_mode):
            return False
        return hashlib.file_digest(opened, "sha256").hexdigest() == name


def seal(text: str) -> bytes:
    """Return a text after a line with its SHA-256."""
    content = text.encode("ascii")
    return hashlib.sha256(content).hexdigest().encode("ascii") + b"\n" + content


def unseal(content: bytes) -> bytes | None:
    """Return the content that `seal` was given, or None if it has changed."""
    rest = content[65:]
    whole = hashlib.sha256(rest).hexdigest().encode("ascii") == content[:64]
    return rest if whole and content[64:65] == b"\n" else None


def _sync_folder(folder: str) -> None:
    with suppress(OSError):  # not every system opens folders
        opened = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(opened)
        finally:
            os.close(opened)


def locked(file: IOBase, *, wait: bool = False) -> bool:
    """Lock a file for as long as it is open; return False if another program holds it.

    Parameters
    ----------
    file
    wait
        Whether to wait until no other program holds it.
    """
    try:
        import fcntl

        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
    except BlockingIOError:
        return False
    except (ImportError, OSError):
        pass  # this system or this disk has no locks
    return True


def folders_in(folder: str) -> list[os.DirEntry[str]]:
    """Return the folders that lie in one; none if it is not there."""
    return [item for item in _inside(folder) if item.is_dir(follow_symlinks=False)]


def files_in(folder: str) -> list[os.DirEntry[str]]:
    """Return the files that lie in one folder; none if it is not there."""
    return [item for item in _inside(folder) if item.is_file(follow_symlinks=False)]


def size_of(item: os.DirEntry[str]) -> int:
    """Return the bytes of a file; 0 for one that is gone."""
    try:
        return item.stat(follow_symlinks=False).st_size
    except FileNotFoundError:
        return 0


def _inside(folder: str) -> list[os.DirEntry[str]]:
    try:
        with os.scandir(folder) as items:
            return list(items)
    except (FileNotFoundError, NotADirectoryError):
        return []


def _write_all(opened: int, content: Any) -> None:
    left = memoryview(content)
    while left:
        left = left[os.write(opened, left) :]


class Blobs:
    """A folder of such files."""

    def __init__(self, folder: str) -> None:
        self.folder = folder

    def put(self, name: str, content: memoryview | bytes) -> None:
        """Keep bytes under their SHA-256.

        Raises
        ------
        OSError
            If that is not possible.
        """
        if self._there(name, len(content)):
            return
        write(f"{self.folder}/{name[:2]}", name[2:], content)

    def get(self, name: str, size: int) -> NDArray[np.uint8]:
        """Return the bytes in memory that nobody can write to.

        Raises
        ------
        Unreadable
            If they are not there, or not what they were, for which they are removed; or if there
            are more or fewer.
        """
        path = self.path(name)
        try:
            content = read_checked(path, size, name)
        except OSError as error:
            raise Unreadable(f"{path}: {error.strerror}") from error
        if content is None:
            with suppress(OSError):
                # what is whole, and of another size than an entry says, is of use to others
                if not is_whole(path, name):
                    os.unlink(path)
            raise Unreadable(f"{path} is not what was written")
        return content

    def path(self, name: str) -> str:
        """Return the address of bytes in memory."""
        return f"{self.folder}/{name[:2]}/{name[2:]}"

    def _there(self, name: str, size: int) -> bool:
        path = self.path(name)
        try:
            if os.stat(path).st_size != size:
                return False
            # so that nobody takes it for one that no entry needs, before the entry is written
            os.utime(path)
        except FileNotFoundError:
            return False
        except PermissionError:
            return True
        return True
