"""Principal feature analysis: a marker for each cluster of features that move alike."""

from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Literal, NamedTuple, get_args

import numpy as np
from pydantic import Field

from nodegraph import Refusal, node
from nodegraph_mocap import Selection, Trajectories
from nodegraph_select.checks import check_share, check_whole
from nodegraph_select.features import Features, features_of
from nodegraph_select.pairs import Pairs, in_order, membership, pairs_of, sizes

if TYPE_CHECKING:
    from numpy.typing import NDArray

Stability = Literal["sum", "mean", "medoid"]

_AT_ONCE = 256
"""Selections that are compared with all others at once, so that many runs fit into memory."""
_DIGITS = 12
"""To which sums of likenesses are rounded: equal ones may come in another order."""

_ROUNDING = 1e-12
"""Of the sum of variances: what lies so close to a share has reached it."""

COLUMNS = (
    "k", "run", "selection", "markers", "pairs", "clusters", "inertia", "rounds", "sum", "mean",
    "medoid",
)  # fmt: skip


class _Clusters(NamedTuple):
    """The results of R runs.

    Attributes
    ----------
    nearest : (R, k) array of int
        The feature nearest to each cluster's mean; -1 for a cluster that was dropped.
    inertia : (R,) array of float64
    rounds : (R,) array of int
    unsettled : (R,) array of bool
        Whether a run was stopped before it had settled.
    """

    nearest: NDArray[np.int64]
    inertia: NDArray[np.float64]
    rounds: NDArray[np.int64]
    unsettled: NDArray[np.bool_]


@node("select.pfa", cite=("wellein2007", "cohen2002", "lu2007", "lloyd1982"))
def pfa(
    recording: Trajectories,
    *,
    k: Annotated[int, Field(ge=1)],
    variance: Annotated[float, Field(gt=0.0, le=1.0)] = 0.98,
    runs: Annotated[int, Field(ge=1)] = 1000,
    stability: Stability = "sum",
    standardize: bool = False,
    absolute: bool = False,
    seed: Annotated[int, Field(ge=0)] = 0,
) -> Selection:
    """Choose markers by principal feature analysis (Wellein et al., after Cohen et al.).

    A marker is three features, its coordinates. Of the covariance C of all p features over the
    take, the q eigenvectors of largest eigenvalue are kept that together have the share
    `variance` of its trace, q as small as can be; row i of this p x q matrix stands for feature
    i. Features that move alike have rows that lie together, so the rows are clustered:

    1. k-means (Lloyd) from k different rows drawn at random, until no row changes its cluster
       (or 300 rounds); a row that is equally far from two means goes to the first, and a cluster
       that loses all its rows is dropped.
    2. In each cluster, the feature whose row is nearest to the mean is chosen, the lowest of
       equals; features are in the order of the markers' names, x, y, z of each.
    3. A chosen feature chooses its marker, and a marker the pair that it is in, by the
       recording's marker set; markers of the midline are alone. So are those that the marker set
       has neither in a pair nor on the midline, which a warning names.
    4. All of this `runs` times. The frequency of a pair is the share of runs that chose it; the
       most stable of the runs' selections is the result; of equally stable ones that with fewer
       markers, then that of the earlier run.

    Runs hardly ever agree, so the result says how many of their selections differ. k clusters
    choose at most k pairs, and fewer where they choose several coordinates of one: of the 60
    markers of the three faces that are shipped, 20 at k = 10, 47 to 50 at k = 35.

    Head motion must have been removed, as by `align.procrustes`: it moves all markers alike, and
    more than any expression. The same seed gives the same answer on any number of threads, but
    for the last digit of `inertia` where BLAS, outside of a run, has several; it does not depend
    on the order of the markers, nor on where the origin lies or on the unit; but it depends on
    the axes, because features are coordinates.

    Parameters
    ----------
    recording
        Trajectories with every sample, head motion removed.
    k
        Number of clusters of features; `select.pfa` alone counts these, its rivals count markers.
    variance
        Share of the variance that the eigenvectors kept must have.
    runs
        How many random starts are clustered.
    stability
        The number that is highest for the most stable selection. sum (the text): the sum of its
        pairs' frequencies, which favours large selections. mean: their mean, which favours small
        ones. medoid: its mean likeness to the selections of all runs, as the Jaccard index (pairs
        that both have, by pairs that either has).
    standardize
        Whether each feature is divided by its standard deviation first, so that those that move
        little count as much as others; one that does not move by more than rounding (a standard
        deviation of 1e-6 mm, or 1e-9 of the largest) stays 0, with a warning.
    absolute
        Whether the rows' absolute values are clustered, so that features that move oppositely
        are alike, too.
    seed
        Starts of the runs; a run's start depends on the seed, on k and on the run's number.

    Returns
    -------
    Selection
        The markers chosen, in the order of the recording; every pair with its frequency; and a
        row per run:

        ========= =====================================================================
        k         as given
        run       its number, from 0
        selection number of its selection, in the order in which they first came up: runs
                  with equal numbers chose the same
        markers   how many markers it chose
        pairs     how many pairs, those of one marker counted
        clusters  how many clusters were not dropped
        inertia   sum of the squared distances of rows from their clusters' means
        rounds    how often rows were assigned until none changed
        sum       sum of the frequencies of the pairs that it chose
        mean      mean of these
        medoid    mean Jaccard index of its selection and those of all runs
        ========= =====================================================================

    Raises
    ------
    Refusal
        If samples are missing, there are fewer than two frames, nothing moves by more than
        rounding, or k is larger than the number of features.
    ValueError
        If the marker set puts a marker into two pairs, or a setting is out of range.
    """
    _check_settings(k, variance, runs, stability, seed)
    features, pairs = features_of(recording), pairs_of(recording)
    rows = leading_vectors(features, variance=variance, standardize=standardize)
    if k > len(rows):
        raise Refusal(
            f"k = {k} clusters need as many features: {len(features.markers)} markers have "
            f"{len(rows)}"
        )
    clusters = _clustered(np.abs(rows) if absolute else rows, k, runs, seed)
    chosen = _chosen_pairs(clusters.nearest, membership(pairs, features.markers))
    markers, stable = chosen @ sizes(pairs), stabilities(chosen)
    best = stable.best(stability, markers)
    _warn(stable, best, clusters)
    return Selection(
        chosen=in_order(recording, _named(pairs, chosen[best])),
        pairs=pairs,
        frequencies=stable.frequencies,
        columns=COLUMNS,
        history=_history(k, clusters, chosen, markers, stable),
    )


