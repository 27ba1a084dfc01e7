"""Results on disk, found by the keys of the steps that made them.

Each result is one small file, beside files of the arrays' bytes. Several programs may use a folder
at once: every file is written under another name first, so that nobody ever sees half of one.
"""

from __future__ import annotations

import base64
import hashlib
import json
import os
import threading
import time
from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph.errors import NodegraphError
from nodegraph.store import files
from nodegraph.store.codec import Packed, Packer, Unreadable, Unstorable
from nodegraph.store.files import Blobs

if TYPE_CHECKING:
    from nodegraph.store.codec import Buffer


_INLINE = 2048
"""Bytes up to which an array lies in the entry itself."""

_encode = json.JSONEncoder(check_circular=False, separators=(",", ":")).encode


@dataclass(frozen=True, slots=True)
class About:
    """What is kept with a result.

    Attributes
    ----------
    node : str
        The node's name, such as ``fill.muscle``.
    step : str
        Which node of a graph, and which combination.
    state : str
        ``done`` or ``refused``.
    reason : str
        Why it was refused.
    warnings : tuple of str
    seconds : float
        That it took to compute.
    """

    node: str
    step: str
    state: str
    reason: str = ""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0


@dataclass(frozen=True, slots=True)
class Entry:
    """A stored result, without its values.

    Attributes
    ----------
    key : str
    node, step, state, reason : str
    warnings : tuple of str
    seconds : float
        That it took to compute.
    created : float
        When, in seconds since 1970.
    digests : tuple of str
        One per output, of its content.
    faithful : tuple of bool
        One per output: whether it is the value itself, and no stand-in to be shown.
    size : int
        In bytes, with all arrays.
    outputs : list
        Of each output its text and where its buffers lie: a text for bytes in base 64, a pair of
        SHA-256 and size for a blob.
    """

    key: str
    node: str
    step: str
    state: str
    reason: str
    warnings: tuple[str, ...]
    seconds: float
    created: float
    digests: tuple[str, ...]
    faithful: tuple[bool, ...]
    size: int
    outputs: list[tuple[Any, list[Any]]]

    def blobs(self) -> dict[str, int]:
        """Return name and size of each blob that the entry needs."""
        return _blobs(self.outputs)


def entry_of(key: str, about: About, packed: Sequence[Packed], blobs: Blobs) -> tuple[Entry, bytes]:
    """Write the blobs of a result; return its entry and the content of the entry's file.

    Raises
    ------
    OSError
        If a blob cannot be written.
    """
    outputs = [[_head(one.head, blobs), _buffers(one, blobs)] for one in packed]
    said = {
        "key": key,
        "node": about.node,
        "step": about.step,
        "state": about.state,
        "reason": about.reason,
        "warnings": list(about.warnings),
        "seconds": about.seconds,
        "created": time.time(),
        "digests": [one.digest for one in packed],
        "faithful": [one.faithful for one in packed],
        "beside": sum(_blobs(outputs).values()),
        "outputs": outputs,
    }
    content = files.seal(_encode(said))
    return _entry(said, len(content)), content


def read_entry(content: bytes, key: str = "") -> Entry | None:
    """Return the entry in a file's content, or None if it is damaged or another key's."""
    text = files.unseal(content)
    if text is None:
        return None
    said = json.loads(text)
    return _entry(said, len(content)) if said["key"] == key or not key else None


def packed_parts(entry: Entry, blobs: Blobs) -> list[tuple[str, list[Buffer]]]:
    """Return the text and the buffers of each output; equal buffers are one.

    Raises
    ------
    Unreadable
        If a blob is not what it was.
    """
    found = {name: blobs.get(name, size) for name, size in entry.blobs().items()}
    parts = []
    for head, buffers in entry.outputs:
        text = head if isinstance(head, str) else bytes(found[head[0]]).decode("ascii")
        parts.append((text, [_buffer(one, found) for one in buffers]))
    return parts


def _entry(said: dict[str, Any], size: int) -> Entry:
    return Entry(
        said["key"],
        said["node"],
        said["step"],
        said["state"],
        said["reason"],
        tuple(said["warnings"]),
        said["seconds"],
        said["created"],
        tuple(said["digests"]),
        tuple(said["faithful"]),
        size + said["beside"],
        said["outputs"],
    )


def _blobs(outputs: Iterable[Any]) -> dict[str, int]:
    parts = (part for head, buffers in outputs for part in (head, *buffers))
    return {part[0]: part[1] for part in parts if isinstance(part, list)}


def _head(head: str, blobs: Blobs) -> Any:
    if len(head) <= _INLINE:
        return head
    content = head.encode("ascii")
    name = hashlib.sha256(content).hexdigest()
    blobs.put(name, content)
    return [name, len(content)]


def _buffers(packed: Packed, blobs: Blobs) -> list[Any]:
    kept: list[Any] = []
    for number, buffer in enumerate(packed.buffers):
        if len(buffer) <= _INLINE:
            kept.append(base64.b64encode(buffer).decode("ascii"))
        else:
            blobs.put(packed.sums[number], buffer)
            kept.append([packed.sums[number], len(buffer)])
    return kept


