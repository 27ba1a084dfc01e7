"""Features are centred coordinates in the order of names, and only of complete takes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import Refusal
from nodegraph_mocap import Origin, Trajectories
from nodegraph_select.features import features_of
from tests.plugins.nodegraph_select.faces import make_rigid


def test_three_per_marker_in_the_order_of_names(face: Trajectories) -> None:
    features = features_of(face)
    assert features.markers == tuple(sorted(face.markers))
    for number, name in enumerate(features.markers):
        track = face.positions[:, face.markers.index(name)]
        columns = features.values[:, 3 * number : 3 * number + 3]
        assert columns == pytest.approx(track - track.mean(axis=0), abs=1e-10)
        assert features.spread[3 * number : 3 * number + 3] == pytest.approx(track.std(axis=0))
        assert features.variances[number] == pytest.approx(track.var(axis=0).sum())


def test_the_order_in_the_file_does_not_matter(face: Trajectories) -> None:
    turned = features_of(face.keep(face.markers[::-1]))
    assert np.array_equal(turned.values, features_of(face).values)


def test_what_stands_still_far_from_the_origin_has_no_spread_at_all(face: Trajectories) -> None:
    positions = face.positions.copy()
    positions[:, 2] = [1234.567, -0.1, 98765.4321]
    features = features_of(replace(face, positions=positions))
    number = features.markers.index(face.markers[2])
    assert not features.values[:, 3 * number : 3 * number + 3].any()


@pytest.mark.parametrize("far", [0.0, 1e3, 1e5])
def test_what_alignment_leaves_of_a_rigid_head_is_refused(far: float) -> None:
    random = np.random.default_rng(1)
    at_rest, turns = random.normal(0, 60, (7, 3)), np.linalg.qr(random.normal(size=(40, 3, 3)))[0]
    shifts = random.normal(0, 100, (40, 1, 3)) + far
    captured = at_rest @ turns + shifts
    back = (captured - shifts) @ turns.transpose(0, 2, 1)
    assert np.ptp(back, axis=0).any()
    face = Trajectories(positions=back + far, markers=tuple("abcdefg"), rate=60.0)
    text = r"no marker moves in 40 frames: .* coordinate is \de-\d\d mm; up to 1e-06 mm is rounding"
    with pytest.raises(Refusal, match=text):
        features_of(face)


@pytest.mark.parametrize(("spread", "moves"), [(0.9e-6, False), (1.1e-6, True)])
def test_what_is_rounding_is_decided_in_millimetres(
    face: Trajectories, spread: float, moves: bool
) -> None:
    positions = make_rigid(face).positions.copy()
    positions[:, 4, 1] += spread * np.where(np.arange(90) % 2, 1.0, -1.0)
    if moves:
        features = features_of(replace(face, positions=positions))
        place = 3 * features.markers.index(face.markers[4]) + 1
        assert np.flatnonzero(features.values.any(axis=0)).tolist() == [place]
        assert features.spread[place] == pytest.approx(spread, rel=1e-4)
    else:
        with pytest.raises(Refusal, match="no marker moves"):
            features_of(replace(face, positions=positions))


def test_what_moves_by_rounding_beside_others_does_not_move_at_all(face: Trajectories) -> None:
    positions = face.positions.copy()
    positions[:, [2, 5]] = make_rigid(face).positions[:, [2, 5]]
    positions[:, 7, 2] = make_rigid(face).positions[:, 7, 2]
    features = features_of(replace(face, positions=positions))
    names = [*np.repeat(features.markers, 3)]
    still = [names[place] for place in np.flatnonzero(features.still)]
    assert sorted(still) == sorted(3 * [face.markers[2], face.markers[5]] + [face.markers[7]])
    assert not features.values[:, features.still].any()
    assert features.variances[features.markers.index(face.markers[2])] == 0.0


def test_missing_samples_are_refused_with_their_counts(face: Trajectories) -> None:
    positions, gaps = face.positions.copy(), np.zeros(face.origin.shape, bool)
    gaps[3:7, 1] = gaps[5, 4] = True
    positions[gaps] = np.nan
    gappy = face.with_samples(positions, changed=gaps, origin=Origin.MISSING)
    text = r"5 of 990 are missing, in 2 of 11 markers, most in 'lip_right' \(4\); fill them first"
    with pytest.raises(Refusal, match=text):
        features_of(gappy)


def test_filled_samples_count_as_present(face: Trajectories) -> None:
    filled = replace(face, origin=np.full_like(face.origin, Origin.FILLED))
    assert np.array_equal(features_of(filled).values, features_of(face).values)


@pytest.mark.parametrize(
    ("positions", "text"),
    [
        (np.zeros((1, 2, 3)), "two frames to see what moves, there are 1"),
        (np.zeros((0, 2, 3)), "two frames to see what moves, there are 0"),
        (np.full((9, 2, 3), 1234.567), "no marker moves in 9 frames"),
        (np.zeros((9, 0, 3)), "needs a marker, there is none"),
    ],
)
def test_what_shows_no_motion_is_refused(positions: NDArray[np.float64], text: str) -> None:
    names = ("a", "b")[: positions.shape[1]]
    with pytest.raises(Refusal, match=text):
        features_of(Trajectories(positions=positions, markers=names, rate=60.0))
