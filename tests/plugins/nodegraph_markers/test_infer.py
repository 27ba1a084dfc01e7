"""A marker set is recovered from bare positions, in whatever pose, size and order."""

from __future__ import annotations

import warnings
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_files import sample_folder
from nodegraph_files.readers import read_recording
from nodegraph_markers.infer import edges_of, infer
from nodegraph_mocap import MarkerSet, Trajectories
from tests.plugins.nodegraph_markers.takes import face, quiet, read_take, turned, without_names

GUESSED = "names do not distinguish left and right"


def inferred(recording: Trajectories, seed: int = 0) -> MarkerSet:
    """Return what is inferred from a recording without names, in its own names."""
    bare = without_names(recording, seed)
    with quiet():
        result = infer(bare).marker_set
    order = np.random.default_rng(seed).permutation(len(recording.markers))
    own = {name: recording.markers[index] for name, index in zip(bare.markers, order, strict=True)}

    def couples(part: tuple[tuple[str, str], ...]) -> tuple[tuple[str, str], ...]:
        return tuple((own[first], own[second]) for first, second in part)

    return MarkerSet(
        markers=recording.markers,
        pairs=couples(result.pairs),
        midline=tuple(own[name] for name in result.midline),
        stable=tuple(own[name] for name in result.stable),
        edges=couples(result.edges),
    )


@pytest.mark.parametrize(("markers", "seed"), [(10, 0), (17, 1), (60, 2), (150, 0)])
@pytest.mark.parametrize("what", ["neutral", "captured"])
def test_pairs_sides_and_midline_of_made_faces(markers: int, seed: int, what: str) -> None:
    synthetic = face(seed=seed, seconds=3.0, markers=markers)
    result = inferred(getattr(synthetic, what))
    assert set(result.pairs) == set(synthetic.marker_set.pairs)
    assert set(result.midline) == set(synthetic.marker_set.midline)


@pytest.mark.parametrize("name", ["jaw", "cheeks", "take001"])
def test_pairs_sides_and_midline_of_real_and_animated_faces(name: str) -> None:
    recording, truth = read_take(name)
    result = inferred(recording)
    assert set(result.pairs) == set(truth.pairs)
    assert set(result.midline) == set(truth.midline)


def test_the_sample_face() -> None:
    given = read_recording(path=sample_folder("face"))
    assert given.marker_set is not None
    bare = replace(given, marker_set=None)
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # nothing is guessed, nothing is left over
        result = infer(bare)
    assert set(result.marker_set.pairs) == set(given.marker_set.pairs)
    assert set(result.marker_set.midline) == set(given.marker_set.midline)
    assert result.recording.marker_set is result.marker_set
    assert result.recording.positions is given.positions


def test_landmarks_hardly_move() -> None:
    for seed in range(2):
        synthetic = face(seed=seed, seconds=5.0)
        stable = infer(synthetic.captured).marker_set.stable
        turns, shifts = synthetic.head_motion.rotations, synthetic.head_motion.translations
        still = (synthetic.truth.positions - shifts[:, None]) @ turns
        motion = np.linalg.norm(still - np.median(still, axis=0), axis=2).mean(axis=0)
        chosen = motion[[synthetic.captured.markers.index(name) for name in stable]]
        assert 10 <= len(stable) <= 11
        assert chosen.max() < np.median(motion)


def test_edges_join_every_marker_to_its_neighbours() -> None:
    synthetic = face(seed=1)
    shape = dict(zip(synthetic.neutral.markers, synthetic.neutral.positions[0], strict=True))
    edges = infer(synthetic.neutral).marker_set.edges
    lengths = np.array([np.linalg.norm(shape[first] - shape[second]) for first, second in edges])
    assert {name for edge in edges for name in edge} == set(synthetic.neutral.markers)
    assert lengths.max() < 4 * np.median(lengths)
    known = {frozenset(edge) for edge in synthetic.marker_set.edges}
    assert len(known & {frozenset(edge) for edge in edges}) > 0.9 * len(known)


@pytest.mark.parametrize("scale", [0.1, 25.0])
def test_pose_size_and_order_do_not_matter(scale: float) -> None:
    given = face(seed=2, seconds=3.0).captured
    moved = turned(replace(given, positions=scale * given.positions))
    plain, other = (inferred(recording, seed) for seed, recording in enumerate((given, moved), 1))
    assert set(plain.pairs) == set(other.pairs)
    assert set(plain.midline) == set(other.midline)
    assert set(plain.stable) == set(other.stable)
    edges = [{frozenset(edge) for edge in result.edges} for result in (plain, other)]
    assert len(edges[0] ^ edges[1]) <= 2  # of two equally good diagonals, rounding takes one


def test_a_guess_of_sides_is_reported_and_names_are_believed() -> None:
    given = face(seed=0, seconds=3.0).captured
    with pytest.warns(UserWarning, match=GUESSED):
        infer(without_names(given))
    mirrored = replace(given, positions=given.positions * [-1.0, 1.0, 1.0])
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert set(infer(mirrored).marker_set.pairs) == set(infer(given).marker_set.pairs)


