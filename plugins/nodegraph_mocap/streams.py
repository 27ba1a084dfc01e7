"""Random numbers for one purpose at a time."""

from __future__ import annotations

import zlib

import numpy as np


def random_for(purpose: str, seed: int) -> np.random.Generator:
    """Return a generator for one purpose, so that no purpose disturbs another."""
    return np.random.default_rng([seed, zlib.crc32(purpose.encode())])
