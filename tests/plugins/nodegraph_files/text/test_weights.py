"""Weights as tables of text: what is written reads back, and what is no weight is refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph import get_node
from nodegraph_mocap import Weights

GAPPY = np.array([[0.1, 1.0], [np.nan, 0.5], [0.25, 1 / 3], [1e-9, 0.0]])


@pytest.mark.parametrize("rate", [60.0, 30000 / 1001, 23.976])
def test_what_is_written_reads_back(tmp_path: Path, rate: float) -> None:
    weights = Weights(values=GAPPY, names=("EyeBlinkLeft", "jaw open"), rate=rate)
    content = get_node("write.weights_csv")(weights).content["weights.csv"]
    (tmp_path / "weights.csv").write_bytes(content)
    for path in (tmp_path, tmp_path / "weights.csv"):
        read = get_node("read.weights")(path=path)
        np.testing.assert_array_equal(read.values, GAPPY)
        assert read.names == weights.names
        assert read.rate == pytest.approx(rate, rel=1e-8)


def test_frame_numbers_and_a_rate_are_enough(tmp_path: Path) -> None:
    text = "# rate: 50\nframe;_neutral;jawOpen\n1;0,5;0\n2;0,25;1\n"
    (tmp_path / "it.csv").write_text(text)
    with pytest.warns(UserWarning, match="commas count as decimal points"):
        weights = get_node("read.weights")(path=tmp_path / "it.csv")
    assert (weights.names, weights.rate) == (("_neutral", "jawOpen"), 50.0)
    np.testing.assert_array_equal(weights.values, [[0.5, 0], [0.25, 1]])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("time,a,b\n0,1,2\n0.1,one,2\n", ":3:2: 'one' is not a number"),
        ("time,a,b\n0,1,2\n0.1,1\n", ":3: 2 cells, but 3 columns"),
        ("time,a,b\n0,1,2\n0.1,1,inf\n", ": frame 1: the weight b is infinite"),
        ("time,a,a\n0,1,2\n", ":1: columns: named twice: a"),
        ("time,,a\n0,1,2\n", ":1:2: a column has no name"),
        (
            "time,nose.X,nose.Y,nose.Z\n0,1,2,3\n",
            ":1: columns of coordinates, which read.recording",
        ),
        ("time\n0\n", ":1: no weights"),
        ("time,a\n", ": no frames follow line 1"),
        ("time,a\n0,1\n", ": no rate"),
    ],
)
def test_what_is_no_table_of_weights_is_refused(tmp_path: Path, text: str, message: str) -> None:
    (tmp_path / "it.csv").write_text(text)
    with pytest.raises(ValueError, match=rf"it\.csv{message}"):
        get_node("read.weights")(path=tmp_path / "it.csv")
