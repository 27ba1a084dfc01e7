"""The messages between a run and its workers: short texts, and buffers that are not copied."""

from __future__ import annotations

import atexit
import json
import platform
import shutil
import struct
import sys
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from enum import StrEnum
from io import BufferedReader, BufferedWriter
from pathlib import Path

import numpy as np

from nodegraph.cache_key import Code
from nodegraph.execute.call import Call, Outcome
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registry
from nodegraph.state import State

Frame = bytes | memoryview

_COUNT = struct.Struct("<I")


def write_frames(stream: BufferedWriter, frames: Sequence[Frame]) -> None:
    """Write a list of buffers; large ones are not copied."""
    sizes = [len(frame) for frame in frames]
    stream.write(_COUNT.pack(len(frames)) + struct.pack(f"<{len(frames)}Q", *sizes))
    for frame in frames:
        stream.write(frame)
    stream.flush()


def read_frames(stream: BufferedReader) -> list[Frame]:
    """Read a list of buffers.

    Raises
    ------
    EOFError
        If the stream ends before the list does.
    """
    (count,) = _COUNT.unpack(_read(stream, _COUNT.size))
    sizes = struct.unpack(f"<{count}Q", _read(stream, 8 * count))
    return [_read(stream, size) for size in sizes]


def _read(stream: BufferedReader, size: int) -> memoryview:
    # not a bytearray, which would be filled with zeros first
    buffer = np.empty(size, np.uint8).data
    rest = buffer
    while rest.nbytes:
        count = stream.readinto(rest)
        if not count:
            raise EOFError
        rest = rest[count:]
    return buffer.toreadonly()


@dataclass(frozen=True)
class Request:
    """A call to be made by a worker.

    Attributes
    ----------
    environment, address : bytes
        As `Environment` and `NodeAddress` encode them.
    head : bytes
        Inputs and settings, packed.
    buffers : sequence of buffer
    """

    environment: bytes
    address: bytes
    head: bytes
    buffers: Sequence[Frame] = ()

    def frames(self) -> list[Frame]:
        """Return the request as a list of buffers."""
        return [self.environment, self.address, self.head, *self.buffers]

    @classmethod
    def from_frames(cls, frames: Sequence[Frame]) -> Request:
        """Return a request from the list of buffers that `frames` returned."""
        return cls(bytes(frames[0]), bytes(frames[1]), bytes(frames[2]), frames[3:])


class ResponseKind(StrEnum):
    """The response of a worker to a request.

    ``missing``: it does not have the node; ``unsendable``: a value cannot be sent.
    """

    OUTCOME = "outcome"
    MISSING = "missing"
    UNSENDABLE = "unsendable"


@dataclass(frozen=True)
class Response:
    """A worker's response to a request.

    Attributes
    ----------
    kind : ResponseKind
    outcome : Outcome
        Without values; unless there is an outcome, its reason says why.
    differences : str
        Versions of the worker that are not those of the process that sent the request.
    head : bytes
        The values, packed.
    buffers : sequence of buffer
    """

    kind: ResponseKind
    outcome: Outcome
    differences: str = ""
    head: bytes = b"null"
    buffers: Sequence[Frame] = ()

    def frames(self) -> list[Frame]:
        """Return the response as a list of buffers."""
        text = json.dumps([self.kind, asdict(self.outcome), self.differences])
        return [text.encode(), self.head, *self.buffers]

    @classmethod
    def from_frames(cls, frames: Sequence[Frame]) -> Response:
        """Return a response from the list of buffers that `frames` returned."""
        kind, fields, differences = json.loads(bytes(frames[0]))
        fields |= {
            "state": State(fields["state"]),
            "values": (),
            "warnings": tuple(fields["warnings"]),
            "digests": (),
            "undeclared_reads": tuple(fields["undeclared_reads"]),
        }
        return cls(ResponseKind(kind), Outcome(**fields), differences, bytes(frames[1]), frames[2:])


@dataclass(frozen=True)
class NodeAddress:
    """The address of a node for a worker.

    Attributes
    ----------
    plugin, node : str
    distribution : str
        Name and version of the package that the plugin is from; empty for a file.
    module, qualname : str
        Where the function is defined, for a node of no plugin.
    code : mapping of module to digest
        Of all that the node reaches; empty for workers that start after this process.
    """

    plugin: str
    node: str
    distribution: str
    module: str
    qualname: str
    code: Mapping[str, str] = field(default_factory=dict)

    @classmethod
    def of(cls, call: Call, registry: Registry, code: Code | None) -> NodeAddress | None:
        """Return the address of the node of a call, or None if no other process can find it."""
        if type(call.node) is not Node or call.plugin == "nodegraph":
            return None  # it exists in this graph only
        function = call.node.function
        distributions = {plugin.name: plugin.distribution for plugin in registry.loaded}
        if call.plugin not in distributions and not _is_importable(function):
            return None
        distribution = distributions.get(call.plugin, "")
        module, qualname = function.__module__, function.__qualname__
        units = code.of(function).units if code is not None else {}
        return cls(call.plugin, call.node.name, distribution, module, qualname, units)

    def encode(self) -> bytes:
        """Return the address as JSON."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def decode(cls, text: bytes) -> NodeAddress:
        """Return the address that `encode` returned as JSON."""
        return cls(**json.loads(text))


def _is_importable(function: Callable[..., object]) -> bool:
    """Whether the function is the object of its name in a module that others can import."""
    if function.__module__ == "__main__":
        return False
    value: object = sys.modules.get(function.__module__)
    for part in function.__qualname__.split("."):
        value = getattr(value, part, None)
    return value is function


@dataclass(frozen=True)
class Environment:
    """The environment of the process that sends requests, on which results depend.

    Attributes
    ----------
    files : tuple of (path, content)
        Plugin files that the user named. Their content is sent, because a worker on another
        machine may not have them, or may have imported an earlier version.
    python, numpy : str
        Versions, because results may differ in their last bits between them.
    """

    files: tuple[tuple[str, bytes], ...] = ()
    python: str = ".".join(platform.python_version_tuple()[:2])
    numpy: str = np.__version__

    @classmethod
    def of(cls, registry: Registry) -> Environment:
        """Return the environment of this process, with the plugins of a registry."""
        files = [Path(p.module.__file__) for p in registry.loaded if not p.distribution]
        return cls(tuple((str(path), path.read_bytes()) for path in files))

    def encode(self) -> bytes:
        """Return the environment as JSON."""
        files = [(path, content.decode("latin-1")) for path, content in self.files]
        return json.dumps([files, self.python, self.numpy]).encode()

    @classmethod
    def decode(cls, text: bytes) -> Environment:
        """Return the environment that `encode` returned as JSON."""
        files, python, numpy = json.loads(text)
        contents = tuple((path, content.encode("latin-1")) for path, content in files)
        return cls(contents, python, numpy)

    def differences(self, worker: Environment) -> Iterator[str]:
        """Yield which versions a worker has that are not those of this environment."""
        if worker.python != self.python:
            yield f"Python {worker.python}, here it is {self.python}"
        if worker.numpy != self.numpy:
            yield f"numpy {worker.numpy}, here it is {self.numpy}"

    def plugin_files(self) -> list[Path]:
        """Return the paths of the plugin files, or of copies if these are not the same here."""
        return [_same_file(Path(path), content) for path, content in self.files]


def _same_file(path: Path, content: bytes) -> Path:
    try:
        if path.read_bytes() == content:
            return path
    except OSError:
        pass
    folder = Path(tempfile.mkdtemp(prefix="nodegraph-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    copy = folder / path.name
    copy.write_bytes(content)
    return copy
