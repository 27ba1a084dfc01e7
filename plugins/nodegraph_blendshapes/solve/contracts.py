"""Contracts of every node that solves for weights, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import BlendshapeModel, Trajectories, Weights

_TOLERANCE = 1e-6
_SCALE = 2.0


def gives_weights_of_the_models_shapes(tried: Tried) -> Iterator[str]:
    """Take `recording` and `model`, and give first the weights of the model's shapes, per frame."""
    weights = next(iter(tried.outputs.values()))
    pairs = list(_given(tried))
    if not pairs:
        yield f"its ports are {', '.join(tried.inputs)}; name them `recording` and `model`"
    elif not isinstance(weights, Weights):
        yield f"its first output is a {type(weights).__name__}, not weights"
    else:
        recording, model = pairs[0]
        if weights.names != model.names:
            yield f"the model's shapes are {model.names}, the weights' {weights.names}"
        if (weights.frames, weights.rate) != (recording.frames, recording.rate):
            yield (
                f"{recording.frames} frames at {recording.rate} Hz went in, {weights.frames} at "
                f"{weights.rate} Hz came out"
            )


def keeps_to_its_bounds(tried: Tried) -> Iterator[str]:
    """Give no weight outside of the setting `bounds`, where there is one."""
    bounds = tried.settings.get("bounds", "none")
    low, high = (0.0, np.inf) if bounds == "nonnegative" else (-np.inf, np.inf)
    if not isinstance(bounds, str):
        low, high = bounds
    for weights in _output_weights(tried):
        outside = (weights.values < low) | (weights.values > high)
        if outside.any():
            frame, shape = np.argwhere(outside)[0]
            yield (
                f"frame {frame}, {weights.names[shape]}: {weights.values[frame, shape]} is outside "
                f"{bounds}"
            )


def knows_nothing_of_empty_frames(tried: Tried) -> Iterator[str]:
    """Give no weights (NaN) where no marker is present, and all of them elsewhere."""
    for recording, model in _given(tried):
        shared = [name for name in recording.markers if name in model.markers]
        empty = np.asarray(~recording.keep(shared).present.any(axis=1))
        for weights in _output_weights(tried):
            wrong = np.not_equal(np.isnan(weights.values).any(axis=1), empty)
            if wrong.any():
                frame = int(wrong.argmax())
                yield f"frame {frame} has {'no' if empty[frame] else 'a'} marker"


def does_not_depend_on_the_order_of_markers(tried: Tried) -> Iterator[str]:
    """Give the same with the recording's markers in another order."""
    for recording, model in _given(tried):
        yield from _differences(tried, recording.keep(recording.markers[::-1]), model, "reversed")


def scales_with_face_and_model(tried: Tried) -> Iterator[str]:
    """Give the same weights of a face and a model twice as large, settings in mm^2 adjusted."""
    settings = {
        name: value * _SCALE**2
        for name, value in tried.settings.items()
        if isinstance(value, float) and tried.units.get(name) == "mm^2"
    }
    for recording, model in _given(tried):
        sigma = None if recording.sigma is None else recording.sigma * _SCALE
        face = replace(recording, positions=recording.positions * _SCALE, sigma=sigma)
        larger = replace(model, neutral=model.neutral * _SCALE, shapes=model.shapes * _SCALE)
        yield from _differences(tried, face, larger, "twice as large", settings)


def identical_shapes_share(tried: Tried) -> Iterator[str]:
    """Give two identical shapes equal weights."""
    for recording, model in _given(tried):
        twin = replace(
            model,
            shapes=np.concatenate([model.shapes, model.shapes[:1]]),
            names=(*model.names, "twin"),
        )
        for weights in _weights_again(tried, recording, twin, {}):
            apart = np.nan_to_num(np.abs(weights.values[:, 0] - weights.values[:, -1]))
            if weights.names == twin.names and np.any(apart > _TOLERANCE):
                yield f"frame {apart.argmax()}: they differ by {apart.max():.3g}"


CONTRACTS = (
    gives_weights_of_the_models_shapes,
    keeps_to_its_bounds,
    knows_nothing_of_empty_frames,
    does_not_depend_on_the_order_of_markers,
    scales_with_face_and_model,
    identical_shapes_share,
)


def _given(tried: Tried) -> Iterator[tuple[Trajectories, BlendshapeModel]]:
    recording, model = tried.inputs.get("recording"), tried.inputs.get("model")
    if isinstance(recording, Trajectories) and isinstance(model, BlendshapeModel):
        yield recording, model


def _output_weights(tried: Tried) -> Iterator[Weights]:
    weights = next(iter(tried.outputs.values()))
    if isinstance(weights, Weights):
        yield weights


def _weights_again(
    tried: Tried, recording: Trajectories, model: BlendshapeModel, settings: dict[str, float]
) -> Iterator[Weights]:
    outputs = tried.again(settings, recording=recording, model=model)
    if outputs is not None and isinstance(weights := next(iter(outputs.values())), Weights):
        yield weights


def _differences(
    tried: Tried,
    recording: Trajectories,
    model: BlendshapeModel,
    how: str,
    settings: dict[str, float] | None = None,
) -> Iterator[str]:
    """Yield where other inputs, which should not matter, give other weights."""
    again = list(_weights_again(tried, recording, model, settings or {}))
    if not again:
        yield f"declines the recording that is {how}"
    for weights, other in zip(_output_weights(tried), again, strict=False):
        if weights.values.shape != other.values.shape:
            yield f"{how}: {weights.values.shape} becomes {other.values.shape}"
            continue
        apart = np.nan_to_num(np.abs(weights.values - other.values))
        if np.any(apart > _TOLERANCE):
            frame, shape = np.unravel_index(apart.argmax(), apart.shape)
            yield f"{how}: frame {frame}, {weights.names[shape]} differs by {apart.max():.3g}"
