"""Reads what the view of a block is given, stated a second time in Python."""

from __future__ import annotations

import base64
from typing import Any

import numpy as np
from numpy.typing import NDArray


def numbers(packed: dict[str, Any], *shape: int, kind: str = "<i2") -> NDArray[np.float64]:
    """Return whole steps as numbers; the least integer is a missing one."""
    whole = np.frombuffer(base64.b64decode(packed["data"]), kind).astype(float)
    whole[whole == np.iinfo(np.dtype(kind)).min] = np.nan
    return np.asarray(whole.reshape(shape) * packed["step"])


def estimates(packed: dict[str, Any]) -> dict[str, NDArray[np.float64]]:
    """Return (F, 3) mm of each method in the frames of the view."""
    centre = np.array(packed["centre"])
    common = numbers(packed["common"], -1, 3)
    apart = [frame for first, last in packed["apart"] for frame in range(first, last + 1)]
    every = {}
    for estimate in packed["estimates"]:
        positions = common.copy()
        positions[apart] = numbers(estimate, -1, 3)
        every[estimate["method"]] = positions + centre
    return every


def truth(packed: dict[str, Any]) -> NDArray[np.float64]:
    """Return (F, 3) mm."""
    return np.asarray(numbers(packed["truth"], -1, 3) + np.array(packed["centre"]))


def faces(packed: dict[str, Any]) -> NDArray[np.float64]:
    """Return (P, M, 3) mm."""
    face = packed["face"]
    count = len(face["markers"])
    moved = numbers(face["moved"], -1, count, 3, kind="i1")
    return np.asarray(numbers(face["rest"], count, 3) + moved + np.array(packed["centre"]))
