"""Results on disk, found by the keys of the steps that made them.

Each result is one small file, beside files of the arrays' bytes. Several programs may use a folder
at once: every file is written under another name first, so that nobody ever sees half of one.
"""

from __future__ import annotations

import hashlib
import json
import os
import threading
import time
from binascii import a2b_base64, b2a_base64
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from nodegraph.errors import NodegraphError
from nodegraph.formatting import printable
from nodegraph.state import State
from nodegraph.store import files
from nodegraph.store.blobs import Blobs
from nodegraph.store.codec import Packed, Packer, digest_of
from nodegraph.store.errors import UnknownClass, Unreadable, Unstorable

if TYPE_CHECKING:
    from nodegraph.store.arrays import Buffer


FORMAT = "format-2"
ENTRIES = "entries"
_INLINE = 2048
"""Bytes up to which an array lies in the entry itself."""

_encode = json.JSONEncoder(check_circular=False, separators=(",", ":")).encode

_Sum = Annotated[str, Field(pattern="^[0-9a-f]{64}$")]
_Number = Annotated[float, Field(ge=0, allow_inf_nan=False)]
_Part = str | tuple[_Sum, Annotated[int, Field(ge=0)]]


@dataclass(frozen=True, slots=True)
class About:
    """The data kept with a result.

    Attributes
    ----------
    node : str
        The node's name, such as ``fill.muscle``.
    step : str
        The node of a graph, and the combination.
    state : str
        ``done`` or ``refused``.
    reason : str
        Why it was refused.
    warnings : tuple of str
    seconds : float
        Duration of the computation, in seconds.
    """

    node: str
    step: str
    state: str
    reason: str = ""
    warnings: tuple[str, ...] = ()
    seconds: float = 0.0


class Entry(BaseModel):
    """A stored result, without its values: what its file holds.

    Attributes
    ----------
    key : str
    node, step, state, reason : str
    warnings : tuple of str
    seconds : float
        Duration of the computation, in seconds.
    created : float
        When, in seconds since 1970.
    digests : tuple of str
        One per output, of its content.
    faithful : tuple of bool
        One per output: whether it is the value itself, and no stand-in to be shown.
    outputs : list
        The text of each output and where its buffers lie: a text for bytes in base 64, a pair of
        SHA-256 and size for a blob.
    """

    model_config = ConfigDict(strict=True, frozen=True, defer_build=True)

    key: _Sum
    node: str
    step: str
    state: Annotated[str, Field(pattern="^(done|refused)$")]
    reason: str
    warnings: tuple[str, ...]
    seconds: _Number
    created: _Number
    digests: tuple[_Sum, ...]
    faithful: tuple[bool, ...]
    outputs: list[tuple[_Part, list[_Part]]]
    _length: int = 0

    @model_validator(mode="after")
    def _check_outputs(self) -> Entry:
        if not len(self.outputs) == len(self.digests) == len(self.faithful):
            raise ValueError("each output has a digest, and is faithful or not")
        if self.outputs and self.state != State.DONE:
            raise ValueError("what was refused has no output")
        return self

    @property
    def length(self) -> int:
        """Bytes of its own file."""
        return self._length

    @property
    def size(self) -> int:
        """Size in bytes, with all arrays."""
        return self._length + sum(self.blobs().values())

    def blobs(self) -> dict[str, int]:
        """Return name and size of each blob that the entry needs."""
        parts = (part for head, buffers in self.outputs for part in (head, *buffers))
        return dict(part for part in parts if not isinstance(part, str))


def entry_of(key: str, about: About, packed: Sequence[Packed], blobs: Blobs) -> tuple[Entry, bytes]:
    """Write the blobs of a result; return its entry and the content of the entry's file.

    Raises
    ------
    OSError
        If a blob cannot be written.
    """
    entry = Entry(
        key=key,
        node=about.node,
        step=printable(about.step),
        state=about.state,
        reason=printable(about.reason),
        warnings=tuple(map(printable, about.warnings)),
        seconds=about.seconds,
        created=time.time(),
        digests=tuple(output.digest for output in packed),
        faithful=tuple(output.faithful for output in packed),
        outputs=[(_head(output.head, blobs), _buffers(output, blobs)) for output in packed],
    )
    content = files.seal(_encode(entry.model_dump()))
    entry._length = len(content)
    return entry, content


