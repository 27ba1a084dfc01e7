"""What every node of this package does."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from nodegraph_align import nodegraph_nodes
from tests.plugins.nodegraph_align.heads import make_head, run_moved

NODES = {function.__name__: function for function in nodegraph_nodes()}
ALIGNMENTS = sorted(set(NODES) - {"restore"})


@pytest.mark.parametrize("name", ALIGNMENTS)
def test_a_rigid_head_stands_still_afterwards(name: str) -> None:
    rest, motion = make_head(frames=10)
    aligned = NODES[name](run_moved(rest, motion))
    still = np.repeat(aligned.reference.positions, 10, axis=0)
    np.testing.assert_allclose(aligned.aligned.positions, still, atol=1e-8)


@pytest.mark.parametrize("name", ALIGNMENTS)
def test_memory_order_and_precision_make_no_difference(name: str) -> None:
    rest, motion = make_head(frames=10)
    take = run_moved(rest, motion)
    noise = np.random.default_rng(0).normal(0, 1, take.positions.shape)
    coarse = (take.positions + noise).astype(np.float32)
    expected = NODES[name](replace(take, positions=coarse.astype(np.float64))).aligned.positions
    layouts: tuple[Any, ...] = (coarse, np.asfortranarray(coarse))
    for positions in layouts:
        aligned = NODES[name](replace(take, positions=positions)).aligned.positions
        np.testing.assert_array_equal(aligned, expected)
