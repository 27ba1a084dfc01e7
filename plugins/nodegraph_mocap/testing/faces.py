"""Strategies for marker sets, blendshape models, their weights, and head motions."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from nodegraph_mocap.face_model import BlendshapeModel, HeadMotion, Weights
from nodegraph_mocap.marker_set import MarkerSet
from nodegraph_mocap.testing.events import NAMES, RADIUS, RATES, at_rest, names_of, runs, seeds

if TYPE_CHECKING:
    from collections.abc import Iterable

    from hypothesis.strategies import DrawFn, SearchStrategy
    from numpy.typing import NDArray

SHAPES = (
    "jawOpen", "mouthSmileLeft", "mouthSmileRight", "browInnerUp", "cheekPuff", "eyeBlinkLeft",
    "eyeBlinkRight", "noseSneerLeft",
)  # fmt: skip
_SIDES = ("_left", "_right")


def marker_sets(names: Iterable[str] = NAMES) -> SearchStrategy[MarkerSet]:
    """Return a strategy for marker sets of these markers.

    Parameters
    ----------
    names
        Names of markers; those that end in ``_left`` and ``_right`` are pairs, if the set knows of
        any.
    """
    from hypothesis import strategies as st

    there = tuple(names)
    stems = [name.removesuffix(_SIDES[0]) for name in there if name.endswith(_SIDES[0])]
    pairs = [(stem + _SIDES[0], stem + _SIDES[1]) for stem in stems if stem + _SIDES[1] in there]
    midline = [name for name in there if not name.endswith(_SIDES)]

    @st.composite
    def marker_set(draw: DrawFn) -> MarkerSet:
        return MarkerSet(
            markers=there,
            pairs=tuple(pairs) if draw(st.booleans()) else (),
            midline=tuple(midline) if draw(st.booleans()) else (),
            stable=tuple(draw(st.lists(st.sampled_from(there), unique=True, max_size=4))),
            edges=tuple(pairwise(there)) if draw(st.booleans()) else (),
        )

    return marker_set()


def weights(
    *, frames: tuple[int, int] = (1, 24), shapes: tuple[int, int] = (1, 8), gaps: bool = True
) -> SearchStrategy[Weights]:
    """Return a strategy for weights between 0 and 1 over time.

    Parameters
    ----------
    frames, shapes
        The least and the largest number; at most 8 shapes.
    gaps
        Whether weights may be missing.
    """
    from hypothesis import strategies as st

    @st.composite
    def driven(draw: DrawFn) -> Weights:
        shape = (draw(st.integers(*frames)), draw(st.integers(*shapes)))
        values = np.zeros(shape)
        if draw(st.booleans()):
            values = np.random.default_rng(draw(seeds())).uniform(0.0, 1.0, shape)
        if gaps:
            values[runs(draw, shape)] = np.nan
        return Weights(values=values, names=SHAPES[: shape[1]], rate=draw(st.sampled_from(RATES)))

    return driven()


def models(
    *, markers: tuple[int, int] = (1, 8), shapes: tuple[int, int] = (1, 4)
) -> SearchStrategy[BlendshapeModel]:
    """Return a strategy for blendshape models; a shape may move nothing, or as another does.

    Parameters
    ----------
    markers, shapes
        The least and the largest number; at most 16 markers and 8 shapes.
    """
    from hypothesis import strategies as st

    @st.composite
    def model(draw: DrawFn) -> BlendshapeModel:
        names = names_of(draw, markers)
        count = draw(st.integers(*shapes))
        moved = np.random.default_rng(draw(seeds())).normal(0.0, 4.0, (count, len(names), 3))
        like = draw(st.lists(st.integers(-1, count - 1), min_size=count, max_size=count))
        moved = np.stack([moved[twin] if twin >= 0 else np.zeros_like(moved[0]) for twin in like])
        return BlendshapeModel(
            neutral=at_rest(len(names)), shapes=moved, names=SHAPES[:count], markers=names
        )

    return model()


def head_motions(
    *, frames: tuple[int, int] = (1, 24), scaled: bool = True
) -> SearchStrategy[HeadMotion]:
    """Return a strategy for head motions: still, or turned and moved independently in each frame.

    Parameters
    ----------
    frames
        The least and the largest number.
    scaled
        Whether scales may differ from 1.
    """
    from hypothesis import strategies as st

    @st.composite
    def motion(draw: DrawFn) -> HeadMotion:
        count = draw(st.integers(*frames))
        turn, way, size = (draw(st.sampled_from(most)) for most in ((0.0, 0.3, 3.0),) * 3)
        chance = np.random.default_rng(draw(seeds()))
        return HeadMotion(
            rotations=_rotations(turn * chance.uniform(-1.0, 1.0, (count, 3))),
            translations=RADIUS * way * chance.uniform(-1.0, 1.0, (count, 3)),
            scales=np.exp(0.3 * scaled * size * chance.uniform(-1.0, 1.0, count)),
        )

    return motion()


def _rotations(turns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return (T, 3, 3) rotations about axes by angles, (T, 3) radians (Rodrigues)."""
    angle = np.linalg.norm(turns, axis=1)[:, None, None]
    x, y, z = (turns / np.maximum(angle[:, :, 0], 1e-12)).T
    zero = np.zeros_like(x)
    cross = np.array([[zero, -z, y], [z, zero, -x], [-y, x, zero]]).transpose(2, 0, 1)
    return np.asarray(np.eye(3) + np.sin(angle) * cross + (1.0 - np.cos(angle)) * cross @ cross)