def read_entry(content: bytes, key: str, outputs: int | None = None) -> Entry | None:
    """Return the entry in a file's content, or None if it is damaged.

    Parameters
    ----------
    content
    key
        An entry of another key is damaged.
    outputs
        How many values a result has; an entry with another number of them is damaged.
    """
    text = files.unseal(content)
    if text is None:
        return None
    try:
        entry = Entry.model_validate_json(text)
    except ValidationError:
        return None
    if entry.key != key:
        return None
    if outputs is not None and entry.state == State.DONE and len(entry.outputs) != outputs:
        return None
    entry._length = len(content)
    return entry


def packed_parts(entry: Entry, blobs: Blobs) -> Iterator[tuple[str, list[Buffer]]]:
    """Yield the text and the buffers of each output; equal buffers are one.

    Raises
    ------
    Unreadable
        If a blob is not what it was, or an output is not what its digest says.
    """
    # each blob once, and all of them before anything is unpacked: a result is read whole or not
    known = {name: blobs.get(name, size) for name, size in entry.blobs().items()}
    for (part, parts), digest in zip(entry.outputs, entry.digests, strict=True):
        buffers: list[Buffer] = []
        sums: list[str] = []
        try:
            head = part if isinstance(part, str) else bytes(known[part[0]]).decode("ascii")
            for stored in parts:
                if isinstance(stored, str):
                    content = a2b_base64(stored, strict_mode=True)
                    buffers.append(content)
                    sums.append(_sum(content))
                else:
                    buffers.append(known[stored[0]])
                    sums.append(stored[0])
            whole = digest_of(head, sums) == digest
        except ValueError as error:
            raise Unreadable(f"an output is not text: {error}") from error
        if not whole:
            raise Unreadable("an output is not what its digest says")
        yield head, buffers


def _head(head: str, blobs: Blobs) -> _Part:
    if len(head) <= _INLINE:
        return head
    content = head.encode("ascii")
    name = _sum(content)
    blobs.put(name, content)
    return name, len(content)


def _buffers(packed: Packed, blobs: Blobs) -> list[_Part]:
    parts: list[_Part] = []
    for number, buffer in enumerate(packed.buffers):
        if len(buffer) <= _INLINE:
            parts.append(b2a_base64(buffer, newline=False).decode("ascii"))
        else:
            blobs.put(packed.sums[number], buffer)
            parts.append((packed.sums[number], len(buffer)))
    return parts


