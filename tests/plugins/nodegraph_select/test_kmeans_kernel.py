"""The compiled k-means is the textbook's, from starts that are all equally likely."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.typing import NDArray
from scipy.stats import chisquare, ks_2samp

from nodegraph_select import kmeans_kernel
from tests.plugins.kernels import run_as_python

Numbers = NDArray[np.float64]


def rows_of(seed: int, count: int = 40, dimensions: int = 5) -> Numbers:
    """Rows of an orthonormal matrix, as of principal components, in loose groups."""
    random = np.random.default_rng(seed)
    data = random.normal(size=(200, dimensions)) @ random.gamma(0.5, 1, (dimensions, count))
    data += random.normal(0, 0.2, data.shape)
    return np.ascontiguousarray(np.linalg.eigh(data.T @ data)[1][:, -dimensions:])


def start_of(draws: Numbers, count: int) -> list[int]:
    """Deal cards: each draw picks one of those that are left."""
    order = list(range(count))
    for place, draw in enumerate(draws):
        other = place + int(draw * (count - place))
        order[place], order[other] = order[other], order[place]
    return order[: len(draws)]


def plain(rows: Numbers, start: list[int]) -> tuple[list[int], float, int]:
    """Lloyd's rounds as they are written, and the row nearest to each mean."""
    means: dict[int, Numbers] = {value: rows[place] for value, place in enumerate(start)}
    before: list[int] | None = None
    for rounds in range(1000):
        squared = {value: ((rows - mean) ** 2).sum(axis=1) for value, mean in means.items()}
        cluster = [min(means, key=lambda value: squared[value][row]) for row in range(len(rows))]
        done = rounds
        if cluster == before:
            break
        before = cluster
        inside = {
            value: [row for row in range(len(rows)) if cluster[row] == value] for value in means
        }
        means = {value: rows[some].mean(axis=0) for value, some in inside.items() if some}
    nearest = [-1] * len(start)
    for first, mean in means.items():
        apart = {row: float(np.linalg.norm(rows[row] - mean)) for row in inside[first]}
        least = min(apart.values())
        nearest[first] = min(row for row, far in apart.items() if far <= least + 1e-12)
    inertia = sum(float(((rows[row] - means[cluster[row]]) ** 2).sum()) for row in range(len(rows)))
    return nearest, inertia, done


def same_as_plain(rows: Numbers, draws: Numbers) -> None:
    nearest, inertia, rounds = kmeans_kernel.restarts(rows, draws)
    for run, drawn in enumerate(draws):
        expected = plain(rows, start_of(drawn, len(rows)))
        assert nearest[run].tolist() == expected[0]
        assert inertia[run] == pytest.approx(expected[1], rel=1e-9, abs=1e-15)
        assert rounds[run] == expected[2]


@pytest.mark.parametrize("dimensions", [1, 2, 3, 4, 7])
@pytest.mark.parametrize("k", [1, 2, 9, 25, 39, 40])
def test_every_run_is_the_plain_one(k: int, dimensions: int) -> None:
    draws = np.random.default_rng([k, dimensions]).random((4, k))
    same_as_plain(rows_of(dimensions, dimensions=dimensions), draws)


@given(st.data())
def test_on_a_grid_where_most_rows_are_equal_and_most_distances_too(data: st.DataObject) -> None:
    count = data.draw(st.integers(1, 12))
    cells = data.draw(st.lists(st.integers(0, 2), min_size=2 * count, max_size=2 * count))
    rows = np.array(cells, dtype=np.float64).reshape(count, 2)
    k = data.draw(st.integers(1, count))
    draws = np.random.default_rng(data.draw(st.integers(0, 999))).random((3, k))
    same_as_plain(rows, draws)


@pytest.mark.parametrize(
    ("count", "dimensions", "k"), [(5, 2, 0), (5, 2, 6), (5, 0, 2), (0, 2, 1), (0, 0, 0)]
)
def test_what_would_lead_out_of_the_arrays_is_refused(count: int, dimensions: int, k: int) -> None:
    with pytest.raises(ValueError, match="from one cluster up to one a row"):
        kmeans_kernel.restarts(np.ones((count, dimensions)), np.zeros((3, k)))


