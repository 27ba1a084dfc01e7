"""What is stored of one step: a small file that says all of it but large arrays."""

from __future__ import annotations

import base64
import hashlib
import json
import time
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from nodegraph.store import files
from nodegraph.store.packing import Packed

if TYPE_CHECKING:
    from nodegraph.store.arrays import Buffer
    from nodegraph.store.blobs import Blobs

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
