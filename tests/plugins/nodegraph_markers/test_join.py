"""Two takes become one, matched by name."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from nodegraph_markers.crop import crop
from nodegraph_markers.join import join
from nodegraph_mocap import Origin
from nodegraph_mocap.specimens import recordings

FACE = recordings()["filled, repaired and with sigma"]


def test_what_was_cut_apart_is_joined_to_the_same_whatever_the_order_of_markers() -> None:
    following = crop(FACE, frames=((17, None),)).keep(FACE.markers[::-1])
    result = join(crop(FACE, frames=((0, 16),)), following)
    assert np.array_equal(result.positions, FACE.positions, equal_nan=True)
    assert np.array_equal(result.origin, FACE.origin)
    assert result.sigma is not None
    assert FACE.sigma is not None
    assert np.array_equal(result.sigma, FACE.sigma, equal_nan=True)
    assert (result.markers, result.rate, result.marker_set) == (
        FACE.markers,
        FACE.rate,
        FACE.marker_set,
    )


def test_what_one_take_lacks_is_missing_there_and_reported() -> None:
    first, other = FACE.keep(["nose", "forehead"]), FACE.keep(["lip_left", "nose"])
    with pytest.warns(UserWarning, match="1 markers .* following .* forehead; 1 .* lip_left"):
        result = join(first, other)
    assert result.markers == ("nose", "forehead", "lip_left")
    assert result.marker_set is first.marker_set
    missing = result.origin == Origin.MISSING
    assert missing[FACE.frames :, 1].all()
    assert missing[: FACE.frames, 2].all()
    again = result.keep(["lip_left"]).positions[FACE.frames :]
    assert np.array_equal(again, other.keep(["lip_left"]).positions, equal_nan=True)


def test_sigma_that_only_one_take_knows_is_unknown_in_the_other() -> None:
    result = join(FACE, replace(FACE, sigma=None))
    assert result.sigma is not None
    assert np.isnan(result.sigma[FACE.frames :]).all()
    assert np.isfinite(result.sigma[: FACE.frames][FACE.present]).all()
    assert join(replace(FACE, sigma=None), replace(FACE, sigma=None)).sigma is None


def test_takes_that_cannot_be_joined() -> None:
    with pytest.raises(ValueError, match="60 Hz, the following 30 Hz"):
        join(FACE, replace(FACE, rate=30.0))
    with pytest.raises(ValueError, match="no marker is in both: the first has nose"):
        join(FACE.keep(["nose"]), FACE.keep(["forehead"]))
