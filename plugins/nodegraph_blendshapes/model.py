"""A model as nodes that build one give it: with its neutral, and warnings of its shapes."""

from __future__ import annotations

import warnings
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import listed
from nodegraph_mocap import BlendshapeModel, MarkerSet
from nodegraph_mocap.face_model import ModelAndNeutral

if TYPE_CHECKING:
    from numpy.typing import NDArray

APART = 1e-6
"""Millimetres: far above rounding, far below what any camera sees."""


def with_neutral(model: BlendshapeModel, marker_set: MarkerSet | None) -> ModelAndNeutral:
    """Return a model and its neutral; warn of shapes whose weights cannot be determined."""
    _warn_unseen(model)
    _warn_alike(model)
    return ModelAndNeutral.of(model, marker_set)


def _warn_unseen(model: BlendshapeModel) -> None:
    still = [
        name for name, shape in zip(model.names, model.shapes, strict=True) if not _moves(shape)
    ]
    if still:
        warnings.warn(
            f"{len(still)} of {len(model.names)} shapes move no marker: {listed(still)}",
            stacklevel=4,
        )


def _warn_alike(model: BlendshapeModel) -> None:
    shapes = dict(zip(model.names, model.shapes, strict=True))
    moving = {name: shape for name, shape in shapes.items() if _moves(shape)}
    alike = [
        f"{name} and {other}"
        for name, other in combinations(moving, 2)
        if not _moves(moving[name] - moving[other])
    ]
    if alike:
        warnings.warn(
            f"{len(alike)} pairs of shapes are the same, so that only the sum of their weights "
            f"can be determined: {listed(alike)}",
            stacklevel=4,
        )


def _moves(offsets: NDArray[np.float64]) -> bool:
    return bool(np.abs(offsets).max(initial=0.0) > APART)
