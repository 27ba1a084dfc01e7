"""Animations out of GLB files: the weights of a head's morph targets over time, and its motion.

Source: glTF 2.0 Specification, section 3.11 (Animations) and appendix C (Interpolation), The
Khronos Group.
"""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Format, listed
from nodegraph_files.glb.buffers import MAGIC, Accessors, opened_glb
from nodegraph_files.glb.document import (
    Channel,
    Document,
    Sampler,
    entry_at,
)
from nodegraph_files.glb.reading import Placed, head_of, meshes_of_head, places_of, target_names
from nodegraph_files.head import RawHead
from nodegraph_mocap.face_model import HeadMotion

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PLACE = {"translation": "VEC3", "rotation": "VEC4", "scale": "VEC3"}
_IRREGULAR = 0.02
"""Share of a step by which keys may be early or late."""
_RIGID = 1e-3
_ROUND = 1e-4
"""Share by which a rate may differ from a whole number of Hz that is meant."""
_MOST_FRAMES = 1_000_000


@dataclass(frozen=True)
class RawAnimation:
    """An animation as a reader returns it: translations are in the unit of the head.

    Attributes
    ----------
    head : RawHead
    weights : mapping of morph target to (T,) array of float64
    motion : HeadMotion or None
    frames : int
    rate : float
    """

    head: RawHead
    weights: Mapping[str, NDArray[np.float64]]
    motion: HeadMotion | None
    frames: int
    rate: float


def is_animated(path: Path) -> bool:
    """Return whether a GLB file moves the head that it holds."""
    try:
        document, accessors = opened_glb(path)
        if not document.animations:
            return False
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # the reader says what it leaves out
            placed = meshes_of_head(document, accessors)
        return bool(_Moving(document, placed).channels)
    except ValueError:
        return False  # the reader of heads says what is wrong


def read_glb_animation(path: Path, *, rate: float | None = None) -> RawAnimation:
    """Read a head that moves from a GLB file: its first animation.

    Weights of the morph targets, and where the head is, are taken at even steps: those of the keys,
    or where keys are at irregular times, their median. Other meshes that move, and joints, are left
    out, with a warning.

    Raises
    ------
    ValueError
        With the file, and the place in it: as `read_glb` does; if no animation moves the head, keys
        are not in the order of time, or the head is sheared.
    """
    try:
        document, accessors = opened_glb(path)
        placed = meshes_of_head(document, accessors)
        head = head_of(document, placed, accessors)
        return _Moving(document, placed).animation(head, accessors, rate)
    except ValueError as error:
        raise ValueError(f"{path}: not a readable GLB animation: {error}") from None


