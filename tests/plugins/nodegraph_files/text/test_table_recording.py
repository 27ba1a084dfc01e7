from __future__ import annotations

import numpy as np
import pytest

from nodegraph_files.text.table import read_table
from nodegraph_files.text.table_recording import (
    known_rate,
    recording_of,
    stated_rate,
    unit_of_table,
)
from nodegraph_files.units import LengthUnit
from tests.plugins.nodegraph_files.conftest import Write


def test_coordinates_become_positions_of_markers() -> None:
    table = np.array([[1, 2, 3, 4, 5, 6], [np.nan] * 3 + [0.0] * 3])
    read = recording_of(table, ["s:a", "s:b"], rate=60, unit=LengthUnit("cm"), zeros_missing=False)
    assert read.markers == ("a", "b")
    assert read.present.tolist() == [[True, True], [False, True]]
    assert read.positions[0].tolist() == [[10, 20, 30], [40, 50, 60]]
    assert table[0, 0] == 1


def test_what_comments_tell(write: Write) -> None:
    table = read_table(write("# rate: 50\n# units: cm\na,b\n"))
    assert (stated_rate(table), unit_of_table(table, "auto").name) == (50, "cm")
    assert unit_of_table(table, "auto", "centimetres") == LengthUnit("cm")
    assert unit_of_table(table, "m").name == "m"
    with pytest.raises(ValueError, match=r"take\.csv:2: unit 'cm'; the columns are in 'mm'"):
        unit_of_table(table, "auto", "mm")
    bare = read_table(write("a,b\n"))
    assert stated_rate(bare) is None
    assert unit_of_table(bare, "auto").problem


@pytest.mark.parametrize("rate", ["0", "-5", "nan", "fast"])
def test_a_rate_that_is_none_is_refused_with_its_line(write: Write, rate: str) -> None:
    with pytest.raises(ValueError, match=rf"take\.csv:2: rate '{rate}' is not a positive"):
        stated_rate(read_table(write(f"a,b\n# rate: {rate}\n")))


def test_a_rate_of_uneven_times_is_reported(write: Write) -> None:
    bare = read_table(write("a,b\n"))
    with pytest.warns(UserWarning, match="not whole steps apart; by the median step .* 2 Hz"):
        assert known_rate(bare, np.array([0, 0.5, 1, 1.5, 2.2])) == 2
    with pytest.raises(ValueError, match=r"take\.csv: no rate; set `rate` in Hz"):
        known_rate(bare, None)