def test_a_pair_that_lies_the_other_way_round_than_it_is_named() -> None:
    given = face(seed=0, seconds=3.0).captured
    crossed = {"L_brow2": "R_brow2", "R_brow2": "L_brow2"}
    wrong = replace(given, markers=tuple(crossed.get(name, name) for name in given.markers))
    with pytest.warns(UserWarning, match="1 pairs lie the other way round than named: L_brow2"):
        markers = infer(wrong).marker_set
    assert ("L_brow2", "R_brow2") in markers.pairs


def test_what_has_no_partner_is_reported() -> None:
    given = face(seed=0, seconds=3.0).captured
    lacking = given.keep([name for name in given.markers if name != "R_cheek2"])
    with pytest.warns(UserWarning, match="1 of 59 markers have no .* L_cheek2; in the best plane"):
        markers = infer(lacking).marker_set
    assert len(markers.pairs) == 25


def test_a_marker_that_is_never_there_is_in_the_set_alone() -> None:
    given = face(seed=0, seconds=3.0).neutral
    positions = given.positions.copy()
    positions[:, given.markers.index("M_nose1")] = np.nan
    with pytest.warns(UserWarning, match="1 markers are never present"):
        result = infer(Trajectories(positions=positions, markers=given.markers, rate=60.0))
    assert "M_nose1" in result.marker_set.markers
    assert "M_nose1" not in result.marker_set.midline


def test_a_narrow_tolerance_leaves_more_alone() -> None:
    recording, truth = read_take("jaw")
    with quiet():
        assert len(infer(recording, tolerance=3.0).marker_set.pairs) < len(truth.pairs) / 2
        assert len(infer(recording, tolerance=14.0).marker_set.pairs) == len(truth.pairs)


def test_one_frame_has_no_landmarks() -> None:
    assert infer(face(seed=0, seconds=3.0).neutral).marker_set.stable == ()


def test_what_the_recording_knows_is_kept_and_only_the_rest_is_proposed() -> None:
    synthetic = face(seed=0, seconds=3.0)
    whole, known = synthetic.captured, synthetic.marker_set
    assert infer(whole, keep=True).recording is whole
    partly = replace(known, pairs=known.pairs[:3], midline=(), stable=())
    with pytest.warns(UserWarning, match="lacks them: stable landmarks$"):
        markers = infer(replace(whole, marker_set=partly), keep=True).marker_set
    assert markers == replace(partly, stable=infer(whole).marker_set.stable)
    bare = replace(whole, marker_set=None)
    with pytest.warns(UserWarning, match="pairs and midline, stable landmarks, edges"):
        assert infer(bare, keep=True).marker_set == infer(bare).marker_set


def test_a_body_is_poorly_symmetric(shoulder: Trajectories) -> None:
    with pytest.warns(
        UserWarning, match=r"symmetry is poor: .* within 2\d\.\d mm: .* mm of a mirror im"
    ):
        markers = infer(shoulder).marker_set
    assert len(markers.pairs) < 10


@pytest.mark.parametrize(
    ("positions", "what"),
    [
        (np.eye(3), "needs 4 markers that are ever present; there are 3"),
        (np.linspace([0.0, 0, 0], [30, 60, 90], 6), "the 6 markers lie on a line"),
        (np.random.default_rng(0).normal(0, 30, (6, 3)) * [1, 1, 0], "lie on a plane"),
        (np.ones((5, 3)), "lie on a line"),
        (np.full((5, 3), np.nan), "there are 0"),
    ],
)
def test_what_has_no_left_and_right(positions: Any, what: str) -> None:
    names = tuple("abcdef"[: len(positions)])
    with pytest.raises(Refusal, match=what):
        infer(Trajectories(positions=positions[None], markers=names, rate=60.0))


def test_a_square_lattice_is_joined_by_its_sides_and_one_diagonal_each() -> None:
    across, up = np.meshgrid(np.arange(5.0), np.arange(4.0))
    plane = np.stack([across.ravel(), up.ravel()], axis=1)
    edges = edges_of(plane)
    lengths = [np.linalg.norm(plane[first] - plane[second]) for first, second in edges]
    assert sum(np.isclose(lengths, 1.0)) == 5 * 3 + 4 * 4
    assert sum(np.isclose(lengths, np.sqrt(2))) == 4 * 3
    assert edges == sorted(edges)
    assert all(first < second for first, second in edges)


def test_a_hollow_of_the_outline_is_not_spanned() -> None:
    angles = np.linspace(0, np.pi, 19)
    ring = np.concatenate(
        [radius * np.stack([np.cos(angles), np.sin(angles)], 1) for radius in (9, 10)]
    )
    edges = edges_of(ring)
    assert max(np.linalg.norm(ring[first] - ring[second]) for first, second in edges) < 2.5
    assert {end for edge in edges for end in edge} == set(range(38))
