from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection, PathCollection

from nodegraph import Across
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.view import frontal
from nodegraph_plot.faces import faces
from tests.plugins.nodegraph_plot import made_face

FRAME = 17
COLUMN = made_face.GAP_MARKER


def across(**recordings: Trajectories) -> Across[Trajectories]:
    return Across.of(recordings, axis="fill")


def dots(axis: Axes) -> dict[str, Any]:
    """Return the points drawn, by what they show."""
    return {
        str(artist.get_label()): np.asarray(artist.get_offsets())
        for artist in axis.collections
        if isinstance(artist, PathCollection)
    }


def lines(axis: Axes) -> list[Any]:
    actual = [
        artist.get_segments() for artist in axis.collections if isinstance(artist, LineCollection)
    ]
    return [np.array(segments).reshape(-1, 2, 2) for segments in actual]


def test_every_sample_is_drawn_once_as_what_it_is() -> None:
    recording = made_face.filled(3.0)
    (axis,) = faces(across(guess=recording), frames=(FRAME,)).axes
    seen = frontal(recording, "auto").project(recording.positions[FRAME])
    drawn = dots(axis)
    others = [place for place in range(len(made_face.MARKERS)) if place != COLUMN]
    assert drawn["measured"] == pytest.approx(seen[others])
    assert drawn["filled"] == pytest.approx(seen[[COLUMN]])
    assert drawn.keys() == {"measured", "filled"}


def test_the_truth_of_a_filled_sample_is_joined_to_it() -> None:
    recording, truth = made_face.filled(3.0), made_face.truth()
    (axis,) = faces(across(guess=recording), truth, frames=(FRAME,)).axes
    view = frontal(recording, "auto")
    ends = view.project(np.stack([recording.positions[FRAME], truth.positions[FRAME]])[:, COLUMN])
    assert dots(axis)["truth"] == pytest.approx(ends[[1]])
    assert lines(axis)[1] == pytest.approx(ends[np.newaxis])


def test_what_is_still_missing_is_shown_where_it_should_be() -> None:
    recording, truth = made_face.gappy(), made_face.truth()
    (axis,) = faces(across(captured=recording), truth, frames=(FRAME,)).axes
    expected = frontal(recording, "auto").project(truth.positions[FRAME, [COLUMN]])
    drawn = dots(axis)
    assert drawn["left missing"] == pytest.approx(expected)
    assert drawn.keys() == {"measured", "left missing"}


def test_edges_are_drawn_where_both_ends_are_present() -> None:
    figure = faces(across(filled=made_face.filled(0.0), gappy=made_face.gappy()), frames=(FRAME,))
    whole, holed = (lines(axis)[0] for axis in figure.axes)
    assert len(whole) == len(made_face.SET.edges)
    kept = [edge for edge in made_face.SET.edges if "mouth_l" not in edge]
    assert len(holed) == len(kept) == 1
    drawn = dots(figure.axes[0])["measured"]
    assert drawn[[0, 2]] == pytest.approx(whole[0])


def test_repaired_samples_have_their_own_colour() -> None:
    truth = made_face.truth()
    changed = np.zeros((made_face.FRAMES, len(truth.markers)), dtype=bool)
    changed[FRAME, 2] = True
    repaired = truth.with_samples(truth.positions, changed=changed, origin=Origin.REPAIRED)
    figure = faces(across(despiked=repaired), frames=(FRAME,))
    assert len(dots(figure.axes[0])["repaired"]) == 1
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["measured", "repaired"]


def test_a_row_per_recording_and_a_column_per_frame() -> None:
    recordings = across(a=made_face.filled(0.0), b=made_face.filled(1.0))
    figure = faces(recordings, frames=(3, 17, 20))
    assert len(figure.axes) == 6
    assert [axis.get_title() for axis in figure.axes[:3]] == ["frame 3", "frame 17", "frame 20"]
    assert [axis.get_ylabel() for axis in figure.axes[::3]] == ["a", "b"]
    assert len({(axis.get_xlim(), axis.get_ylim()) for axis in figure.axes}) == 1


def test_the_frames_drawn_by_default_have_filled_samples() -> None:
    titles = [axis.get_title() for axis in faces(across(a=made_face.filled(0.0))).axes]
    assert titles == ["frame 15", "frame 17", "frame 18", "frame 20"]
    titles = [axis.get_title() for axis in faces(across(a=made_face.truth())).axes]
    assert titles == ["frame 0", "frame 13", "frame 26", "frame 39"]


def test_a_sample_far_outside_does_not_shrink_the_faces_and_is_counted() -> None:
    near, far = (
        faces(across(guess=made_face.filled(offset)), made_face.truth(), frames=(FRAME,)).axes[0]
        for offset in (0.0, 5000.0)
    )
    assert np.ptp(far.get_ylim()) < 1.4 * np.ptp(near.get_ylim())
    assert [text.get_text() for text in far.texts][:1] == ["1 outside"]
    assert "outside" not in "".join(text.get_text() for text in near.texts)


@pytest.mark.parametrize("frame", [40, -1])
def test_frames_beyond_the_take_are_refused(frame: int) -> None:
    with pytest.raises(ValueError, match=f"no frame {frame} of a: it has 40 frames, 0 to 39"):
        faces(across(a=made_face.truth()), frames=(0, frame))
