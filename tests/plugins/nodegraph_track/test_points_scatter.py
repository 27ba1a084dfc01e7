"""Points lose their names and nothing else, but for what is dropped and added on purpose."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from nodegraph_mocap import Detections, Trajectories
from nodegraph_track.points_scatter import GHOST_MARGIN, scatter
from tests.plugins.recordings import make_recording


def recording(frames: int = 50, markers: int = 20) -> Trajectories:
    random = np.random.default_rng(5)
    positions = random.normal(size=(frames, markers, 3)) * [60, 80, 20]
    positions[random.random((frames, markers)) < 0.1] = np.nan
    positions[7] = np.nan
    return make_recording(positions)


def rows(detections: Detections) -> set[tuple[float, ...]]:
    frame = np.repeat(np.arange(detections.frames), np.diff(detections.offsets))
    return set(map(tuple, np.column_stack([frame, detections.points])))


def samples(take: Trajectories) -> NDArray[np.float64]:
    return np.column_stack([np.nonzero(take.present)[0], take.positions[take.present]])


def test_every_present_sample_is_a_point_in_another_order() -> None:
    take = recording()
    detections, truth = scatter(take)
    assert truth is take
    assert detections.rate == take.rate
    assert rows(detections) == set(map(tuple, samples(take)))
    assert len(detections.points) == np.count_nonzero(take.present)
    assert not np.array_equal(detections.points, take.positions[take.present])


def test_as_many_are_dropped_and_added_as_asked() -> None:
    take = recording()
    every, count = set(map(tuple, samples(take))), np.count_nonzero(take.present)
    actual = rows(scatter(take, dropout=0.1, ghosts=0.05).detections)
    assert len(every & actual) == count - round(0.1 * count)
    assert len(actual - every) == round(0.05 * count)


def test_ghosts_lie_in_the_grown_box_of_their_frame() -> None:
    take = recording()
    ghosts = rows(scatter(take, ghosts=0.5).detections) - set(map(tuple, samples(take)))
    for frame, *place in ghosts:
        points = take.positions[int(frame)][take.present[int(frame)]]
        low, high = points.min(axis=0), points.max(axis=0)
        edge = GHOST_MARGIN * (high - low) + 1e-9
        assert np.all(place >= low - edge)
        assert np.all(place <= high + edge)


def test_one_share_does_not_move_what_the_other_draws() -> None:
    take = recording()
    every = set(map(tuple, samples(take)))
    alone, both = (
        rows(scatter(take, dropout=share, ghosts=0.1).detections) for share in (0.0, 0.2)
    )
    assert alone - every == both - every
    more = rows(scatter(take, dropout=0.4).detections)
    assert more < both & every
    assert both & every == rows(scatter(take, dropout=0.2).detections)
