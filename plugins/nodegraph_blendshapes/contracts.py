"""Contracts of every node that builds or poses a model or animates a head."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Animation, BlendshapeModel, Head, Trajectories, Weights
from nodegraph_mocap.contracts import SHIFT, TOLERANCE, TURN
from nodegraph_mocap.shape_names import sides_as

if TYPE_CHECKING:
    from numpy.typing import NDArray

_Points = Callable[["NDArray[np.float64]"], "NDArray[np.float64]"]
_WITH_MARKERS = (Trajectories, BlendshapeModel, Head)


def gives_a_model_or_a_recording(tried: Tried) -> Iterator[str]:
    """Give a blendshape model first, or the recording of a posed one."""
    result = _result(tried)
    if not isinstance(result, BlendshapeModel | Trajectories):
        yield f"its first output is {type(result).__name__}; it gives {', '.join(tried.outputs)}"


def keeps_the_markers(tried: Tried) -> Iterator[str]:
    """Give the markers of the recording, head or model that goes in, in their order."""
    result, markers = _result(tried), _markers_given(tried)
    if isinstance(result, BlendshapeModel | Trajectories) and result.markers != markers:
        yield f"markers went in as {markers}, came out as {result.markers}"


def neutral_is_that_of_the_model(tried: Tried) -> Iterator[str]:
    """Give as `neutral`, if at all, the model's neutral as a recording of one frame."""
    result, neutral = _result(tried), tried.outputs.get("neutral")
    if not isinstance(result, BlendshapeModel) or neutral is None:
        return
    if not isinstance(neutral, Trajectories):
        yield f"its output `neutral` is {type(neutral).__name__}, not a recording"
    elif neutral.markers != result.markers or neutral.frames != 1:
        yield "`neutral` is not one frame of the model's markers"
    elif not np.array_equal(neutral.positions[0], result.neutral):
        yield "`neutral` differs from the model's"


