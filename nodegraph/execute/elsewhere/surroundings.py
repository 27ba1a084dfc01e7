"""What other processes must have as it is here: plugin files that were named, versions."""

from __future__ import annotations

import atexit
import json
import platform
import shutil
import tempfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy

from nodegraph.execute.elsewhere.package_code import Package, code_of
from nodegraph.registry import Registry


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
