"""A model from a head's mesh, which the same weights drive."""

from __future__ import annotations

from nodegraph import Refusal, node
from nodegraph_blendshapes.model import with_neutral
from nodegraph_mocap import Head, MarkerSet
from nodegraph_mocap.face_model import ModelAndNeutral
from nodegraph_mocap.recording import with_marker_set


@node("blendshapes.from_head", cite=("curio2006", "lewis2014"))
def from_head(head: Head, marker_set: MarkerSet | None = None) -> ModelAndNeutral:
    """Build a model from a head: its morph targets where its markers sit.

    The model's shapes have the names of the morph targets, so weights that are solved with it
    animate the head [1]_ [2]_. A warning names shapes that are the same at the markers, or move
    none of them.

    Parameters
    ----------
    head
        With morph targets, and a vertex for each marker (``read.head`` takes them from a table,
        its setting `marker_vertices`).
    marker_set
        Pairs, midline and so on of the head's markers, for `neutral`.

    Returns
    -------
    model : BlendshapeModel
        At the head's markers, in its axes.
    neutral : Trajectories
        The model's face at rest: one frame, its rate set to 1 Hz, with the marker set.

    Raises
    ------
    Refusal
        If the head names no vertex of a marker, or has no morph targets.
    ValueError
        If the marker set names a marker that the head lacks.

    References
    ----------
    .. [1] C. Curio et al., Semantic 3D motion retargeting for facial animation, APGV '06, 77-84.
    .. [2] J. P. Lewis et al., Practice and theory of blendshape facial models, Eurographics 2014,
       State of the Art Reports, 199-218.
    """
    if not head.markers:
        raise Refusal(
            "the head does not say which vertices carry markers; give read.head a table of them "
            "by its setting marker_vertices"
        )
    if not head.names:
        raise Refusal("the head has no morph targets")
    result = with_neutral(head.model, None)
    return result._replace(neutral=with_marker_set(result.neutral, marker_set, what="the model"))
