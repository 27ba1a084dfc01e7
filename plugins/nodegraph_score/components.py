"""Principal components of a recording, and what of them goes with the movement of the head."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

_NEAREST = 0.1
"""Smallest shift in time, as a share of the take."""

_ROUNDING = 1e-9
"""Share of the largest value below which a value is rounding."""


@dataclass(frozen=True)
class Components:
    """Principal components, the largest first.

    Attributes
    ----------
    scores : (n, K) array of float64
        Scores of mean 0 and length 1.
    sd : (K,) array of float64
        Their standard deviation, mm.
    directions : (K, 3 M) array of float64
        Directions of length 1: what moves with them.
    """

    scores: NDArray[np.float64]
    sd: NDArray[np.float64]
    directions: NDArray[np.float64]

    @property
    def shares(self) -> NDArray[np.float64]:
        """(K,), share of all variance."""
        return np.asarray(self.sd**2 / np.sum(self.sd**2))

    def part_of(self, positions: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return which share of each component's variance a part of the movement makes, (K,).

        Parameters
        ----------
        positions
            (n, M, 3), which with some other movement adds up to that of the components.
        """
        # cov(score, part of the score) / var(score): the shares of both parts add up to 1
        summed = self.scores.T @ positions.reshape(len(positions), -1)
        lengths = self.sd * np.sqrt(len(positions))
        return np.asarray(np.sum(summed * self.directions, axis=1) / lengths)


@dataclass(frozen=True)
class Movement:
    """The numbers of a pose that change, in n frames.

    Attributes
    ----------
    curves : (n, J) array of float64
        Curves of mean 0 and length 1.
    columns : (J,) array of int
        Their places among the given numbers.
    basis : (n, r) array of float64
        Orthonormal, of what they span.
    """

    curves: NDArray[np.float64]
    columns: NDArray[np.intp]
    basis: NDArray[np.float64]

    @property
    def conclusive(self) -> bool:
        """Whether a correlation with it could be less than 1, and more than 0."""
        frames, rank = self.basis.shape
        return bool(0 < rank < frames - 1)


def principal(positions: NDArray[np.float64]) -> Components:
    """Return the components of (n, M, 3) complete frames that are more than rounding."""
    flat = positions.reshape(len(positions), 3 * positions.shape[1])
    if not flat.size:
        return Components(np.empty((len(flat), 0)), np.empty(0), np.empty((0, flat.shape[1])))
    scores, lengths, directions = np.linalg.svd(flat - flat.mean(axis=0), full_matrices=False)
    # A face that is far from the origin has the rounding of that distance.
    real = lengths > _ROUNDING * max(lengths.max(initial=0.0), np.abs(flat).max(initial=0.0))
    return Components(scores[:, real], lengths[real] / np.sqrt(len(flat)), directions[real])


def movement(numbers: NDArray[np.float64]) -> Movement:
    """Return what changes in (n, J) numbers per frame."""
    middle = numbers.sum(axis=0) / max(len(numbers), 1)
    centred = numbers - middle
    lengths = np.linalg.norm(centred, axis=0)
    size = np.sqrt(len(numbers)) * np.maximum(np.abs(numbers).max(axis=0, initial=0.0), 1.0)
    columns = np.flatnonzero(lengths > _ROUNDING * size)
    curves = centred[:, columns] / lengths[columns]
    basis, weights, _ = np.linalg.svd(curves, full_matrices=False)
    return Movement(curves, columns, basis[:, weights > _ROUNDING])


def explained(scores: NDArray[np.float64], movement: Movement) -> NDArray[np.float64]:
    """Return R^2 of each of (n, K) scores with the movement."""
    return np.asarray(np.minimum(np.sum((movement.basis.T @ scores) ** 2, axis=0), 1.0))


def by_chance(scores: NDArray[np.float64], movement: Movement) -> NDArray[np.float64]:
    """Return the R^2 of (n, K) scores with movement that does not belong to them, (shifts, K).

    It is the movement shifted in time, around the end, by a tenth of the take and more: what is
    left of R^2 is what curves so slow have in common by chance.
    """
    from scipy.fft import irfft, rfft

    frames = len(scores)
    squared = np.zeros(scores.shape)
    transformed = rfft(scores, axis=0)
    for column in movement.basis.T:
        product = rfft(column)[:, None].conj() * transformed
        squared += irfft(product, frames, axis=0) ** 2
    nearest = max(round(_NEAREST * frames), 1)
    return np.asarray(np.minimum(squared[nearest : frames - nearest + 1], 1.0))
