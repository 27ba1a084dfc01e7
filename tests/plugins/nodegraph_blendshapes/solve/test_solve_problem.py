"""Matching a recording with a model."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph import Refusal
from nodegraph_blendshapes.solve.problem import Problem
from tests.plugins.nodegraph_blendshapes.solve.statements import at, face

VALUES = np.random.default_rng(0).uniform(0, 1, (5, 3))


def test_markers_are_matched_by_name_in_the_model_s_order() -> None:
    model, recording, _ = face(VALUES)
    shuffled = recording.keep(["m5", "m0", "m3"])
    problem = Problem.of(shuffled, model)
    assert problem.markers == ("m0", "m3", "m5")
    for number, marker in enumerate(problem.markers):
        place = model.markers.index(marker)
        expected = recording.positions[:, place] - model.neutral[place]
        np.testing.assert_array_equal(problem.offsets[:, number], expected)
        np.testing.assert_array_equal(problem.shapes[:, number], model.shapes[:, place])
    assert problem.notes == (
        "5 of 8 markers of the model are left out, as only the model has them: m1, m2, m4, m6, m7",
    )


def test_what_cannot_be_matched_is_named() -> None:
    model, recording, _ = face(VALUES)
    other = replace(recording, markers=tuple(f"x{number}" for number in range(8)))
    with pytest.raises(ValueError, match="no marker in common: the recording has x0, x1"):
        Problem.of(other, model)
    with pytest.raises(ValueError, match="the model has no shapes"):
        Problem.of(recording, replace(model, shapes=model.shapes[:0], names=()))
    nowhere = at(recording, np.full_like(recording.positions, np.nan))
    with pytest.raises(Refusal, match="needs a frame in which a marker of the model is present"):
        Problem.of(nowhere, model)