def _sum(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()


_HOUR = 3600.0
_LONGEST = 500
"""Characters of a reason, which may quote what an entry holds."""
_README = """\
Results that nodegraph has stored. Any of it may be removed: it is computed again when it is needed.
`nodegraph cache` shows how much there is, `nodegraph cache prune` removes what was long unused.
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
    saved : int
        How many results were stored.
    say
    """

    def __init__(self, folder: Path, packer: Packer, say: Callable[[str], None]) -> None:
        self.folder = folder.absolute()
        self.packer = packer
        self.writable = True
        self.unstorable: Counter[str] = Counter()
        self.saved = 0
        self.say = say
        self._lock = threading.Lock()
        self._reported: set[str] = set()
        self._root = str(self.folder / FORMAT)
        self._blobs = Blobs(self._root)
        self._make()

    def find(self, key: str, *, outputs: int | None = None) -> Entry | None:
        """Return the entry under a key, without its values.

        A damaged entry is removed, reported, and not found.

        Parameters
        ----------
        key
        outputs
            How many the node has; an entry with another number of values is damaged.
        """
        try:
            content, changed = files.read(self._path(key))
        except (FileNotFoundError, NotADirectoryError):
            return None
        except OSError as error:
            self._tell(f"stored results cannot be read: {self.folder}: {error.strerror or error}")
            return None
        entry = read_entry(content, key, outputs)
        if entry is None:
            self._remove_damaged(key, "a stored result is damaged")
        elif time.time() - changed > _HOUR:
            # the time of its last use, by which pruning chooses; to the hour is enough
            with suppress(OSError), self._folder() as folder:
                folder.touch(_name(key))
        return entry

    def load(self, entry: Entry, types: Iterable[type] = ()) -> tuple[Any, ...]:
        """Return the values of an entry; their arrays are read-only.

        Parameters
        ----------
        entry
        types
            The types of the node's outputs; a value of another type is damaged, unless it is a
            stand-in.

        Raises
        ------
        DamagedEntry
            If they are not what was written. The entry is removed, unless its class is not here.
        """
        try:
            values = tuple(self._values(entry))
            for value, faithful, kind in zip(values, entry.faithful, types, strict=False):
                if faithful and not isinstance(value, kind):
                    raise Unreadable(f"it is {type(value).__name__}, not {kind.__name__}")
            return values
        except Unreadable as error:
            why = str(error)[:_LONGEST]
            text = f"the stored result of {entry.step} ({entry.node}) cannot be used: {why}"
            if isinstance(error, UnknownClass):
                self._tell(
                    f"{text}; it may need --plugin FILE, without which it is computed again: "
                    f"{self._path(entry.key)}"
                )
            else:
                self._remove_damaged(entry.key, text)
            raise DamagedEntry(f"{text}; entry {entry.key}") from error

    def packed(self, entry: Entry) -> tuple[Packed, ...]:
        """Return the values of an entry as they are stored, which need not be put together.

        Raises
        ------
        Unreadable
            If they are not what was written. The entry stays.
        """
        parts: Iterator[tuple[str, list[Any]]] = packed_parts(entry, self._blobs)
        return tuple(
            Packed(head, tuple(map(memoryview, buffers)), faithful)
            for (head, buffers), faithful in zip(parts, entry.faithful, strict=True)
        )

    def save(self, key: str, about: About, values: tuple[object, ...]) -> Entry | None:
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
            # last: whoever finds the entry finds all blobs that it names
            with self._folder(make=True) as folder:
                folder.write(_name(key), content)
        except Unstorable as error:
            with self._lock:
                self.unstorable[error.kind] += 1
            return None
        except OSError as error:
            self._give_up(error)
            return None
        with self._lock:
            self.saved += 1
        return entry

    def remember(self, name: str, data: Mapping[str, object]) -> None:
        """Keep a mapping of plain data, in place of what was kept under that name."""
        if self.writable:
            try:
                with files.Folder(self._root, make=True) as folder:
                    folder.write(f"{name}.json", files.seal(json.dumps(data)))
            except OSError as error:
                self._give_up(error)

    def recall(self, name: str) -> dict[str, Any]:
        """Return the data that `remember` kept last; empty if it is damaged."""
        try:
            text = files.unseal(files.read(f"{self._root}/{name}.json")[0])
            value = json.loads(text) if text is not None else {}
        except (OSError, ValueError, RecursionError):
            return {}
        return value if isinstance(value, dict) else {}

    def _values(self, entry: Entry) -> Iterator[object]:
        parts = packed_parts(entry, self._blobs)
        for (head, buffers), faithful in zip(parts, entry.faithful, strict=True):
            yield self.packer.unpack(head, buffers, stand_ins=not faithful)

    def _make(self) -> None:
        if os.path.isdir(self._root):
            return
        try:
            with files.Folder(self._root, make=True) as folder:
                folder.write("README", _README.encode())
        except OSError as error:
            self._give_up(error)
            return
        if others := other_formats(self.folder):
            self.say(
                f"results that another version of nodegraph has stored are not used, and stay: "
                f"{', '.join(f'{self.folder / name}' for name in others)}"
            )

    def _give_up(self, error: OSError) -> None:
        with self._lock:
            if not self.writable:
                return
            self.writable = False
        self.say(f"results are no longer kept: {files.why_unchanged(str(self.folder), error)}")

    def _path(self, key: str) -> str:
        return f"{self._root}/{ENTRIES}/{_name(key)}"

    def _folder(self, *, make: bool = False) -> files.Folder:
        return files.Folder(self._root, ENTRIES, make=make)

    def _remove_damaged(self, key: str, text: str) -> None:
        with suppress(OSError), self._folder() as folder:
            folder.remove(_name(key))
        self._tell(f"{text}, and is computed again when it is needed: {self._path(key)}")

    def _tell(self, text: str) -> None:
        with self._lock:
            if text in self._reported:
                return
            self._reported.add(text)
        self.say(text)


def _name(key: str) -> str:
    """Return the name of an entry's file."""
    return f"{key}.json"


def other_formats(folder: Path) -> list[str]:
    """Return names of folders of other versions of this program, which are left alone."""
    return sorted(path.name for path in folder.glob("format-*") if path.name != FORMAT)


VARIABLE = "NODEGRAPH_STORE"


def store_folder(folder: Path | None = None) -> Path:
    """Return the folder of the store: the given one, else NODEGRAPH_STORE, else the platform's."""
    if folder is not None:
        return folder
    if named := os.environ.get(VARIABLE):
        return Path(named).expanduser()
    from platformdirs import user_cache_path

    return user_cache_path("nodegraph") / "store"
