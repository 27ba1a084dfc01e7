"""PCA of a head that moves, of a face that moves, and of both."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from nodegraph import Across, Refusal
from nodegraph_mocap import HeadMotion, Trajectories
from nodegraph_score.alignment import COLUMNS, alignment
from nodegraph_tables import info_of
from tests.plugins.recordings import make_recording

FRAMES = 400
FACE = np.random.default_rng(8).normal(0.0, 40.0, (12, 3))
SECONDS = np.arange(FRAMES) / 60.0


def motion(frames: int = FRAMES, *, degrees: float = 4.0, mm: float = 5.0) -> HeadMotion:
    """Return a head that turns and shifts, each number at its own pace."""
    paces = np.array([0.31, 0.47, 0.59, 0.73, 0.83, 0.97])
    waves = np.sin(2 * np.pi * SECONDS[:frames, None] * paces + np.arange(6))
    return HeadMotion(
        rotations=Rotation.from_rotvec(degrees * waves[:, :3], degrees=True).as_matrix(),
        translations=mm * waves[:, 3:],
        scales=np.ones(frames),
    )


def still(frames: int = FRAMES) -> HeadMotion:
    return motion(frames, degrees=0.0, mm=0.0)


def speech(frames: int = FRAMES, mm: float = 3.0) -> NDArray[np.float64]:
    """Return offsets of a few points, at paces of their own."""
    paces = np.array([2.1, 3.3, 4.7, 5.9])
    waves = mm * np.sin(2 * np.pi * SECONDS[:frames, None] * paces)
    offsets = np.zeros((frames, len(FACE), 3))
    offsets[:, 8:, 1] = waves
    return offsets


def captured(offsets: NDArray[np.float64], where: HeadMotion) -> Trajectories:
    turned = np.einsum("tij,tmj->tmi", where.rotations, FACE + offsets)
    return make_recording(turned + where.translations[:, None])


def single(take: object) -> Across[Any]:
    return Across((), (({}, take),))


def of(**takes: object) -> Across[Any]:
    return Across.of(takes, axis="align")


def test_a_still_face_on_a_moving_head_is_all_head_motion() -> None:
    table = alignment(single(captured(0.0 * speech(), motion())), motion(), components=2)
    assert tuple(table.columns) == COLUMNS
    np.testing.assert_allclose(table["head motion"], 1.0, atol=1e-6)
    np.testing.assert_allclose(table["in all"], 1.0, atol=1e-6)
    assert set(table["finds"]) == {"head motion"}
    assert (table["R"] > 0.99).all()
    sentence, _, card = info_of(table).answer.lines
    assert sentence == (
        "The first principal component is 100 % head motion, as is 100 % of all variance."
    )
    assert card.endswith("finds: head motion, head motion.")


def test_a_moving_face_on_a_still_head_is_none() -> None:
    with pytest.warns(UserWarning, match="the head does not move"):
        table = alignment(single(captured(speech(), still())), still())
    assert (table["head motion"] == 0.0).all()
    assert set(table["finds"]) == {"face"}
    assert table[["R", "by chance", "correlation"]].isna().all(axis=None)
    assert set(table["with"]) == {""}


def test_what_the_head_makes_and_what_the_face_makes_are_reported_apart() -> None:
    """A mouth that moves with the head is not moved by it."""
    where = motion(mm=0.0, degrees=0.0)
    along = np.sin(2 * np.pi * SECONDS * 2.1)[:, None] * [4.0, 0.0, 0.0]
    where = replace(where, translations=along)
    take = captured(speech(), where)
    whole = alignment(single(take), where)
    assert whole["finds"][0] == "head motion"
    # by hand: 12 points shift by 4 mm times a sine, 4 points by 3 mm times each their own
    assert whole["in all"][0] == pytest.approx(12 * 16 / (12 * 16 + 4 * 9), abs=0.02)
    nodding = speech()
    nodding[:, 9:] = 0.0
    aligned = alignment(single(captured(nodding, still())), where, single(where))
    assert (aligned["in all"] == 0.0).all()
    assert aligned["finds"].tolist() == ["face"]
    assert aligned["R"][0] == pytest.approx(1.0)


def test_what_an_alignment_has_left_is_found() -> None:
    """Only the shift was taken out, so that the turn is all that is left."""
    where = motion()
    shift = replace(where, rotations=still().rotations)
    estimate = make_recording(captured(speech(), where).positions - where.translations[:, None])
    table = alignment(single(estimate), where, single(shift))
    turned = captured(speech(), replace(where, translations=still().translations))
    same = alignment(single(turned), replace(where, translations=still().translations))
    np.testing.assert_allclose(table["head motion"], same["head motion"], atol=1e-9)


def test_the_order_of_what_was_removed_does_not_matter() -> None:
    where, take = motion(), captured(speech(), motion())
    aligned = make_recording(FACE + speech())
    takes = of(no=take, yes=aligned)
    one_way = alignment(takes, where, of(no=still(), yes=where))
    other = alignment(takes, where, of(yes=where, no=still()))
    assert one_way.equals(other)


def test_scans_in_any_order_are_judged_alike() -> None:
    order = np.random.default_rng(0).permutation(FRAMES)
    take, where = captured(speech(), motion()), motion()
    table = alignment(single(take), where)
    other = alignment(single(make_recording(take.positions[order])), where[order])
    same = ["share", "head motion", "in all", "R", "correlation"]
    np.testing.assert_allclose(table[same].to_numpy(), other[same].to_numpy(), atol=1e-9)
    assert (other["by chance"] < table["by chance"]).all()


def test_incomplete_frames_are_left_out_and_counted() -> None:
    positions = captured(speech(), motion()).positions.copy()
    positions[30:50, 2] = np.nan
    with pytest.warns(UserWarning, match="20 of 400 frames lack samples: left out"):
        table = alignment(single(make_recording(positions)), motion())
    kept = np.r_[0:30, 50:400]
    same = alignment(single(make_recording(positions[kept])), motion()[kept])
    np.testing.assert_allclose(table["head motion"], same["head motion"], atol=1e-9)
    assert list(info_of(table).notes) == ["20 of 400 frames lack samples: left out."]


def test_a_recording_that_cannot_be_judged_does_not_stop_the_others() -> None:
    positions = np.full((FRAMES, 12, 3), np.nan)
    positions[:, :11] = captured(speech(), motion()).positions[:, :11]
    with pytest.warns(UserWarning, match=r"bad: needs 2 complete frames; 0 of 400 are \(m11 alone"):
        table = alignment(
            of(bad=make_recording(positions), good=captured(speech(), motion())), motion()
        )
    assert set(table["align"]) == {"good"}


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        (FACE[None], "needs 2 complete frames; 1 of 1 are"),
        (np.tile(FACE, (20, 1, 1)), "nothing moves"),
        (np.full((20, 12, 3), np.nan), r"0 of 20 are \(m0 alone lacks 20\): fill it first"),
        (np.empty((20, 0, 3)), "nothing moves"),
        (np.empty((1, 0, 3)), "1 frames of 0 markers"),
        (np.empty((0, 12, 3)), "0 frames of 12 markers"),
    ],
)
def test_what_has_no_components_is_refused(positions: NDArray[np.float64], message: str) -> None:
    with pytest.raises(Refusal, match=message):
        alignment(single(make_recording(positions)), motion(len(positions)))


def test_too_few_frames_say_nothing_of_correlation() -> None:
    vectors, shifts = np.random.default_rng(1).normal(0.0, 1.0, (2, 7, 3))
    where = replace(
        still(7),
        rotations=Rotation.from_rotvec(vectors, degrees=True).as_matrix(),
        translations=shifts,
    )
    with pytest.warns(UserWarning, match="7 frames are too few"):
        table = alignment(single(captured(speech(7), where)), where)
    assert table["R"].isna().all()
    assert table["head motion"].notna().all()


TAKE = captured(speech(), motion())
MIRRORED = replace(motion(), rotations=motion().rotations @ np.diag([1.0, -1.0, 1.0]))


@pytest.mark.parametrize(
    ("takes", "where", "removed", "message"),
    [
        (Across(("align",), ()), motion(), None, "there is no recording"),
        (of(b=captured(speech(9), motion(9))), motion(), None, "recording b has 9 frames, the hea"),
        (single(TAKE), motion(), single(motion(9)), "has 400 frames, the head motion removed 9"),
        (of(a=TAKE, b=TAKE), motion(), of(a=motion()), "b has 0 head motions that were removed"),
        (
            single(TAKE),
            motion(),
            Across.of({"a": motion(), "b": motion()}, axis="other"),
            "has 2 head motions that were removed",
        ),
        (single(TAKE), MIRRORED, None, "head motion, frame 0"),
        (single(TAKE), motion(), single(MIRRORED), "removed of the recording, frame 0"),
        (Across.of({"a": TAKE}, axis="share"), motion(), None, "an axis cannot be called share"),
    ],
)
def test_what_does_not_fit_is_refused(
    takes: Across[Any], where: HeadMotion, removed: Across[Any] | None, message: str
) -> None:
    with pytest.raises((ValueError, Refusal), match=message):
        alignment(takes, where, removed)
