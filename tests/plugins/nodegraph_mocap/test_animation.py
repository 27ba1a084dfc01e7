from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph.plugin.registry import default_registry
from nodegraph.store import Packer
from nodegraph.testing import same
from nodegraph_mocap import Animation, Head, HeadMotion, Weights
from nodegraph_mocap.specimens import animations, heads


@pytest.fixture
def head() -> Head:
    return replace(heads()["complete"], names=("jawOpen", "mouthSmile_L", "mouthSmile_R"))


def weights(*names: str, frames: int = 4) -> Weights:
    values = np.arange(1.0, 1 + frames * len(names)).reshape(frames, len(names))
    return Weights(values=values, names=names, rate=30.0)


def test_weights_find_their_morph_targets(head: Head) -> None:
    given = weights("MouthSmileRight", "JawOpen")
    result = Animation(head=head, weights=given, head_motion=HeadMotion.still(4))
    assert (result.frames, result.rate) == (4, 30.0)
    expected = np.column_stack([given.values[:, 1], np.zeros(4), given.values[:, 0]])
    np.testing.assert_array_equal(result.morph_weights, expected)


def test_a_missing_weight_stays_missing(head: Head) -> None:
    given = replace(weights("jawOpen"), values=np.array([[np.nan], [1.0]]))
    result = Animation(head=head, weights=given).morph_weights
    np.testing.assert_array_equal(result, [[np.nan, 0, 0], [1, 0, 0]])


def test_frames_must_agree(head: Head) -> None:
    with pytest.raises(ValueError, match="the weights have 4 frames, the head motion 5"):
        Animation(head=head, weights=weights("jawOpen"), head_motion=HeadMotion.still(5))


def test_a_weight_needs_a_morph_target(head: Head) -> None:
    message = (
        "no morph target for the weights HeadYaw, cheekPuff; it has jawOpen, mouthSmile_L, mouthSm"
    )
    with pytest.raises(ValueError, match=message):
        Animation(head=head, weights=weights("HeadYaw", "jawOpen", "cheekPuff"))


@pytest.mark.parametrize("name", ["complete", "gaps"])
def test_an_animation_is_stored_as_it_is(name: str) -> None:
    case = animations()[name]
    packer = Packer(default_registry().hooks.kinds)
    packed = packer.pack(case)
    back = packer.unpack(packed.head, packed.buffers)
    assert same(back, case)
    assert back.head_motion is None or back.head_motion.frames == case.frames
