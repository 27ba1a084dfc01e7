"""Principal feature analysis, beside the method's text in plain sets and loops."""

from __future__ import annotations

import warnings
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from sklearn.metrics import pairwise_distances

from nodegraph import Refusal
from nodegraph.equality import difference
from nodegraph_mocap import Origin, Selection, Trajectories
from nodegraph_select.pfa import COLUMNS, pfa
from tests.plugins.nodegraph_select.faces import columns_of, make_face, make_rigid
from tests.plugins.recordings import make_recording, quietly


def plain_runs(
    face: Trajectories, k: int, runs: int, seed: int, *, standardize: bool, absolute: bool
) -> tuple[list[frozenset[str]], list[float]]:
    """Return the markers that each run chooses, and its inertia."""
    names = sorted(face.markers)
    features = [
        face.positions[:, face.markers.index(name), axis] for name in names for axis in range(3)
    ]
    table = np.array(features)
    covariance = np.corrcoef(table) if standardize else np.cov(table)
    vectors, share, _ = np.linalg.svd(covariance)
    q = next(q for q in range(1, len(share) + 1) if share[:q].sum() >= 0.98 * share.sum())
    rows = np.abs(vectors[:, :q]) if absolute else vectors[:, :q]
    draws = np.random.default_rng([seed, k]).random((runs, k))
    chosen, inertia = [], []
    for drawn in draws:
        actual, within = plain_clusters(rows, drawn)
        some = {names[feature // 3] for feature in actual}
        assert face.marker_set is not None
        for pair in face.marker_set.pairs:
            if some & set(pair):
                some |= set(pair)
        chosen.append(frozenset(some))
        inertia.append(within)
    return chosen, inertia


def plain_clusters(
    rows: NDArray[np.float64], drawn: NDArray[np.float64]
) -> tuple[list[int], float]:
    left = list(range(len(rows)))
    for place, draw in enumerate(drawn):
        second = place + int(draw * (len(rows) - place))
        left[place], left[second] = left[second], left[place]
    means = rows[left[: len(drawn)]]
    before = None
    while True:
        apart = pairwise_distances(rows, means)
        cluster = apart.argmin(axis=1)
        if before is not None and np.array_equal(cluster, before):
            break
        before = cluster
        means = np.array([rows[cluster == value].mean(axis=0) for value in np.unique(cluster)])
        before = np.unique(cluster, return_inverse=True)[1]
    apart = pairwise_distances(rows, means)
    pieces = []
    for first in range(len(means)):
        inside = np.flatnonzero(cluster == first)
        near = apart[inside, first]
        pieces.append(int(inside[np.flatnonzero(near <= near.min() + 1e-7)[0]]))
    return pieces, float((apart.min(axis=1) ** 2).sum())


@pytest.mark.parametrize("absolute", [False, True])
@pytest.mark.parametrize("standardize", [False, True])
@pytest.mark.parametrize("k", [1, 4, 11, 33])
def test_as_the_text_says_step_by_step(k: int, standardize: bool, absolute: bool) -> None:
    face, options = make_face(k), {"standardize": standardize, "absolute": absolute}
    runs = 12
    chosen, inertia = plain_runs(face, k, runs, 7, **options)
    selection = quietly(pfa, face, k=k, runs=runs, seed=7, **options)
    frequency = {pair: sum(pair[0] in value for value in chosen) / runs for pair in selection.pairs}
    assert selection.frequencies == pytest.approx(list(frequency.values()))
    pairs = [[pair for pair in selection.pairs if pair[0] in value] for value in chosen]
    sums = [round(sum(frequency[pair] for pair in some), 9) for some in pairs]
    best = min(range(runs), key=lambda run: (-sums[run], len(chosen[run]), run))
    assert set(selection.chosen) == chosen[best]
    actual = columns_of(selection)
    assert tuple(actual) == COLUMNS
    assert actual["sum"] == pytest.approx(sums)
    assert actual["mean"] == pytest.approx([a / len(b) for a, b in zip(sums, pairs, strict=True)])
    assert actual["inertia"] == pytest.approx(inertia, rel=1e-6, abs=1e-12)
    assert actual["markers"].tolist() == [len(value) for value in chosen]
    assert actual["pairs"].tolist() == [len(value) for value in pairs]
    order = list(dict.fromkeys(chosen))
    assert actual["selection"].tolist() == [order.index(value) for value in chosen]
    assert np.all(actual["k"] == k)
    assert actual["run"].tolist() == list(range(runs))


@pytest.mark.parametrize("stability", ["sum", "mean", "medoid"])
def test_the_most_stable_by_each_measure(face: Trajectories, stability: str) -> None:
    selection = quietly(pfa, face, k=8, runs=200, stability=stability)
    actual = columns_of(selection)
    ranked = sorted(
        zip(-actual[stability], actual["markers"], actual["run"], strict=True),
    )
    best = int(ranked[0][2])
    assert len(selection.chosen) == actual["markers"][best]
    assert selection.frequencies is not None
    inside = [pair[0] in selection.chosen for pair in selection.pairs]
    assert selection.frequencies[inside].sum() == pytest.approx(actual["sum"][best])


def test_sum_favours_large_selections_and_mean_small_ones(face: Trajectories) -> None:
    actual = columns_of(quietly(pfa, face, k=8))
    for measure, sign in (("sum", 1), ("mean", -1)):
        assert sign * np.corrcoef(actual[measure], actual["markers"])[0, 1] > 0.1
    sizes = [
        len(quietly(pfa, face, k=8, stability=value).chosen) for value in ("mean", "medoid", "sum")
    ]
    assert sizes[0] <= sizes[1] <= sizes[2]
    assert sizes[0] < sizes[2]


def test_it_tells_how_many_selections_differ(face: Trajectories) -> None:
    with pytest.warns(UserWarning, match="of 60 runs' selections are distinct") as caught:
        selection = pfa(face, k=8, runs=60)
    actual = columns_of(selection)["selection"]
    text = str(caught[0].message)
    assert text.startswith(f"{int(actual.max()) + 1} of 60 runs' selections are distinct; ")
    assert caught[0].filename == __file__


def test_one_run(face: Trajectories) -> None:
    with pytest.warns(UserWarning, match="1 of 1 runs' selections are distinct; .* of 1 run$"):
        selection = pfa(face, k=4, runs=1)
    assert selection.frequencies is not None
    assert [
        pair[0] in selection.chosen for pair in selection.pairs
    ] == selection.frequencies.astype(bool).tolist()
    assert selection.history is not None
    assert selection.history.shape == (1, len(COLUMNS))


def test_as_many_clusters_as_features_choose_every_marker(face: Trajectories) -> None:
    selection = quietly(pfa, face, k=33, runs=5)
    assert selection.chosen == face.markers
    assert selection.frequencies is not None
    assert np.all(selection.frequencies == 1)


def test_more_clusters_than_features_are_refused(face: Trajectories) -> None:
    with pytest.raises(Refusal, match=r"k = 34 clusters .*: 11 markers have 33"):
        pfa(face, k=34)


def test_one_marker_is_chosen(face: Trajectories) -> None:
    assert quietly(pfa, face.keep(["nose"]), k=2, runs=10).chosen == ("nose",)


def test_clusters_without_rows_are_dropped_and_reported(face: Trajectories) -> None:
    positions = face.positions.copy()
    positions[:, :6] = positions[0, :6]
    still = replace(face, positions=positions)
    with pytest.warns(UserWarning, match="; 50 runs dropped clusters that had lost all their rows"):
        selection = pfa(still, k=20, runs=50)
    assert np.all(columns_of(selection)["clusters"] < 20)


def test_missing_samples_are_refused(face: Trajectories) -> None:
    positions, gaps = face.positions.copy(), np.zeros(face.origin.shape, bool)
    gaps[3, 2] = True
    positions[3, 2] = np.nan
    gappy = face.with_samples(positions, changed=gaps, origin=Origin.MISSING)
    with pytest.raises(Refusal, match=r"1 of 990 are missing.*fill them first"):
        pfa(gappy, k=3)


@pytest.mark.parametrize(
    ("settings", "text"),
    [
        ({"stability": "median"}, "stability must be sum, mean or medoid, got 'median'"),
        ({"k": 0}, "k must be a whole number from 1 on, got 0"),
        ({"k": -1}, "k must be a whole number from 1 on, got -1"),
        ({"k": 2.5}, "k must be a whole number from 1 on, got 2.5"),
        ({"runs": 0}, "runs must be a whole number from 1 on, got 0"),
        ({"variance": 0.0}, "variance must be above 0 and at most 1, got 0.0"),
        ({"variance": 2.0}, "variance must be above 0 and at most 1, got 2.0"),
        ({"variance": np.nan}, "variance must be above 0 and at most 1, got nan"),
        ({"seed": -1}, "seed must be a whole number from 0 on, got -1"),
    ],
)
def test_choices_are_checked_in_plain_calls(
    face: Trajectories, settings: dict[str, Any], text: str
) -> None:
    with pytest.raises(ValueError, match=text):
        pfa(face, **{"k": 3, "runs": 5, **settings})


@pytest.mark.parametrize("standardize", [False, True])
def test_a_rigid_face_is_refused(face: Trajectories, standardize: bool) -> None:
    with pytest.raises(Refusal, match="no marker moves in 90 frames: the largest standard"):
        pfa(make_rigid(face), k=3, runs=5, standardize=standardize)


def test_standardizing_does_not_blow_up_rounding(face: Trajectories) -> None:
    selection = []
    for seed in range(2):
        positions = 1e-5 * face.positions
        positions[:, :6] = make_rigid(face, seed).positions[:, :6]
        still = replace(face, positions=positions)
        selection.append(quietly(pfa, still, k=5, runs=50, standardize=True))
    assert not difference(*selection)


def test_the_same_seed_gives_the_same_answer_and_another_one_another(face: Trajectories) -> None:
    first = quietly(pfa, face, k=8, runs=50, seed=3)
    assert not difference(first, quietly(pfa, face, k=8, runs=50, seed=3))
    assert difference(first, quietly(pfa, face, k=8, runs=50, seed=4))


def test_a_run_does_not_depend_on_how_many_follow(face: Trajectories) -> None:
    few, many = (columns_of(quietly(pfa, face, k=8, runs=runs)) for runs in (20, 90))
    for column in ("inertia", "markers", "selection", "rounds"):
        assert np.array_equal(few[column], many[column][:20])


@pytest.mark.parametrize("k", [10, 30, 50])
def test_the_answer_is_the_same_on_any_number_of_threads(k: int) -> None:
    """BLAS shares large matrices among threads, and so adds in another order."""
    from threadpoolctl import threadpool_limits

    face = large_face()
    with threadpool_limits(1):
        alone = quietly(pfa, face, k=k, runs=200)
    with threadpool_limits(2):
        shared = quietly(pfa, face, k=k, runs=200)
    assert not difference(without_inertia(alone), without_inertia(shared))
    assert columns_of(alone)["inertia"] == pytest.approx(columns_of(shared)["inertia"], rel=1e-14)


def large_face() -> Trajectories:
    """As many frames and markers as an optical take of half a minute has."""
    random = np.random.default_rng(0)
    time = np.cumsum(random.normal(0, 0.1, (1590, 12)), axis=0)
    reach = random.gamma(0.4, 1.0, (12, 41, 1)) * random.normal(0, 1, (12, 41, 3))
    positions = random.normal(0, 40, (41, 3)) + np.einsum("tk,kmc->tmc", time, reach)
    positions += random.normal(0, 0.05, positions.shape)
    return make_recording(positions)


def without_inertia(selection: Selection) -> Selection:
    assert selection.history is not None
    place = COLUMNS.index("inertia")
    columns = tuple(name for name in selection.columns if name != "inertia")
    return replace(selection, columns=columns, history=np.delete(selection.history, place, axis=1))


def test_calls_at_the_same_time_do_not_disturb_each_other(face: Trajectories) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        alone = [pfa(face, k=k, runs=100) for k in range(2, 10)]
        with ThreadPoolExecutor(4) as pool:
            together = list(pool.map(lambda k: pfa(face, k=k, runs=100), range(2, 10)))
    assert not difference(alone, together)


def test_the_order_of_the_markers_does_not_matter_even_to_a_run(face: Trajectories) -> None:
    selection = quietly(pfa, face, k=9, runs=80)
    order = np.random.default_rng(1).permutation(face.markers)
    again = quietly(pfa, face.keep(order), k=9, runs=80)
    assert not difference(replace(selection, chosen=()), replace(again, chosen=()))
    assert again.chosen == tuple(name for name in order if name in selection.chosen)
