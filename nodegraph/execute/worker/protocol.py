"""What goes to another process and what comes back: short texts, and buffers as they lie."""

from __future__ import annotations

import atexit
import hashlib
import json
import platform
import re
import shutil
import struct
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from io import BufferedReader, BufferedWriter
from pathlib import Path
from typing import Any

import numpy
import numpy as np

from nodegraph.execute.call import Call, Outcome
from nodegraph.node.decorator import Node
from nodegraph.plugin.registry import Registry
from nodegraph.state import State

Frame = bytes | memoryview

_COUNT = struct.Struct("<I")


def write_frames(stream: BufferedWriter, frames: Sequence[Frame]) -> None:
    """Write a list of bytes; large ones are not copied."""
    sizes = [len(one) for one in frames]
    stream.write(_COUNT.pack(len(frames)) + struct.pack(f"<{len(frames)}Q", *sizes))
    for one in frames:
        stream.write(one)
    stream.flush()


def read_frames(stream: BufferedReader) -> list[Frame]:
    """Read a list of bytes.

    Raises
    ------
    EOFError
        If the other side is gone.
    """
    (count,) = _COUNT.unpack(_read(stream, _COUNT.size))
    sizes = struct.unpack(f"<{count}Q", _read(stream, 8 * count))
    return [_read(stream, size) for size in sizes]


def _read(stream: BufferedReader, size: int) -> memoryview:
    # not a bytearray, which would be filled with zeros first
    buffer = np.empty(size, np.uint8).data
    rest = buffer
    while rest.nbytes:
        got = stream.readinto(rest)
        if not got:
            raise EOFError
        rest = rest[got:]
    return buffer.toreadonly()


OUTCOME = "outcome"
LACKING = "lacking"
NOT_SENT = "not sent"
INTERRUPTED = "interrupted"


@dataclass(frozen=True)
class Question:
    """A call to be made in another process.

    Attributes
    ----------
    surroundings, address : bytes
        As `Surroundings` and `Address` make them.
    head : bytes
        Inputs and settings, packed.
    buffers : sequence of buffer
    """

    surroundings: bytes
    address: bytes
    head: bytes
    buffers: Sequence[Frame] = ()

    def frames(self) -> list[Frame]:
        """Return it as a list of bytes, buffers last."""
        return [self.surroundings, self.address, self.head, *self.buffers]

    @classmethod
    def from_frames(cls, frames: Sequence[Frame]) -> Question:
        """Return what `frames` made a list of."""
        return cls(bytes(frames[0]), bytes(frames[1]), bytes(frames[2]), frames[3:])


@dataclass(frozen=True)
class Answer:
    """What another process made of a question.

    Attributes
    ----------
    kind : str
        ``outcome``; ``lacking`` when the process lacks the node; ``not sent`` when a value does
        not travel; ``interrupted`` when the node asked for the end of the run.
    outcome : Outcome
        Without values; its reason says why there is none.
    differs : str
        Versions that the process has, where they are not those of the one that asked.
    head : bytes
        The values, packed.
    buffers : sequence of buffer
    """

    kind: str
    outcome: Outcome
    differs: str = ""
    head: bytes = b"null"
    buffers: Sequence[Frame] = ()

    def frames(self) -> list[Frame]:
        """Return it as a list of bytes, buffers last."""
        said = json.dumps([self.kind, asdict(self.outcome), self.differs]).encode()
        return [said, self.head, *self.buffers]

    @classmethod
    def from_frames(cls, frames: Sequence[Frame]) -> Answer:
        """Return what `frames` made a list of."""
        kind, fields, differs = json.loads(bytes(frames[0]))
        fields |= {"values": (), "warnings": tuple(fields["warnings"]), "digests": ()}
        fields["state"] = State(fields["state"])
        return cls(kind, Outcome(**fields), differs, bytes(frames[1]), frames[2:])


@dataclass(frozen=True)
class Address:
    """Where another process looks for a node.

    Attributes
    ----------
    plugin, node : str
    distribution : str
        Name and version of the package that brings the plugin here; empty for a file.
    module, qualname : str
        Where the function was defined, for a node that no plugin brings.
    """

    plugin: str
    node: str
    distribution: str
    module: str
    qualname: str

    @classmethod
    def of(cls, call: Call, registry: Registry) -> Address | None:
        """Return where another process finds the node of a call, or None if nowhere."""
        if type(call.node) is not Node or call.plugin == "nodegraph":
            return None  # it was made for this graph
        function = call.node.function
        module, qualname = function.__module__, function.__qualname__
        brought = {one.name: one.distribution for one in registry.loaded}
        if call.plugin not in brought and not _is_importable(function):
            return None
        distribution = brought.get(call.plugin, "")
        return cls(call.plugin, call.node.name, distribution, module, qualname)

    def as_bytes(self) -> bytes:
        """Return it as JSON."""
        return json.dumps(asdict(self)).encode()

    @classmethod
    def from_bytes(cls, text: bytes) -> Address:
        """Return what `as_bytes` made a text of."""
        return cls(**json.loads(text))


