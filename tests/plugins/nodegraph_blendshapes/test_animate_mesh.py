from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_blendshapes.animate_mesh import mesh
from nodegraph_files.writers import write_glb
from nodegraph_mocap import Head
from nodegraph_mocap.specimens import head_motions, heads, weights

HEAD = heads()["complete"]
WEIGHTS = weights()["complete"]
MOTION = head_motions()["complete"]


def test_weights_drive_the_morph_targets_of_their_names() -> None:
    animation = mesh(WEIGHTS, HEAD, MOTION)
    assert animation.head is HEAD
    assert animation.head_motion is MOTION
    np.testing.assert_array_equal(animation.morph_weights, WEIGHTS.values)
    assert (animation.frames, animation.rate) == (WEIGHTS.frames, WEIGHTS.rate)
    assert mesh(WEIGHTS, HEAD).head_motion is None


@pytest.mark.filterwarnings("ignore:1 (weights|shapes) without sides")
@pytest.mark.parametrize("split", [False, True])
def test_sides_are_split_and_joined(*, split: bool) -> None:
    names = ("jawOpen", "mouthSmile")
    weights, head = WEIGHTS, replace(HEAD, names=names, morphs=HEAD.morphs[:2])
    if split:
        weights, head = replace(WEIGHTS, values=WEIGHTS.values[:, :2], names=names), HEAD
    animation = mesh(weights, head)
    assert animation.weights.names == head.names
    smiles = WEIGHTS.values[:, [1, 1]] if split else WEIGHTS.values[:, 1:].mean(axis=1)[:, None]
    np.testing.assert_array_equal(animation.morph_weights[:, 1:], smiles)


@pytest.mark.parametrize(
    "head",
    [
        replace(HEAD, names=("a", "b", "c")),
        replace(HEAD, names=(), morphs=np.zeros((0, 10, 3))),
    ],
    ids=["other names", "no morph targets"],
)
def test_nothing_in_common_is_an_error(head: Head) -> None:
    message = "have no shape in common: the weights have jawOpen, mouthSmileLeft, mouthSmileRight,"
    with pytest.raises(ValueError, match=message):
        mesh(WEIGHTS, head)


def test_a_missing_weight_stays_missing_until_a_file_is_written() -> None:
    values = WEIGHTS.values.copy()
    values[4:6, 1] = np.nan
    animation = mesh(replace(WEIGHTS, values=values), HEAD)
    np.testing.assert_array_equal(animation.morph_weights, values)
    with pytest.warns(UserWarning, match="2 weights in 2 frames are missing, and repeat the last"):
        write_glb(animation)
