"""Reads what a playback packed, said again in Python: what the script must read."""

from __future__ import annotations

import gzip
import json
from typing import Any

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import Playback
from nodegraph_mocap.player.data import packed


class Read:
    """The head of a blob, and the arrays that it names."""

    def __init__(self, content: bytes) -> None:
        plain = gzip.decompress(content)
        length = int.from_bytes(plain[:4], "little")
        self.head: dict[str, Any] = json.loads(plain[4 : 4 + length])
        self.body = plain[4 + length :]

    @classmethod
    def of(cls, playback: Playback) -> Read:
        return cls(packed(playback))

    def steps(self, expected: dict[str, Any], like: NDArray[np.int64] | None = None) -> Any:
        """Return (rows, length) whole steps."""
        rows, length = expected["rows"], expected["length"]
        content = self.body[expected["at"] : expected["at"] + 4 * rows * length]
        planes = np.frombuffer(content, np.uint8).reshape(4, rows, length).astype(np.int64)
        whole = sum(planes[number] << (8 * number) for number in range(4))
        summed = np.cumsum(whole, axis=1) + (0 if like is None else like)
        return (summed + 2**31) % 2**32 - 2**31

    def small(self, place: int, count: int) -> NDArray[np.uint8]:
        return np.frombuffer(self.body[place : place + count], np.uint8)

    def exact(self, expected: dict[str, int]) -> NDArray[np.float32]:
        content = self.body[expected["at"] : expected["at"] + 4 * expected["length"]]
        return np.frombuffer(content, "<f4")

    def positions(self, place: int) -> NDArray[np.float64]:
        """Return (T, M, 3) mm of a panel's markers; NaN where its origins say missing."""
        panel = self.head["panels"][place]
        steps = self._panel_steps(place)
        positions = (steps * panel["positions"]["step"]).T.reshape(panel["frames"], -1, 3)
        positions[self.origin(place) == 0] = np.nan
        return np.asarray(positions)

    def origin(self, place: int) -> NDArray[np.uint8]:
        panel = self.head["panels"][place]
        count = panel["frames"] * len(panel["markers"])
        return self.small(panel["origin"], count).reshape(-1, panel["frames"]).T

    def _panel_steps(self, place: int) -> Any:
        panel = self.head["panels"][place]
        like = None if panel["like"] is None else self._panel_steps(panel["like"])
        return self.steps(panel["positions"], like)
