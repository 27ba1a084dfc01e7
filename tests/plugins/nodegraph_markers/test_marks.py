"""What a person has marked is applied in order and counted, and nothing else is touched."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import nodegraph as ng
from nodegraph.testing import same
from nodegraph_mocap import Mark, MarkerSet, Marks, Origin, Trajectories
from nodegraph_mocap.marks import Kind
from nodegraph_mocap.specimens import FRAMES, masks, recordings

FACE = recordings()["complete"]
NOSE, CHEEK, OTHER = (FACE.markers.index(name) for name in ("nose", "cheek_left", "cheek_right"))
apply_marks = ng.get_node("recording.apply_marks")
read_marks = ng.get_node("read.marks")


def mark(marker: str, start: int, frames: int, kind: Kind = "bad", other: str = "") -> Mark:
    return Mark(marker=marker, start=start, frames=frames, kind=kind, other=other)


def applied(recording: Trajectories, *marks: Mark, warning: str = "by hand") -> Trajectories:
    with pytest.warns(UserWarning, match=warning):
        result: Trajectories = apply_marks(recording, Marks(marks=marks))
    return result


def test_what_write_mask_writes_is_left_out_and_counted(tmp_path: Path) -> None:
    face, mask = recordings()["gaps"], masks()["gaps"]
    ((name, content),) = ng.get_node("write.mask_csv")(mask).content.items()
    (tmp_path / name).write_bytes(content)
    marks = read_marks(path=tmp_path / name)
    present = (mask.hidden & face.present).sum()
    without = applied(
        face, *marks.marks, warning=f"^{present} samples marked by hand: {present} bad"
    )
    assert np.array_equal(without.present, face.present & ~mask.hidden)
    assert same(without.positions[without.present], face.positions[without.present])
    assert same(without.marker_set, face.marker_set)


def test_two_markers_are_swapped_in_a_span() -> None:
    face = recordings()["filled, repaired and with sigma"]
    swapped = applied(face, mark("cheek_left", 3, 20, "swapped", "cheek_right"))
    assert face.sigma is not None
    assert swapped.sigma is not None
    for was, now in (
        (face.positions, swapped.positions),
        (face.origin, swapped.origin),
        (face.sigma, swapped.sigma),
    ):
        assert same(now[3:23, [CHEEK, OTHER]], was[3:23, [OTHER, CHEEK]])
        rest = np.ones(was.shape[:2], dtype=np.bool_)
        rest[3:23, [CHEEK, OTHER]] = False
        assert same(now[rest], was[rest])


def test_a_span_of_a_track_is_given_to_another_marker() -> None:
    gap = mark("nose", 5, 10)
    swept = applied(
        FACE, gap, mark("cheek_left", 5, 10, "named", "nose"),
        warning="^20 samples marked by hand: 10 bad, 10 named",
    )  # fmt: skip
    assert same(swept.positions[5:15, NOSE], FACE.positions[5:15, CHEEK])
    assert (swept.origin[5:15, CHEEK] == Origin.MISSING).all()
    new = applied(FACE, mark("cheek_left", 0, 4, "named", "jaw"))
    assert new.markers == (*FACE.markers, "jaw")
    assert same(new.positions[:4, -1], FACE.positions[:4, CHEEK])
    assert np.isnan(new.positions[4:, -1]).all()


def test_a_marker_that_is_another_throughout_is_renamed_or_gone() -> None:
    names = MarkerSet(markers=("nose", "cheek_left"), edges=(("nose", "cheek_left"),))
    face = replace(FACE, marker_set=names)
    twice = (
        mark("nose", 0, FRAMES, "named", "tip"),
        mark("tip", 0, FRAMES, "named", "tip of the nose"),
    )
    renamed = applied(face, *twice)
    assert renamed.markers[NOSE] == "tip of the nose"
    assert renamed.marker_set is not None
    assert renamed.marker_set.edges == (("tip of the nose", "cheek_left"),)
    assert same(renamed.positions, face.positions)
    whole = (mark("nose", 0, FRAMES), mark("cheek_left", 0, FRAMES, "named", "nose"))
    given = applied(face, *whole)
    assert given.markers == tuple(name for name in FACE.markers if name != "cheek_left")
    assert same(given.positions[:, given.markers.index("nose")], FACE.positions[:, CHEEK])
    assert given.marker_set is not None
    assert given.marker_set.edges == ()


@pytest.mark.parametrize(
    ("marks", "message"),
    [
        ([mark("noze", 1, 1)], "noze, frames 1 to 1, bad: no marker 'noze'; did you mean 'nose'"),
        ([mark("nose", 39, 2)], "nose, frames 39 to 40, bad: the last frame is 39"),
        ([mark("nose", 1, 2, "swapped", "jaw")], "no marker 'jaw'"),
        ([mark("nose", 1, 3, "named", "cheek_left")], "cheek_left has samples in 3 of these"),
        ([mark("nose", 0, 40, "named", "tip"), mark("nose", 1, 1)], "no marker 'nose'"),
    ],
)
def test_marks_that_do_not_fit_the_take_are_named(marks: list[Mark], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        apply_marks(FACE, Marks(marks=tuple(marks)))


HEAD = "marker,start,frames,mark,other\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "marks.csv: the file is empty"),
        (
            "marker,first\n",
            "1: the columns must be marker,start,frames,mark,other, not 'marker,first'",
        ),
        ("marker,start,frames\nnose,1\n", "marks.csv:2: 3 cells are needed, not 'nose,1'"),
        ("marker,start,frames\nnose,1,x\n", "marks.csv:2: first frame and number of frames"),
        ("marker,start,frames\n\nnose,-1,2\n", "marks.csv:3: first frame and number of frames"),
        ("marker,start,frames\nnose,1,0\n", "marks.csv:2: 0 frames from frame 1 on are no span"),
        (f"{HEAD}nose,1,2,worse,\n", "marks.csv:2: samples are marked as bad, named, swapped, not"),
        (f"{HEAD}nose,1,2,bad,jaw\n", "marks.csv:2: a marker that is bad has none beside it"),
        (f"{HEAD}nose,1,2,swapped,nose\n", "swapped has the name of another beside it"),
        (f'{HEAD}"nose,1,2\n', "marks.csv:"),
        (f"{HEAD}nose,{'9' * 5000},2,bad,\n", "marks.csv:2: first frame and number of frames"),
        ("\udcff", "marks.csv"),
    ],
)
def test_a_table_of_another_form_is_named(tmp_path: Path, text: str, message: str) -> None:
    path = tmp_path / "marks.csv"
    path.write_bytes(text.encode(errors="surrogateescape"))
    with pytest.raises(ValueError, match=message):
        read_marks(path=path)