class _Moving:
    """The first animation of a file, as far as it moves the head."""

    def __init__(self, document: Document, placed: list[Placed]) -> None:
        self._document = document
        self._placed = placed
        nodes = document.nodes
        self._parents = {
            child: parent for parent, node in enumerate(nodes) for child in node.children
        }
        # of several meshes the first carries the head: eyes and teeth come after it
        self._above = list(self._way_up(placed[0].node)) if placed and nodes else []
        shown = {part.node for part in placed}
        self._sampled: dict[int, Sampler] = {}
        self.channels: dict[tuple[int, str], Sampler] = {}
        self._others: set[int] = set()
        for channel in document.animations[0].channels if document.animations else ():
            self._add(channel, shown)

    def animation(self, head: RawHead, accessors: Accessors, setting: float | None) -> RawAnimation:
        if not self.channels:
            raise ValueError("no animation moves the head")
        keys = {
            ends: _keys(accessors, sampler, f"animation 0, {ends[1]} of node {ends[0]}")
            for ends, sampler in self.channels.items()
        }
        rate = setting or _rate(keys.values())
        first = min(float(each[0]) for each in keys.values())
        last = max(float(each[-1]) for each in keys.values())
        count = int(np.floor((last - first) * rate + 0.5)) + 1
        if count > _MOST_FRAMES:
            raise ValueError(f"{count:,} frames at {rate:g} Hz; {_MOST_FRAMES:,} are possible")
        accessors.charge(count * (len(head.morphs) + 16 * len(self._above)))
        times = first + np.arange(count) / rate
        weights = self._weights(head, accessors, keys, times)
        motion = self._motion(accessors, keys, times)
        if self._others:
            names = [self._document.nodes[at].name or f"node {at}" for at in sorted(self._others)]
            warnings.warn(
                f"{len(names)} nodes move that do not carry the head, which is left out: "
                f"{listed(names)}",
                stacklevel=5,
            )
        return RawAnimation(head, weights, motion, count, rate)

    def _add(self, channel: Channel, shown: set[int]) -> None:
        node, path = channel.target.node, channel.target.path
        if node is None:
            return
        animation = self._document.animations[0]
        sampler = entry_at(animation.samplers, channel.sampler, "sampler", "animation 0")
        entry_at(self._document.nodes, node, "node", "animation 0")
        if (path == "weights" and node in shown) or (path in _PLACE and node in self._above):
            self.channels[node, path] = sampler
        else:
            self._others.add(node)

    def _way_up(self, node: int | None) -> Iterable[int]:
        """Yield a node and all above it; `placed_meshes` has found that they are a tree."""
        while node is not None:
            yield node
            node = self._parents.get(node)

    def _weights(
        self,
        head: RawHead,
        accessors: Accessors,
        keys: Mapping[tuple[int, str], NDArray[np.float64]],
        times: NDArray[np.float64],
    ) -> dict[str, NDArray[np.float64]]:
        """Return the weights of all morph targets; of one name in several meshes, the first's."""
        found: dict[str, NDArray[np.float64]] = {}
        for part in self._placed:
            mesh = self._document.meshes[part.mesh]
            names = target_names(mesh, f"mesh {part.mesh}")
            node = self._document.nodes[part.node] if self._document.nodes else None
            still = (node.weights if node else []) or mesh.weights or [0.0] * len(names)
            if len(still) != len(names):
                raise ValueError(f"mesh {part.mesh}: {len(still)} weights for {len(names)} targets")
            values = np.tile(np.array(still, dtype=np.float64), (len(times), 1))
            ends = part.node, "weights"
            if ends in self.channels:
                where = f"animation 0, weights of node {part.node}"
                stored = accessors.numbers(self.channels[ends].output, where, kind="SCALAR")
                values = _sampled(self.channels[ends], keys[ends], stored, times, len(names), where)
            for name, column in zip(names, values.T, strict=True):
                found.setdefault(name, column)
        return {name: found[name] for name in head.morphs}

    def _motion(
        self,
        accessors: Accessors,
        keys: Mapping[tuple[int, str], NDArray[np.float64]],
        times: NDArray[np.float64],
    ) -> HeadMotion | None:
        """Return how the head moves from where it is at rest."""
        if not any(path in _PLACE for _, path in self.channels):
            return None
        if self._placed[0].skinned:
            raise ValueError("the head is moved by joints, which cannot be read")
        rest, moved = np.eye(4), np.eye(4)
        for index in reversed(self._above):
            node = self._document.nodes[index]
            parts: dict[str, NDArray[np.float64]] = {}
            for path, kind in _PLACE.items():
                if (index, path) not in self.channels:
                    continue
                where = f"animation 0, {path} of node {index}"
                sampler = self.channels[index, path]
                stored = accessors.numbers(sampler.output, where, kind=kind)
                parts[path] = _sampled(
                    sampler,
                    keys[index, path],
                    stored,
                    times,
                    stored.shape[1],
                    where,
                    is_rotation=path == "rotation",
                )
            rest = rest @ places_of(node, index)[0]
            moved = moved @ places_of(node, index, parts, len(times))
        return _as_motion(moved @ np.linalg.inv(rest))