def moves_with_the_face(tried: Tried) -> Iterator[str]:
    """Do the same with a face that stands elsewhere, turned another way."""
    moved = {name: _moved(value) for name, value in tried.inputs.items()}
    yield from _differences(tried, tried.again(**moved), "the face elsewhere", _back, _unturned)


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Do the same with markers in another order."""
    turned = {name: _reordered(value) for name, value in tried.inputs.items()}
    again = tried.again(**turned)
    ordered = None if again is None else {name: _reordered(value) for name, value in again.items()}
    yield from _differences(tried, ordered, "markers in another order")


def does_not_depend_on_the_order_of_shapes(tried: Tried) -> Iterator[str]:
    """Do the same with the shapes of weights in another order."""
    weights = tried.inputs.get("weights")
    if isinstance(weights, Weights):
        other = replace(weights, values=weights.values[:, ::-1], names=weights.names[::-1])
        yield from _differences(tried, tried.again(weights=other), "weights in another order")


def gives_an_animation_of_its_weights(tried: Tried) -> Iterator[str]:
    """Take `weights` and `head`, and give an animation of that head by those weights."""
    weights, head, animation = tried.inputs.get("weights"), tried.inputs.get("head"), _result(tried)
    if not isinstance(weights, Weights) or not isinstance(head, Head):
        yield f"its ports are {', '.join(tried.inputs) or 'none'}; name them `weights` and `head`"
    elif not isinstance(animation, Animation):
        yield f"its first output is {type(animation).__name__}, not an animation"
    elif (animation.frames, animation.rate) != (weights.frames, weights.rate):
        yield (
            f"{weights.frames} frames at {weights.rate} Hz became {animation.frames} at "
            f"{animation.rate}"
        )
    elif animation.head.names != head.names or not np.array_equal(
        animation.head.vertices, head.vertices
    ):
        yield "the head that it animates is not the one that was given"
    elif unlike := [
        name for name in animation.weights.names if not _same_weight(animation, weights, name, head)
    ]:
        yield f"weights went in otherwise than they came out: {', '.join(unlike)}"


BLENDSHAPES = (
    gives_a_model_or_a_recording,
    keeps_the_markers,
    neutral_is_that_of_the_model,
    moves_with_the_face,
    does_not_depend_on_the_order_of_markers,
    does_not_depend_on_the_order_of_shapes,
)
ANIMATE = (gives_an_animation_of_its_weights,)


def _result(tried: Tried) -> object:
    return next(iter(tried.outputs.values()))


def _markers_given(tried: Tried) -> tuple[str, ...]:
    markers = (value.markers for value in tried.inputs.values() if isinstance(value, _WITH_MARKERS))
    return next(markers, ())


def _same_weight(animation: Animation, weights: Weights, name: str, head: Head) -> bool:
    sides = sides_as(weights.names, head.names)
    if name not in sides.names:
        return False
    came, went = animation.weights.names.index(name), sides.names.index(name)
    return np.array_equal(
        animation.weights.values[:, came], sides.of(weights.values)[:, went], equal_nan=True
    )


def _moved(value: object) -> object:
    if isinstance(value, Trajectories):
        return replace(value, positions=value.positions @ TURN.T + SHIFT)
    if isinstance(value, BlendshapeModel):
        neutral = value.neutral @ TURN.T + SHIFT
        return replace(value, neutral=neutral, shapes=value.shapes @ TURN.T)
    if isinstance(value, Head):
        vertices = value.vertices @ TURN.T + SHIFT
        return replace(value, vertices=vertices, morphs=value.morphs @ TURN.T)
    return value


def _reordered(value: object) -> object:
    names = value.markers[::-1] if isinstance(value, _WITH_MARKERS) else ()
    if isinstance(value, Trajectories):
        return value.keep(names)
    if isinstance(value, BlendshapeModel):
        neutral, shapes = value.neutral[::-1], value.shapes[:, ::-1]
        return replace(value, neutral=neutral, shapes=shapes, markers=names)
    if isinstance(value, Head):
        return replace(value, markers=names, marker_vertices=value.marker_vertices[::-1])
    return value


def _back(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray((points - SHIFT) @ TURN)


def _unturned(offsets: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(offsets @ TURN)


def _as_it_is(points: NDArray[np.float64]) -> NDArray[np.float64]:
    return points


def _differences(
    tried: Tried,
    again: Mapping[str, object] | None,
    what: str,
    points: _Points = _as_it_is,
    offsets: _Points = _as_it_is,
) -> Iterator[str]:
    """Yield where a model or recording differs from another, once that is moved back.

    Parameters
    ----------
    tried
    again
        The outputs for other inputs.
    what
        How these differ.
    points, offsets
        Functions that move positions and offsets back.
    """
    if again is None:
        yield f"declines {what}"
        return
    result, other = _result(tried), next(iter(again.values()))
    if isinstance(result, Trajectories) and isinstance(other, Trajectories):
        apart = _apart(result.positions, points(other.positions))
    elif isinstance(result, BlendshapeModel) and isinstance(other, BlendshapeModel):
        apart = _models_apart(result, other, points, offsets)
    else:
        return
    if apart > TOLERANCE:
        yield f"{what}: positions differ by up to {apart:.3g} mm"


def _models_apart(
    model: BlendshapeModel, other: BlendshapeModel, points: _Points, offsets: _Points
) -> float:
    if model.names != other.names:
        return np.inf
    shapes = [
        # which way a principal component points is anybody's choice
        min(_apart(shape, offsets(other_shape)), _apart(shape, -offsets(other_shape)))
        for shape, other_shape in zip(model.shapes, other.shapes, strict=True)
    ]
    return max([_apart(model.neutral, points(other.neutral)), *shapes])


def _apart(points: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    if points.shape != other.shape or np.any(np.isnan(points) != np.isnan(other)):
        return np.inf
    return float(np.nan_to_num(np.abs(points - other)).max(initial=0.0))