def _buffer(part: Any, found: dict[str, Any]) -> Any:
    return base64.b64decode(part) if isinstance(part, str) else found[part[0]]


_HOUR = 3600.0
_README = """\
Results that nodegraph has stored. Any of it may be removed: it is computed again when it is needed.
`nodegraph cache` tells how much there is, `nodegraph cache prune` removes what was long unused.
"""


class DamagedEntry(NodegraphError):
    """A stored result is not what was written; it has been removed."""


class Store:
    """A folder of stored results. Every method may be called in any thread.

    Parameters
    ----------
    folder
        Made if it is not there.
    packer
        Takes values apart and puts them together.
    say
        Called with a line when something is damaged, or nothing can be kept any more.

    Attributes
    ----------
    writable : bool
        False once anything could not be written; nothing is tried any more then.
    unstorable : Counter of str
        Types whose values could not be kept, and how many results that has cost.
    """

    def __init__(self, folder: Path, packer: Packer, say: Callable[[str], None]) -> None:
        self.folder = folder.absolute()
        self.packer = packer
        self.writable = True
        self.unstorable: Counter[str] = Counter()
        self._say = say
        self._lock = threading.Lock()
        self._told: set[str] = set()
        self._root = str(self.folder / files.FORMAT)
        self._entries = f"{self._root}/entries"
        self._blobs = Blobs(f"{self._root}/blobs")
        self._make()

    def find(self, key: str) -> Entry | None:
        """Return what is stored under a key, without its values.

        A damaged entry is removed, told, and not found.
        """
        path = f"{self._entries}/{key[:2]}/{key[2:]}.json"
        try:
            content, changed = files.read(path)
            entry = read_entry(content, key)
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            self._tell(f"stored results cannot be read: {self.folder}: {error.strerror}")
            return None
        except (ValueError, LookupError, TypeError):
            entry = None
        if entry is None:
            self._remove_damaged(path, "a stored result is damaged")
        elif time.time() - changed > _HOUR:
            with suppress(OSError):
                os.utime(path)
        return entry

    def load(self, entry: Entry) -> tuple[Any, ...]:
        """Return the values of an entry; their arrays are read-only.

        Raises
        ------
        DamagedEntry
            If they are not what was written. The entry is removed.
        """
        try:
            parts = packed_parts(entry, self._blobs)
            return tuple(self.packer.unpack(head, buffers) for head, buffers in parts)
        except Unreadable as error:
            path = f"{self._entries}/{entry.key[:2]}/{entry.key[2:]}.json"
            text = f"the stored result of {entry.step} ({entry.node}) cannot be used: {error}"
            self._remove_damaged(path, text)
            raise DamagedEntry(f"{text}; entry {entry.key}") from error

    def save(self, key: str, about: About, values: tuple[Any, ...]) -> Entry | None:
        """Store a result and return its entry, or None when it cannot be kept.

        Parameters
        ----------
        key
        about
        values
            One per output; none for a result that was refused.
        """
        if not self.writable:
            return None
        try:
            packed = [self.packer.pack(value) for value in values]
            entry, content = entry_of(key, about, packed, self._blobs)
            files.write(f"{self._entries}/{key[:2]}", f"{key[2:]}.json", content)
        except Unstorable as error:
            with self._lock:
                self.unstorable[error.kind] += 1
            return None
        except OSError as error:
            self._give_up(error)
            return None
        return entry

    def remember(self, name: str, data: Mapping[str, Any]) -> None:
        """Keep a mapping of plain data, in place of what was kept under that name."""
        if self.writable:
            try:
                files.write(self._root, f"{name}.json", files.seal(json.dumps(data)))
            except OSError as error:
                self._give_up(error)

    def recall(self, name: str) -> dict[str, Any]:
        """Return what `remember` kept last; nothing if that is damaged."""
        try:
            text = files.unseal(files.read(f"{self._root}/{name}.json")[0])
            found = json.loads(text) if text is not None else {}
        except (OSError, ValueError):
            return {}
        return found if isinstance(found, dict) else {}

    def _make(self) -> None:
        if os.path.isdir(self._root):
            return
        try:
            files.write(self._root, "README", _README.encode())
        except OSError as error:
            self._give_up(error)

    def _give_up(self, error: OSError) -> None:
        with self._lock:
            if not self.writable:
                return
            self.writable = False
        self._say(f"results are no longer kept: {self.folder}: {error.strerror or error}")

    def _remove_damaged(self, path: str, text: str) -> None:
        with suppress(OSError):
            os.unlink(path)
        self._tell(f"{text}, and is computed again when it is needed: {path}")

    def _tell(self, text: str) -> None:
        with self._lock:
            if text in self._told:
                return
            self._told.add(text)
        self._say(text)


VARIABLE = "NODEGRAPH_STORE"


def store_folder(given: Path | None = None) -> Path:
    """Return the folder of the store: the given one, else NODEGRAPH_STORE, else the platform's."""
    if given is not None:
        return given
    if named := os.environ.get(VARIABLE):
        return Path(named).expanduser()
    from platformdirs import user_cache_path

    return user_cache_path("nodegraph") / "store"
