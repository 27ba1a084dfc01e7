"""The take as a matrix of low rank, as far as its missing samples allow."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph_fill.soft_impute import soft_impute
from nodegraph_gaps.cut import cut
from tests.plugins.nodegraph_fill.plain_fills import driven
from tests.plugins.recordings import make_recording, real_take
from tests.studies import needs_recordings

Positions = NDArray[np.float64]
take = partial(driven, movements=3, noise=0.05)


def holed(seed: int = 3) -> Positions:
    """Gaps anywhere: no frame is complete."""
    positions = take(60, 7, seed=seed)
    random = np.random.default_rng(seed)
    positions[np.arange(60), random.integers(0, 7, 60)] = np.nan
    positions[10:20, 2] = positions[14:25, 3] = positions[50:, 4] = np.nan
    return positions


@pytest.mark.parametrize("shrinkage", [0.2, 0.02, 0.002])
def test_the_answer_is_optimal(shrinkage: float) -> None:
    """Where the sub-gradient of ``s |Z|_*`` and the residual cancel, a convex sum is least."""
    gappy = holed()
    filled = soft_impute(make_recording(gappy), shrinkage=shrinkage, ends="as_published").positions
    middle = np.nanmean(gappy, axis=0)
    full = (filled - middle).reshape(60, -1)
    missing = np.isnan(gappy).reshape(60, -1)
    s = shrinkage * np.linalg.norm(np.where(missing, 0.0, full), 2)
    u, values, v = np.linalg.svd(full, full_matrices=False)
    z = (u * np.maximum(values - s, 0.0)) @ v
    rank = int(np.count_nonzero(values > s))
    residual = np.where(missing, 0.0, full - z)
    # the missing entries are those of Z
    np.testing.assert_allclose(full[missing], z[missing], atol=1e-5)
    # the residual on the present entries is s times a sub-gradient of the nuclear norm at Z
    np.testing.assert_allclose(residual @ v[:rank].T, s * u[:, :rank], atol=1e-5)
    np.testing.assert_allclose(u[:, :rank].T @ residual, s * v[:rank], atol=1e-5)
    assert np.linalg.norm(residual, 2) <= s * (1 + 1e-6)
    assert rank > 0


@pytest.mark.parametrize("one_end", [False, True])
def test_the_ends_are_estimated_without_what_the_gap_lacks(one_end: bool) -> None:
    gappy = take(60, 7, seed=3)
    gappy[20:30, 0] = gappy[24:32, 5] = np.nan
    if one_end:
        gappy[30:, 0] = np.nan
    stop = 60 if one_end else 30
    free = soft_impute(make_recording(gappy), shrinkage=0.01).positions
    bent = soft_impute(make_recording(gappy), shrinkage=0.01, ends="met").positions
    middle = np.nanmean(gappy, axis=0).ravel()
    known = np.where(np.isnan(gappy).reshape(60, -1), 0.0, gappy.reshape(60, -1) - middle)
    full = free.reshape(60, -1) - middle
    _, values, v = np.linalg.svd(full, full_matrices=False)
    m = (v.T * np.maximum(1 - 0.01 * np.linalg.norm(known, 2) / values, 0.0)) @ v

    def mismatch(frame: int, *lacking: int) -> Positions:
        hidden = np.zeros((7, 3), dtype=bool)
        hidden[list(lacking)] = True
        out = hidden.ravel()
        message = m[np.ix_(out, ~out)] @ full[frame, ~out]
        estimate = np.linalg.solve(np.eye(out.sum()) - m[np.ix_(out, out)], message)
        return np.asarray(gappy[frame, 0] - middle[:3] - estimate[:3])

    first = mismatch(19, 0)
    last = 0.0 if one_end else mismatch(30, 0, 5)
    share = (np.arange(20, stop)[:, None] - 19) / (stop - 19)
    expected = free[20:stop, 0] + (1 - share) * first + share * last
    np.testing.assert_allclose(bent[20:stop, 0], expected, rtol=0, atol=1e-4)


@needs_recordings
@pytest.mark.parametrize(("name", "length", "most"), [("jaw", 15, 0.3), ("cheeks", 45, 0.9)])
def test_a_real_face_is_filled_as_well_as_is_known(name: str, length: int, most: float) -> None:
    gappy, truth, mask = cut(real_take(f"animface/{name}"), length=length, count=20, seed=0)
    off = (soft_impute(gappy, ends="met").positions - truth.positions)[mask.hidden]
    assert np.sqrt((off**2).sum(axis=1).mean()) < most
