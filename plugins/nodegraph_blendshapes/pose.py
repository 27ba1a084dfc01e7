"""The recording that a model makes of weights."""

from __future__ import annotations

import warnings

import numpy as np

from nodegraph import node
from nodegraph_blendshapes.shape_matches import driving
from nodegraph_mocap import BlendshapeModel, MarkerSet, Trajectories, Weights
from nodegraph_mocap.recording import with_marker_set


@node("blendshapes.pose", cite=("lewis2014",))
def pose(
    weights: Weights, model: BlendshapeModel, marker_set: MarkerSet | None = None
) -> Trajectories:
    """Pose a model by weights: ``neutral + sum(weight * shape)`` in every frame.

    Weights and shapes are matched by name, whichever convention each is written in
    (``EyeBlinkLeft``, ``eyeBlinkLeft``, ``eyeBlink_L``) [1]_. A weight without sides, such as
    ``browInnerUp``, drives the shapes of both sides where the model has these instead, and a shape
    without sides gets the mean of the weights of both. Weights that the model has no shape for are
    left out, and shapes without weight stay at 0. Warnings count and name all of these. A frame in
    which a weight of the model is missing (NaN) is missing as a whole, counted in a warning.

    Parameters
    ----------
    weights
        T frames.
    model
        Whose shapes they drive.
    marker_set
        Pairs, midline and so on of the model's markers, for the recording.

    Returns
    -------
    Trajectories
        T frames of the model's markers, without head motion, at the rate of the weights.

    Raises
    ------
    ValueError
        If weights and model have no shape in common, a weight could mean two shapes, or the marker
        set names a marker that the model lacks.

    References
    ----------
    .. [1] J. P. Lewis et al., Practice and theory of blendshape facial models, Eurographics 2014,
       State of the Art Reports, 199-218.
    """
    used, driven = driving(weights, model.names, "model")
    shapes = model.shapes[[model.names.index(shape) for shape in driven]]
    lacking = np.asarray(np.isnan(used.values).any(axis=1))
    if lacking.any():
        warnings.warn(
            f"{np.count_nonzero(lacking)} of {len(lacking)} frames lack a weight, and are missing; "
            f"the first is frame {np.argmax(lacking)}",
            stacklevel=2,
        )
    offsets = np.tensordot(used.values, shapes, axes=1)
    offsets[lacking] = np.nan
    posed = Trajectories(
        positions=model.neutral + offsets, markers=model.markers, rate=weights.rate
    )
    return with_marker_set(posed, marker_set, what="the model")
