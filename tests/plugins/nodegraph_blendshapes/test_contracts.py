"""A node that breaks a promise of its family is caught."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from nodegraph_blendshapes.animate_mesh import mesh
from nodegraph_blendshapes.from_head import from_head
from nodegraph_blendshapes.from_pca import from_pca
from nodegraph_blendshapes.model import ModelAndNeutral
from nodegraph_blendshapes.pose import pose
from nodegraph_mocap import Animation, BlendshapeModel, Head, Trajectories, Weights
from tests.promises import Family

BLENDSHAPES = Family("blendshapes")
ANIMATE = Family("animate", "blendshapes")


def stranger(model: BlendshapeModel) -> BlendshapeModel:
    return replace(model, markers=model.markers[::-1])


def centred(model: BlendshapeModel) -> BlendshapeModel:
    return replace(model, neutral=model.neutral - model.neutral.mean(axis=0))


def larger_first(model: BlendshapeModel) -> BlendshapeModel:
    shapes = model.shapes.copy()
    shapes[:, 0] *= 2
    return replace(model, shapes=shapes)


def flat(model: BlendshapeModel) -> BlendshapeModel:
    return replace(model, shapes=model.shapes * [1.0, 1.0, 0.0])


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (stranger, "Give the markers of the recording"),
        (centred, "Do the same with a face that stands elsewhere"),
        (flat, "Do the same with a face that stands elsewhere"),
        (larger_first, "Do the same with markers in another order"),
    ],
)
def test_a_model_that_breaks_a_promise(
    spoil: Callable[[BlendshapeModel], BlendshapeModel], text: str
) -> None:
    def of_head(head: Head) -> BlendshapeModel:
        """Build a model, and spoil it."""
        return spoil(from_head(head).model)

    def of_recording(recording: Trajectories) -> BlendshapeModel:
        """Build a model, and spoil it."""
        return spoil(from_pca(recording).model)

    for broken in (of_head, of_recording):
        BLENDSHAPES.refuses(broken, text)


def test_a_neutral_that_is_not_the_model_s() -> None:
    def broken(head: Head) -> ModelAndNeutral:
        """Build a model, and give another neutral."""
        animation = from_head(head)
        return animation._replace(
            neutral=replace(animation.neutral, positions=animation.neutral.positions + 1.0)
        )

    BLENDSHAPES.refuses(broken, "`neutral` differs from the model's")


def test_a_pose_that_takes_weights_by_their_column() -> None:
    def broken(weights: Weights, model: BlendshapeModel) -> Trajectories:
        """Pose, by column."""
        return pose(replace(weights, names=model.names), model)

    BLENDSHAPES.refuses(broken, "Do the same with the shapes of weights in another")


def test_a_node_that_gives_something_else() -> None:
    def broken(head: Head) -> Head:
        """Give the head."""
        return head

    BLENDSHAPES.refuses(broken, "its first output is Head")


def doubled(animation: Animation) -> Animation:
    return replace(
        animation, weights=replace(animation.weights, values=2 * animation.weights.values)
    )


def faster(animation: Animation) -> Animation:
    return replace(animation, weights=replace(animation.weights, rate=2 * animation.rate))


def swollen(animation: Animation) -> Animation:
    return replace(
        animation, head=replace(animation.head, vertices=1.1 * np.array(animation.head.vertices))
    )


@pytest.mark.parametrize(
    ("spoil", "text"),
    [
        (doubled, "weights went in otherwise than they came out: jawOpen"),
        (faster, "frames at 60.0 Hz became"),
        (swollen, "the head that it animates is not the one"),
    ],
)
def test_an_animation_that_breaks_a_promise(
    spoil: Callable[[Animation], Animation], text: str
) -> None:
    def broken(weights: Weights, head: Head) -> Animation:
        """Animate, and spoil it."""
        return spoil(mesh(weights, head))

    ANIMATE.refuses(broken, text)


def test_an_animation_whose_ports_have_other_names() -> None:
    def broken(curves: Weights, head: Head) -> Animation:
        """Animate."""
        return mesh(curves, head)

    ANIMATE.refuses(broken, "name them `weights` and `head`")
