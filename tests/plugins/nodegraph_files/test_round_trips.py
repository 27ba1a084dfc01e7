"""What is written reads back, in every form that is written and read."""

from __future__ import annotations

import os
import string
import tempfile
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from nodegraph_files import (
    c3d_bytes,
    csv_bytes,
    npz_bytes,
    read_c3d,
    read_csv,
    read_npz,
    read_trc,
    trc_bytes,
    write_c3d,
    write_csv,
    write_npz,
    write_trc,
)
from nodegraph_mocap import Trajectories


class Form(NamedTuple):
    """What writes and reads a form."""

    content: Callable[[Trajectories], bytes]
    write: Callable[[Trajectories, Path], None]
    read: Callable[..., Trajectories]
    width: Literal[32, 64]


FORMS = {
    "C3D": Form(c3d_bytes, write_c3d, read_c3d, 32),
    "TRC": Form(trc_bytes, write_trc, read_trc, 64),
    "CSV": Form(csv_bytes, write_csv, read_csv, 64),
    "NPZ": Form(npz_bytes, write_npz, read_npz, 64),
}
FOREIGN = ("C3D", "TRC", "CSV")
"""Forms that say less than a recording does."""
NAMES = st.text(string.ascii_letters + '.,;_" #éß', min_size=1, max_size=6).filter(
    lambda name: name == name.strip()
)


def recording(positions: Any, *markers: str, rate: float = 60) -> Trajectories:
    return Trajectories(positions=np.asarray(positions, float), markers=markers, rate=rate)


@pytest.mark.parametrize("form", FORMS.values(), ids=FORMS)
@given(data=st.data())
def test_positions_names_and_rate_read_back_equal(form: Form, data: st.DataObject) -> None:
    names = data.draw(st.lists(NAMES, min_size=1, max_size=5, unique=True))
    shape = (data.draw(st.integers(1, 4)), len(names))
    most = 1e6 if form.width == 32 else None
    numbers = st.floats(
        most and -most, most, allow_nan=False, allow_infinity=False, width=form.width
    ).filter(bool)
    positions = data.draw(arrays.arrays(np.float64, (*shape, 3), elements=numbers))
    positions[data.draw(arrays.arrays(np.bool_, shape))] = np.nan
    rates = [24.0, 29.97, 59.94, 1000.0]
    rate = data.draw(st.sampled_from(rates) if form.width == 32 else st.floats(1e-3, 1e5))
    whole = recording(positions, *names, rate=rate)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "it"
        form.write(whole, path)
        assert path.read_bytes() == form.content(whole)
        again = form.read(path)
    np.testing.assert_array_equal(again.positions, whole.positions)
    assert (again.markers, again.rate) == (whole.markers, whole.rate)
    assert form.content(again) == form.content(whole)


@pytest.mark.parametrize("name", FOREIGN)
def test_zeros_are_missing_unless_told_otherwise(name: str, tmp_path: Path) -> None:
    positions = np.ones((6, 2, 3))
    positions[3, 1] = positions[5, 1] = 0
    FORMS[name].write(recording(positions, "a", "b"), tmp_path / "it")
    with pytest.warns(UserWarning, match=r"^2 samples are at exactly.*frame 3, marker b$"):
        read = FORMS[name].read(tmp_path / "it")
    assert np.argwhere(~read.present).tolist() == [[3, 1], [5, 1]]
    assert FORMS[name].read(tmp_path / "it", zeros_missing=False).present.all()


@pytest.mark.parametrize("name", FOREIGN)
@pytest.mark.parametrize("names", [("x", "y"), ("x", "B:y")])
def test_a_subject_that_all_share_is_taken_off(
    name: str, names: tuple[str, ...], tmp_path: Path
) -> None:
    written = [each if ":" in each else f"A:{each}" for each in names]
    FORMS[name].write(recording(np.ones((1, 2, 3)), *written), tmp_path / "it")
    taken_off = "B:y" not in names
    assert FORMS[name].read(tmp_path / "it").markers == (names if taken_off else tuple(written))


@pytest.mark.parametrize("name", FOREIGN)
@pytest.mark.parametrize("marker", ["", " ", " a", "a ", "a\0", "a\nb", "a\tb", "\u2003", "\u2028"])
def test_a_name_that_the_file_would_change_is_refused(name: str, marker: str) -> None:
    with pytest.raises(ValueError, match="cannot keep the marker name"):
        FORMS[name].content(recording(np.ones((1, 1, 3)), marker))


@pytest.mark.parametrize(
    ("name", "shape"),
    [("C3D", (0, 1, 3)), ("C3D", (1, 0, 3)), ("C3D", (9, 1, 3)), ("TRC", (0, 1, 3)),
     ("TRC", (1, 0, 3))],
)  # fmt: skip
def test_what_the_form_cannot_count_is_refused(
    name: str, shape: tuple[int, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("nodegraph_files.c3d.MOST_FRAMES", 8)  # as many as it has take 400 MB
    counted = Trajectories(
        positions=np.broadcast_to(1.0, shape), markers=("m",) * shape[1], rate=60
    )
    with pytest.raises(ValueError, match=rf"{name} holds .* not {shape[0]} of {shape[1]}"):
        FORMS[name].content(counted)


@pytest.mark.parametrize("name", ["C3D", "NPZ"])
def test_reading_takes_little_memory_beyond_the_recording(
    name: str, tmp_path: Path, peak_memory: Callable[[], int]
) -> None:
    positions = np.ones((8000, 50, 3))
    positions[::3, 4] = np.nan
    FORMS[name].write(recording(positions, *map(str, range(50))), tmp_path / "it")
    held = tracemalloc.get_traced_memory()[0]
    tracemalloc.reset_peak()
    read = FORMS[name].read(tmp_path / "it")
    assert peak_memory() - held < 1.6 * read.positions.nbytes


def test_writing_takes_little_memory(peak_memory: Callable[[], int]) -> None:
    given = recording(np.ones((4000, 50, 3)), *map(str, range(50)))
    before = peak_memory()
    write_c3d(given, Path(os.devnull))
    assert peak_memory() - before < given.positions.nbytes
