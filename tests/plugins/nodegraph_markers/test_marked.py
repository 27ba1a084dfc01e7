"""What a person has marked is left out and counted, and nothing else is touched."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import nodegraph as ng
from nodegraph.testing import same
from nodegraph_mocap import Mask
from nodegraph_mocap.specimens import masks, recordings

FACE = recordings()["gaps"]
drop_marked = ng.get_node("recording.drop_marked")


def test_what_write_mask_writes_is_left_out_and_counted(tmp_path: Path) -> None:
    mask = masks()["gaps"]
    ((name, content),) = ng.get_node("write.mask_csv")(mask).content.items()
    (tmp_path / name).write_bytes(content)
    present = mask.hidden & FACE.present
    expected = f"{present.sum()} samples by hand are left out, of {present.any(axis=0).sum()}"
    with pytest.warns(UserWarning, match=expected):
        without, marked = drop_marked(FACE, path=tmp_path / name)
    assert same(marked, Mask(hidden=mask.hidden, markers=FACE.markers))
    assert np.array_equal(without.present, FACE.present & ~mask.hidden)
    assert same(without.positions[without.present], FACE.positions[without.present])


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "marks.csv:1: the columns must be marker,start,frames, not 'nothing'"),
        ("marker,first\n", "not 'marker,first'"),
        ("marker,start,frames\nnose,1\n", "marks.csv:2: a marker and two whole numbers"),
        ("marker,start,frames\nnose,1,x\n", "marks.csv:2: a marker and two whole numbers"),
        ("marker,start,frames\n\nnoze,1,1\n", r"marks.csv:3: the recording has no marker 'noze'"),
        ("marker,start,frames\nnose,39,2\n", "2 frames from frame 39 on; .* frames 0 to 39"),
        ("marker,start,frames\nnose,-1,2\n", "2 frames from frame -1 on"),
        ("marker,start,frames\nnose,1,0\n", "0 frames from frame 1 on"),
        ("\udcff", "not a table of text in UTF-8"),
    ],
)
def test_a_table_of_another_form_is_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "marks.csv"
    path.write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=message):
        drop_marked(FACE, path=path)