def _keys(accessors: Accessors, sampler: Sampler, where: str) -> NDArray[np.float64]:
    """Return the times of the keys of a sampler, in seconds."""
    keys = accessors.numbers(sampler.input, where, kind="SCALAR")[:, 0]
    if (np.diff(keys) <= 0).any():
        key = int(np.argmax(np.diff(keys) <= 0)) + 1
        raise ValueError(f"{where}: key {key} is not after the one before it")
    return keys


def _rate(keys: Iterable[NDArray[np.float64]]) -> float:
    """Return the rate of the sampler with the most keys; 1 where each has a single one."""
    steps = np.diff(max(keys, key=len))
    if not len(steps):
        return 1.0
    step = float(np.median(steps))
    uneven = np.count_nonzero(np.abs(steps - step) > _IRREGULAR * step)
    if uneven:
        warnings.warn(
            f"{uneven} of {len(steps)} steps between keys are not {step:.4g} s long, as the median "
            "is: at that step the animation is read",
            stacklevel=6,
        )
    else:
        step = float(steps.mean())
    rate = 1 / step
    return float(round(rate)) if abs(rate - round(rate)) < _ROUND * rate else rate


def _sampled(
    sampler: Sampler,
    keys: NDArray[np.float64],
    stored: NDArray[np.float64],
    times: NDArray[np.float64],
    width: int,
    where: str,
    *,
    is_rotation: bool = False,
) -> NDArray[np.float64]:
    """Return (T, width) values of a sampler; before its first key that of the first, and so on."""
    is_cubic = sampler.interpolation == "CUBICSPLINE"
    expected = len(keys) * width * (3 if is_cubic else 1)
    if stored.size != expected:
        raise ValueError(f"{where}: {stored.size} numbers where {expected} are needed")
    values = stored.reshape(len(keys), -1, width)
    at = np.clip(np.searchsorted(keys, times, side="right") - 1, 0, max(len(keys) - 2, 0))
    after = np.minimum(at + 1, len(keys) - 1)
    length = np.where(after > at, keys[after] - keys[at], 1.0)
    share = np.clip((times - keys[at]) / length, 0.0, 1.0)[:, np.newaxis]
    first, second = values[at, -2 if is_cubic else 0], values[after, -2 if is_cubic else 0]
    if sampler.interpolation == "STEP":
        return np.asarray(np.where(share < 1, first, second))
    if is_rotation:  # the short way; between keys of frames the chord is nearly the arc
        second = np.where((first * second).sum(axis=1, keepdims=True) < 0, -second, second)
    if not is_cubic:
        return np.asarray(first + share * (second - first))
    leaving, arriving = values[at, 2], values[after, 0]
    length = length[:, np.newaxis]
    return np.asarray(
        (2 * share**3 - 3 * share**2 + 1) * first
        + (share**3 - 2 * share**2 + share) * length * leaving
        + (3 * share**2 - 2 * share**3) * second
        + (share**3 - share**2) * length * arriving
    )


def _as_motion(places: NDArray[np.float64]) -> HeadMotion:
    linear = places[:, :3, :3]
    scales = np.cbrt(np.linalg.det(linear))
    if (scales <= 0).any():
        raise ValueError(f"the head vanishes or is mirrored in frame {int(np.argmin(scales))}")
    turned = linear / scales[:, np.newaxis, np.newaxis]
    left, _, right = np.linalg.svd(turned)
    rotations = left @ right
    off = np.abs(rotations - turned).max(axis=(1, 2))
    if off.max() > _RIGID:
        raise ValueError(f"the head is stretched or sheared, most in frame {int(np.argmax(off))}")
    return HeadMotion(rotations=rotations, translations=places[:, :3, 3], scales=scales)


FORMAT = Format(
    "GLB animation",
    RawAnimation,
    (".glb",),
    read_glb_animation,
    lambda start: start.startswith(MAGIC),
)