def _check_settings(k: int, variance: float, runs: int, stability: str, seed: int) -> None:
    check_whole("k", k, 1)
    check_share("variance", variance)
    check_whole("runs", runs, 1)
    check_whole("seed", seed, 0)
    if stability not in get_args(Stability):
        raise ValueError(f"stability must be sum, mean or medoid, got {stability!r}")


def _clustered(rows: NDArray[np.float64], k: int, runs: int, seed: int) -> _Clusters:
    """Return clusters of rows from random starts."""
    from nodegraph_select import kmeans_kernel

    # row `run` of the draws is the same however many runs follow
    draws = np.random.default_rng([seed, k]).random((runs, k))
    nearest, inertia, rounds = kmeans_kernel.restarts(rows, draws)
    return _Clusters(nearest, inertia, rounds, rounds >= kmeans_kernel.CAP)


def _chosen_pairs(nearest: NDArray[np.int64], pair: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which pairs each run chose, (R, P), from the features nearest to its means."""
    run, cluster = np.nonzero(nearest >= 0)
    chosen = np.zeros((len(nearest), int(pair.max()) + 1), dtype=np.bool_)
    chosen[run, pair[nearest[run, cluster] // 3]] = True
    return chosen


def _named(pairs: Pairs, chosen: NDArray[np.bool_]) -> Pairs:
    return tuple(pairs[number] for number in np.flatnonzero(chosen))


def _history(
    k: int,
    clustered: _Clusters,
    chosen: NDArray[np.bool_],
    markers: NDArray[np.intp],
    stable: Stabilities,
) -> NDArray[np.float64]:
    """Return a row per run, its columns `COLUMNS`."""
    runs = len(chosen)
    pairs, clusters = (
        np.count_nonzero(chosen, axis=1),
        np.count_nonzero(clustered.nearest >= 0, axis=1),
    )
    columns = (
        np.full(runs, k), np.arange(runs), stable.same, markers, pairs, clusters, clustered.inertia,
        clustered.rounds, stable.sum, stable.mean, stable.medoid,
    )  # fmt: skip
    return np.stack(columns, axis=1).astype(np.float64)


def _warn(stable: Stabilities, best: int, clusters: _Clusters) -> None:
    runs = len(clusters.nearest)
    same = np.count_nonzero(stable.same == stable.same[best])
    notes = [
        f"{stable.distinct} of {runs} runs' selections are distinct; the most stable one is that "
        f"of {same} {'run' if same == 1 else 'runs'}"
    ]
    dropped = np.count_nonzero((clusters.nearest < 0).any(axis=1))
    if dropped:
        notes.append(f"{dropped} runs dropped clusters that had lost all their rows")
    if clusters.unsettled.any():
        unsettled = np.count_nonzero(clusters.unsettled)
        notes.append(f"{unsettled} runs had not settled when they were stopped")
    warnings.warn("; ".join(notes), stacklevel=3)


def leading_vectors(
    features: Features, *, variance: float, standardize: bool
) -> NDArray[np.float64]:
    """Return the (p, q) matrix of the first q eigenvectors of the features' covariance.

    q is the smallest number whose eigenvalues, largest first, have that share of the sum of all.

    Parameters
    ----------
    features
        p of them.
    variance
        The share, above 0 and up to 1.
    standardize
        Whether each feature is divided by its standard deviation first, which makes the
        covariance a correlation. One that does not move stays 0, with a warning.
    """
    values = _standardized(features) if standardize else features.values
    eigenvalues, vectors = np.linalg.eigh(values.T @ values / len(values))
    shares = np.maximum(eigenvalues[::-1], 0.0)
    reached = np.cumsum(shares) / shares.sum()
    kept = 1 + int(np.searchsorted(reached, min(variance, reached[-1]) - _ROUNDING))
    return np.ascontiguousarray(vectors[:, ::-1][:, :kept])


def _standardized(features: Features) -> NDArray[np.float64]:
    spread, still = features.spread, features.still
    if still.any():
        markers = sorted({features.markers[feature // 3] for feature in np.flatnonzero(still)})
        warnings.warn(
            f"{np.count_nonzero(still)} of {still.size} features do not move and cannot be "
            f"standardized, they stay 0: coordinates of {', '.join(markers)}",
            stacklevel=4,
        )
    return np.asarray(np.where(still, 0.0, features.values / np.where(still, 1.0, spread)))


@dataclass(frozen=True, eq=False)
class Stabilities:
    """The shares of runs that chose each pair, and the stability of each of R selections.

    Attributes
    ----------
    frequencies : (P,) array of float64
        Share of the selections that have each pair.
    sum, mean : (R,) array of float64
        Sum and mean of the frequencies of a selection's pairs.
    medoid : (R,) array of float64
        Mean Jaccard index, shared pairs by pairs of either, of a selection and each of all R.
    same : (R,) array of int
        The number of the selection, equal ones having the same, counted as they first come.
    """

    frequencies: NDArray[np.float64]
    sum: NDArray[np.float64]
    mean: NDArray[np.float64]
    medoid: NDArray[np.float64]
    same: NDArray[np.intp]

    @property
    def distinct(self) -> int:
        """Number of selections that differ."""
        return int(self.same.max()) + 1

    def best(self, stability: Stability, markers: NDArray[np.intp]) -> int:
        """Return the most stable selection; of equals one of fewer markers, then the first."""
        score: NDArray[np.float64] = getattr(self, stability)
        return int(np.lexsort((np.arange(len(score)), markers, -score))[0])


def stabilities(chosen: NDArray[np.bool_]) -> Stabilities:
    """Return how stable selections are.

    Parameters
    ----------
    chosen : (R, P) array of bool
        Whether each selection has each pair; it has one at least.
    """
    runs = len(chosen)
    counts = np.count_nonzero(chosen, axis=0)
    # sums of whole numbers: the same in any order, so that equals are equal
    total = chosen @ counts
    same, kinds, how_often = _kinds(chosen)
    return Stabilities(
        frequencies=counts / runs,
        sum=total / runs,
        mean=total / np.count_nonzero(chosen, axis=1) / runs,
        medoid=np.round(_mean_likeness(kinds, how_often), _DIGITS)[same],
        same=same,
    )


def _kinds(
    chosen: NDArray[np.bool_],
) -> tuple[NDArray[np.intp], NDArray[np.bool_], NDArray[np.intp]]:
    """Return the number of each selection's kind, the kinds, and how often each came."""
    packed = np.packbits(chosen, axis=1)
    _, first, inverse, counts = np.unique(
        packed, axis=0, return_index=True, return_inverse=True, return_counts=True
    )
    order = np.argsort(first)
    number = np.empty_like(order)
    number[order] = np.arange(len(order))
    return number[inverse.reshape(-1)], chosen[first[order]], counts[order]


def _mean_likeness(kinds: NDArray[np.bool_], how_often: NDArray[np.intp]) -> NDArray[np.float64]:
    """Return each kind's mean Jaccard index with all selections."""
    pairs = kinds.astype(np.float64)
    size = pairs.sum(axis=1)
    likeness = np.empty(len(pairs))
    for start in range(0, len(pairs), _AT_ONCE):
        some = slice(start, start + _AT_ONCE)
        shared = pairs[some] @ pairs.T
        likeness[some] = shared / (size[some, None] + size - shared) @ how_often
    return np.asarray(likeness / how_often.sum())
