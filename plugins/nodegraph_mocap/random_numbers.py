"""Random numbers for one purpose at a time."""

from __future__ import annotations

import zlib
from pathlib import PureWindowsPath
from typing import Annotated

import numpy as np
from pydantic import Field

_Number = Annotated[int, Field(ge=0)]
Seed = _Number | Annotated[tuple[_Number | str, ...], Field(min_length=1)]
"""A number, or several numbers and words: ``[$trial, $recording]`` is another draw for each."""


def entropy(seed: Seed) -> list[int]:
    """Return the numbers that a generator starts from.

    Of a word that is an absolute path its last part counts, which is the same on every machine.
    """
    parts = (seed,) if isinstance(seed, int) else seed
    return [zlib.crc32(_word(part)) if isinstance(part, str) else part for part in parts]


def _word(part: str) -> bytes:
    path = PureWindowsPath(part)  # knows both kinds of slashes
    return (path.name if path.root else part).encode()


def random_for(purpose: str, seed: Seed) -> np.random.Generator:
    """Return a generator for one purpose, so that no purpose disturbs another."""
    return np.random.default_rng([*entropy(seed), zlib.crc32(purpose.encode())])