def _is_importable(function: Callable[..., Any]) -> bool:
    """Whether the function is what its name stands for in a module that others can import."""
    if function.__module__ == "__main__":
        return False
    found: Any = sys.modules.get(function.__module__)
    for part in function.__qualname__.split("."):
        found = getattr(found, part, None)
    return found is function


_IMPORTED = re.compile(rb"^\s*(?:from|import)\s+(\w+)", re.MULTILINE)

Package = tuple[str, tuple[str, ...]]
"""A digest of all files, and which others of the packages they import."""


def code_of(packages: Iterable[str]) -> dict[str, Package]:
    """Return the code of top-level packages that are imported; those without files are left out."""
    named = set(packages)
    found = {name: _package(name, named) for name in sorted(named)}
    return {name: code for name, code in found.items() if code[0]}


def reached(package: str, code: Mapping[str, Package]) -> set[str]:
    """Return a package and all that it imports, directly or not."""
    found: set[str] = set()
    pending = [package]
    while pending:
        name = pending.pop()
        if name in code and name not in found:
            found.add(name)
            pending.extend(code[name][1])
    return found


def _package(name: str, named: set[str]) -> Package:
    digest, imported, files = hashlib.sha256(), set[str](), _files(name)
    for relative, file in files:
        content = file.read_bytes()
        digest.update(f"{relative} {len(content)}\n".encode() + content)
        imported.update(one.decode() for one in _IMPORTED.findall(content))
    return digest.hexdigest() if files else "", tuple(sorted(imported & named - {name}))


def _files(name: str) -> list[tuple[str, Path]]:
    module = sys.modules.get(name)
    folders = [Path(one) for one in getattr(module, "__path__", ())]
    if not folders and getattr(module, "__file__", None):
        file = Path(str(getattr(module, "__file__", "")))
        return [(file.name, file)] if file.suffix == ".py" and file.is_file() else []
    inside = [(one, folder) for folder in folders for one in folder.rglob("*.py")]
    return sorted((file.relative_to(folder).as_posix(), file) for file, folder in inside)


@dataclass(frozen=True)
class Surroundings:
    """What a process that asks has, for one that answers.

    Attributes
    ----------
    files : tuple of (path, content)
        Plugin files that the user named. What is in them goes along: another machine may not have
        them, and one that was edited must not answer as it was before.
    python, numpy : str
        Versions, because results may differ in their last bits between them.
    code : mapping of package to code
        Of the packages of the other plugins; empty for processes that are as new as the question.
    """

    files: tuple[tuple[str, bytes], ...] = ()
    python: str = ".".join(platform.python_version_tuple()[:2])
    numpy: str = numpy.__version__
    code: Mapping[str, Package] = field(default_factory=dict)

    @classmethod
    def of(cls, registry: Registry, *, with_code: bool) -> Surroundings:
        """Return those of this process, with the plugins of a registry."""
        files = [Path(one.module.__file__) for one in registry.loaded if not one.distribution]
        installed = [one.module.__name__ for one in registry.loaded if one.distribution]
        packages = {one.partition(".")[0] for one in installed} if with_code else set()
        return cls(tuple((str(path), path.read_bytes()) for path in files), code=code_of(packages))

    def as_bytes(self) -> bytes:
        """Return them as JSON."""
        files = [(path, content.decode("latin-1")) for path, content in self.files]
        return json.dumps([files, self.python, self.numpy, self.code]).encode()

    @classmethod
    def from_bytes(cls, text: bytes) -> Surroundings:
        """Return what `as_bytes` made a text of."""
        files, python, numpy_version, code = json.loads(text)
        contents = tuple((path, one.encode("latin-1")) for path, one in files)
        return cls(contents, python, numpy_version, code)

    def differences(self, there: Surroundings) -> Iterator[str]:
        """Yield which versions another process has, where they are not those of this one."""
        if there.python != self.python:
            yield f"Python {there.python}, here it is {self.python}"
        if there.numpy != self.numpy:
            yield f"numpy {there.numpy}, here it is {self.numpy}"

    def placed(self) -> list[Path]:
        """Return where the plugin files lie: as they were named, or laid down anew."""
        return [_placed(Path(path), content) for path, content in self.files]


def _placed(path: Path, content: bytes) -> Path:
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
