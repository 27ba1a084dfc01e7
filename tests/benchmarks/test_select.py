"""Principal feature analysis of 60 markers: a loop over scikit-learn beside the compiled runs.

The loop is what the method's text makes one write: `KMeans` from one random start, then the row
nearest to each mean. It is timed as scikit-learn comes, which shares a run among all threads, and
held to one thread. The sweep, 1,000 runs for every k there is, would take the loop an hour.
"""

from __future__ import annotations

import os
import warnings
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_mocap import Trajectories
from nodegraph_select import kmeans_kernel
from nodegraph_select.features import features_of
from nodegraph_select.pfa import leading_vectors, pfa
from tests.benchmarks.conftest import Clock
from tests.plugins.recordings import make_recording

FRAMES, MARKERS, MOVEMENTS, RUNS, FEW = 600, 60, 12, 1000, 50
SIZES = (10, 35, 90)
Rows = NDArray[np.float64]


def face() -> Trajectories:
    """Markers that a dozen movements of one strength drive, so that twelve components count."""
    random = np.random.default_rng(0)
    time = np.cumsum(random.normal(0, 1, (FRAMES, MOVEMENTS)), axis=0)
    time = np.linalg.qr(time - time.mean(axis=0))[0] * 100.0
    reach = random.normal(0, 1, (MOVEMENTS, MARKERS, 3))
    return make_recording(np.einsum("tk,kmc->tmc", time, reach))


def rows() -> Rows:
    synthetic = leading_vectors(features_of(face()), variance=0.98, standardize=False)
    assert synthetic.shape == (3 * MARKERS, MOVEMENTS)
    return synthetic


def compiled(table: Rows, k: int) -> Callable[[], Any]:
    draws = np.random.default_rng([0, k]).random((RUNS, k))
    return lambda: kmeans_kernel.restarts(table, draws)[1]


def with_sklearn(table: Rows, k: int, runs: int, **settings: object) -> Callable[[], Any]:
    from sklearn.cluster import KMeans
    from sklearn.metrics import pairwise_distances_argmin

    def loop() -> object:
        inertia = np.empty(runs)
        for run in range(runs):
            clusters = KMeans(k, init="random", n_init=1, random_state=run, **settings).fit(table)
            pairwise_distances_argmin(clusters.cluster_centers_, table)
            inertia[run] = clusters.inertia_
        return inertia

    return loop


@pytest.mark.parametrize("k", SIZES)
def test_compiled_runs(k: int, clock: Clock) -> None:
    result = clock(_case(k), "nodegraph", "us/run", compiled(rows(), k), per=RUNS, rounds=10)
    assert len(result) == RUNS


@pytest.mark.parametrize("k", SIZES)
@pytest.mark.parametrize("threads", ["all", "one"])
def test_loop_over_scikit_learn(k: int, threads: str, clock: Clock) -> None:
    from threadpoolctl import threadpool_limits

    run = with_sklearn(rows(), k, FEW)
    with threadpool_limits(1) if threads == "one" else nullcontext():
        result = clock(
            _case(k), f"scikit-learn, {threads} threads", "us/run", run, per=FEW, rounds=3
        )
    assert len(result) == FEW


@pytest.mark.parametrize("k", SIZES)
def test_both_reach_the_same_inertia(k: int, tables: Any) -> None:
    from scipy.stats import ks_2samp
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1):
        theirs = with_sklearn(rows(), k, RUNS, tol=0.0)()
    ours = compiled(rows(), k)()
    likely = ks_2samp(ours, theirs).pvalue
    tables.put(f"{_case(k)}: inertia", "nodegraph", "mean", float(ours.mean()))
    tables.put(f"{_case(k)}: inertia", "scikit-learn", "mean", float(theirs.mean()))
    assert likely > 0.01


def test_every_k(clock: Clock) -> None:
    from threadpoolctl import threadpool_limits

    recording = face()

    def sweep() -> int:
        """As in a run: as many steps at a time as there are processors, each with one thread."""
        pool = ThreadPoolExecutor(os.cpu_count())
        with warnings.catch_warnings(), threadpool_limits(1), pool:
            warnings.simplefilter("ignore")
            every = range(1, 3 * MARKERS + 1)
            return len(list(pool.map(lambda k: pfa(recording, k=k, runs=RUNS), every)))

    case = "select.pfa, 1,000 runs for every k from 1 to 180"
    result = clock(case, "nodegraph, all threads", "s", sweep, scale=1.0, rounds=1)
    assert result == 3 * MARKERS


def _case(k: int) -> str:
    return f"k-means of 180 x 12, k = {k}"