@pytest.mark.parametrize("draw", [1.0, -0.1, np.nan, np.inf])
def test_draws_that_are_none_are_refused(draw: float) -> None:
    with pytest.raises(ValueError, match="draws must be from 0 up to but not 1"):
        kmeans_kernel.restarts(np.ones((5, 2)), np.array([[0.5, draw]]))


def test_no_runs_find_nothing() -> None:
    selection = kmeans_kernel.restarts(np.ones((5, 2)), np.zeros((0, 3)))
    assert [value.shape for value in selection] == [(0, 3), (0,), (0,)]


def test_equal_rows_drop_all_clusters_but_the_first() -> None:
    rows = np.full((6, 3), 0.3)
    nearest, inertia, rounds = kmeans_kernel.restarts(rows, np.zeros((1, 4)))
    assert nearest.tolist() == [[0, -1, -1, -1]]
    assert inertia[0] == pytest.approx(0.0, abs=1e-30)
    assert rounds[0] == 1


def test_of_a_cluster_of_two_the_lower_one_is_nearest() -> None:
    random = np.random.default_rng(8)
    for _ in range(300):
        rows = np.ascontiguousarray(random.normal(0, 0.1, (2, 7)))
        nearest, _, _ = kmeans_kernel.restarts(rows, random.random((1, 1)))
        assert nearest[0, 0] == 0


def test_as_many_clusters_as_rows_leave_each_alone() -> None:
    rows = rows_of(3)
    nearest, inertia, _ = kmeans_kernel.restarts(rows, np.random.default_rng(0).random((50, 40)))
    assert np.array_equal(np.sort(nearest, axis=1), np.tile(np.arange(40), (50, 1)))
    assert np.all(inertia == 0)


def test_a_run_does_not_depend_on_the_others() -> None:
    rows, draws = rows_of(4), np.random.default_rng(5).random((30, 9))
    together = kmeans_kernel.restarts(rows, draws)
    for run in (0, 7, 29):
        alone = kmeans_kernel.restarts(rows, draws[run : run + 1])
        assert all(
            np.array_equal(many[run : run + 1], single)
            for many, single in zip(together, alone, strict=True)
        )


def test_every_start_is_equally_likely(monkeypatch: pytest.MonkeyPatch) -> None:
    order, seen = np.empty(5, np.int64), np.zeros((5, 5))
    run_as_python(monkeypatch, kmeans_kernel)
    for drawn in np.random.default_rng(1).random((20_000, 2)):
        kmeans_kernel._draw(order, drawn)
        seen[order[0], order[1]] += 1
    assert not np.diag(seen).any()
    assert chisquare(seen[~np.eye(5, dtype=bool)]).pvalue > 0.001


def test_it_stops_at_the_cap_with_rows_assigned_to_its_last_means(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    rows, cluster, least = rows_of(6, dimensions=4), np.empty(40, np.int64), np.empty(40)
    means, squared = rows[[0, 1, 2]].copy(), np.full((4, 40), np.inf)
    run_as_python(monkeypatch, kmeans_kernel)
    monkeypatch.setattr(kmeans_kernel, "CAP", 1)
    assert kmeans_kernel._settle(rows, rows.T.copy(), means, squared, cluster, least) == 1
    apart = ((rows[:, None] - means) ** 2).sum(axis=2)
    assert np.array_equal(cluster, apart.argmin(axis=1))
    assert least == pytest.approx(apart.min(axis=1), abs=1e-15)
    first = ((rows[:, None] - rows[:3]) ** 2).sum(axis=2).argmin(axis=1)
    assert means == pytest.approx(
        np.stack([rows[first == offset].mean(axis=0) for offset in range(3)])
    )


@pytest.mark.parametrize("k", [2, 12, 30])
def test_inertia_is_distributed_as_that_of_scikit_learn(k: int) -> None:
    from sklearn.cluster import KMeans
    from threadpoolctl import threadpool_limits

    rows, runs = rows_of(7, count=90, dimensions=8), 300
    _, ours, _ = kmeans_kernel.restarts(rows, np.random.default_rng([1, k]).random((runs, k)))
    with threadpool_limits(1):
        theirs = [
            KMeans(k, init="random", n_init=1, tol=0.0, random_state=run).fit(rows).inertia_
            for run in range(runs)
        ]
    assert ks_2samp(ours, theirs).pvalue > 0.01
