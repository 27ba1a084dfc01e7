"""Masks that somebody else has published: what is hidden, and what is wrong with a file."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph_mocap import Origin, Trajectories

from_matrix = get_node("gaps.from_matrix")
FRAMES, NAMES = 5, ("brow", "cheek", "chin")


def recording() -> Trajectories:
    positions = np.random.default_rng(1).normal(size=(FRAMES, len(NAMES), 3))
    return Trajectories(positions=positions, markers=NAMES, rate=60.0)


def written(folder: Path, *lines: str) -> Path:
    path = folder / "mask.txt"
    path.write_text("".join(f"{line}\n" for line in lines))
    return path


WHOLE = "1 1 1 1 1 1 1 1 1"


def test_samples_at_zeros_are_hidden_marker_by_marker_in_the_order_of_the_recording(
    tmp_path: Path,
) -> None:
    hidden = np.zeros((FRAMES, len(NAMES)), dtype=bool)
    hidden[1:4, 1] = hidden[3:, 2] = True
    path = tmp_path / "mask.txt"
    np.savetxt(path, np.repeat(~hidden, 3, axis=1), fmt="%d")
    gappy, truth, mask = from_matrix(recording(), path=path)
    assert np.array_equal(mask.hidden, hidden)
    assert mask.markers == NAMES
    assert np.array_equal(gappy.origin == Origin.MISSING, hidden)
    assert np.array_equal(gappy.positions[~hidden], recording().positions[~hidden])
    assert np.array_equal(truth.positions, recording().positions)


def test_only_measured_samples_are_hidden(tmp_path: Path) -> None:
    missing, filled = np.zeros((2, FRAMES, len(NAMES)), dtype=bool)
    missing[2, 1] = filled[1, 1] = True
    positions = np.where(missing[..., None], np.nan, recording().positions)
    take = recording().with_samples(positions, changed=missing, origin=Origin.MISSING)
    take = take.with_samples(positions, changed=filled, origin=Origin.FILLED)
    path = written(tmp_path, WHOLE, *["1 1 1 0 0 0 1 1 1"] * 3, WHOLE)
    gappy, _, mask = from_matrix(take, path=path)
    assert np.flatnonzero(mask.hidden[:, 1]).tolist() == [3]
    assert gappy.origin[:, 1].tolist() == [
        *(Origin.MEASURED, Origin.FILLED, Origin.MISSING, Origin.MISSING, Origin.MEASURED)
    ]


@pytest.mark.parametrize(
    ("lines", "message"),
    [
        ([WHOLE] * 4, r"mask\.txt: 4 lines, the recording has 5 frames"),
        (
            [WHOLE, "1 1 1 1 1 1", *[WHOLE] * 3],
            r"mask\.txt:2: 6 numbers, the 3 markers of the recording have 9 coordinates",
        ),
        (
            [*[WHOLE] * 4, "1 1 1 1 1 1 1 1 2"],
            r"mask\.txt:5: numbers must be 0 or 1, not '2'",
        ),
        (
            ["1 1 1 1 0 0 1 1 1", *[WHOLE] * 4],
            r"mask\.txt:1: the coordinates of marker 2 are partly hidden",
        ),
    ],
)
def test_a_file_that_is_no_mask_of_the_recording_is_refused_with_its_line(
    tmp_path: Path, lines: list[str], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        from_matrix(recording(), path=written(tmp_path, *lines))
