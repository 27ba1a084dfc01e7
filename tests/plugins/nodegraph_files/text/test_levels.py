from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from nodegraph_files import read_csv
from tests.plugins.nodegraph_files.conftest import Write

pytestmark = pytest.mark.filterwarnings("ignore:no unit of length")
RATE = "# rate: 60\n"


def frame(*levels: list[str], names: list[str] | None = None) -> pd.DataFrame:
    columns = pd.MultiIndex.from_product(levels, names=names)
    return pd.DataFrame(np.arange(1.0, 1 + 2 * len(columns)).reshape(2, -1), columns=columns)


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("index", [None, "frame", "Frame"])
@pytest.mark.parametrize("names", [None, ["marker", "axis"]])
@pytest.mark.parametrize("kept", [True, False])
@pytest.mark.parametrize("separator", [",", ";", "\t"])
def test_what_pandas_writes_is_read(
    write: Write, index: str | None, names: list[str] | None, kept: bool, separator: str
) -> None:
    table = frame(["lip", "nose"], ["x", "y", "z"], names=names)
    table.index.name = index
    read = read_csv(write(RATE + table.to_csv(index=kept, sep=separator)))
    assert read.markers == ("lip", "nose")
    assert read.positions[1].tolist() == [[7, 8, 9], [10, 11, 12]]


def test_an_index_of_something_else_is_left_out_with_a_warning(write: Write) -> None:
    table = frame(["lip"], ["x", "y", "z"])
    table.index = pd.Index(["img01.png", "img02.png"], name="picture")
    with pytest.warns(UserWarning, match="1 columns .* left out: picture"):
        assert read_csv(write(RATE + table.to_csv())).frames == 2
    table.index.name = None
    with pytest.warns(UserWarning, match="1 columns .* left out: column 1"):
        assert read_csv(write(RATE + table.to_csv())).frames == 2


def test_an_index_of_times_tells_the_rate(write: Write) -> None:
    table = frame(["lip"], ["x", "y", "z"])
    table.index = pd.Index([0, 0.04], name="time")
    assert read_csv(write(table.to_csv())).rate == 25


def test_an_index_that_skips_is_reported(write: Write) -> None:
    text = "".join(f"{number},1,2,3\n" for number in (0, 1, 2, 7))
    with pytest.warns(UserWarning, match="1 of 3 steps of the column 'index' are irregular"):
        read_csv(write(f"{RATE},lip,lip,lip\n,x,y,z\n{text}"))


def test_the_axes_may_stand_in_any_order(write: Write) -> None:
    read = read_csv(write(f"{RATE},lip,nose,lip,nose,nose,lip\n,z,x,y,Y,z,x\n0,3,4,2,5,6,1\n"))
    assert read.positions.tolist() == [[[1, 2, 3], [4, 5, 6]]]


def test_levels_that_all_share_are_left_out_of_the_names(write: Write) -> None:
    alone = frame(["net"], ["lip", "nose"], ["x", "y", "z"])
    assert read_csv(write(RATE + alone.to_csv())).markers == ("lip", "nose")
    several = frame(["net"], ["ann", "bob"], ["lip", "nose"], ["x", "y", "z"])
    named = ("ann:lip", "ann:nose", "bob:lip", "bob:nose")
    assert read_csv(write(RATE + several.to_csv())).markers == named


def test_likelihoods_are_left_out_with_a_warning(write: Write) -> None:
    names = ["scorer", "bodyparts", "coords"]
    table = frame(["net"], ["lip", "nose"], ["x", "y", "z", "likelihood"], names=names)
    with pytest.warns(UserWarning, match="2 columns .* left out: lip likelihood, nose likelihood"):
        read = read_csv(write(RATE + table.to_csv()))
    assert read.positions[0].tolist() == [[1, 2, 3], [5, 6, 7]]


def test_data_of_two_dimensions_are_refused(write: Write) -> None:
    table = frame(["net"], ["lip", "nose"], ["x", "y", "likelihood"])
    with pytest.raises(ValueError, match=r"take\.csv:4: 2 markers have X and Y and no Z"):
        read_csv(write(RATE + table.to_csv()))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (",lip,lip,lip,nose\n,x,y,z,x\n0,1,2,3,4\n", ":2: marker 'nose' has no column for Y, Z"),
        (",lip,lip,lip,lip\n,x,y,z,x\n0,1,2,3,4\n", ":2:5: the column 'lip x' is there twice"),
        (",lip,lip,\n,x,y,z\n0,1,2,3\n", ":1: names in 3 columns, but the axes are in 4"),
        (",lip,lip,lip,nose\n,x,y,z\n0,1,2,3\n", ":1: names in 5 columns, but the axes are in 4"),
        (",lip,,lip\n,x,y,z\n0,1,2,3\n", ":2:3: the column ' y' names no marker"),
        (",lip,lip,lip\n,x,y,z\n0,1,2,three\n", r":3:4: 'three' is not a number \(column lip z\)"),
        (",lip,lip,lip\n,x,y,z\n0,1,2\n", ":3: 3 cells, but 4 columns"),
        (",lip,lip,lip\n,x,y,z\n", ": no frames follow line 2"),
        (",lip,lip,lip\n,x,y,z\n0,1,2,3\n", ": no rate; set `rate` in Hz"),
    ],
)
def test_what_is_wrong_is_reported_with_its_place(write: Write, text: str, message: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        read_csv(write(text))


@given(data=st.data())
def test_what_pandas_writes_reads_back_equal(tmp_path_factory: Any, data: Any) -> None:
    names = data.draw(
        st.lists(st.text("abcXYZ_.é", min_size=1), min_size=1, max_size=4, unique=True)
    )
    numbers = st.floats(allow_nan=False, allow_infinity=False).filter(bool)
    shape = (data.draw(st.integers(1, 4)), len(names), 3)
    positions = data.draw(arrays.arrays(np.float64, shape, elements=numbers))
    positions[data.draw(arrays.arrays(np.bool_, shape[:2]))] = np.nan
    columns = pd.MultiIndex.from_product([names, ["x", "y", "z"]])
    path = tmp_path_factory.mktemp("levels") / "take.csv"
    path.write_text(
        RATE + pd.DataFrame(positions.reshape(len(positions), -1), columns=columns).to_csv()
    )
    read = read_csv(path, unit="mm")
    assert read.markers == tuple(names)
    np.testing.assert_array_equal(read.positions, positions)
