from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph_files import npz_bytes, read_live_link
from nodegraph_files.readers import read_weights
from nodegraph_mocap import Trajectories
from tests.studies import DATA, needs_recordings

TABLE = "Timecode,BlendShapeCount,JawOpen\n00:00:00:01.000,1,0.25\n00:00:00:02.000,1,0.5\n"


@pytest.mark.parametrize("name", ["it.csv", "it.txt", "it"])
def test_the_content_tells_the_form(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text(TABLE.upper())
    read = read_weights(path=path)
    assert (read.names, read.rate) == (("JAWOPEN",), 60)
    assert read.values.tolist() == [[0.25], [0.5]]


def test_a_folder_gives_its_weights(tmp_path: Path) -> None:
    (tmp_path / "weights.csv").write_text(TABLE)
    assert read_weights(path=tmp_path).frames == 2


def test_weights_that_are_all_missing_are_reported(tmp_path: Path) -> None:
    path = tmp_path / "weights.csv"
    path.write_text("Timecode,BlendShapeCount,JawOpen\n00:00:00:01.000,0\n00:00:00:02.000,0\n")
    with (
        pytest.warns(UserWarning, match="2 frames have no weights"),
        pytest.warns(UserWarning, match="every weight is missing"),
    ):
        assert np.isnan(read_weights(path=path).values).all()


def test_a_rate_that_is_set_counts(tmp_path: Path) -> None:
    path = tmp_path / "it.csv"
    path.write_text(TABLE)
    with pytest.warns(UserWarning, match="a rate of 60 Hz; 24 Hz is taken"):
        assert read_weights(path=path, rate=24.0).rate == 24
    path.write_text("frame,jawOpen\n7,0.25\n8,0.5\n")
    with pytest.raises(ValueError, match=r"it\.csv: no rate; set `rate`"):
        read_weights(path=path)
    assert read_weights(path=path, rate=24.0).rate == 24


def test_a_recording_is_refused(tmp_path: Path, gappy: Trajectories) -> None:
    path = tmp_path / "it.npz"
    path.write_bytes(npz_bytes(gappy))
    with pytest.raises(ValueError, match=r"it\.npz: .*Live Link"):
        read_weights(path=path)


@needs_recordings
def test_a_real_take_is_read() -> None:
    path = DATA / "livelink" / "actor_a_60fps.csv"
    np.testing.assert_array_equal(read_weights(path=path).values, read_live_link(path).values)
