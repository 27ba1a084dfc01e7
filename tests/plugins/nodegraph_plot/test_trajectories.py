from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from matplotlib.axes import Axes
from matplotlib.colors import to_hex

from nodegraph import Absent, Across
from nodegraph_mocap import Origin, Trajectories
from nodegraph_plot.trajectories import trajectories
from nodegraph_tables.figures import store_figure
from nodegraph_tables.style import REST, looks
from tests.plugins.nodegraph_plot import made_face

COLUMN = made_face.GAP_MARKER
FILLED = list(range(15, 21))


def across(**recordings: Trajectories) -> Across[Trajectories]:
    return Across.of(recordings, axis="fill")


def two() -> Across[Trajectories]:
    return across(lin=made_face.filled(0.5), cubic=made_face.filled(-0.25))


def curve(axis: Axes, label: str) -> Any:
    (line,) = [line for line in axis.lines if line.get_label() == label]
    return line


def test_filled_samples_have_a_symbol_each() -> None:
    figure = trajectories(two())
    recording = made_face.filled(0.5)
    for place, axis in enumerate(figure.axes):
        dots = curve(axis, "lin, filled")
        assert np.asarray(dots.get_xdata()).tolist() == FILLED
        assert np.asarray(dots.get_ydata()) == pytest.approx(
            recording.positions[FILLED, COLUMN, place]
        )
        assert dots.get_linestyle() == "None"


def test_lines_are_apart_in_the_gap_and_one_grey_line_elsewhere() -> None:
    (axis, *_) = trajectories(two(), frames=(0, 39)).axes
    own = np.isfinite(curve(axis, "lin").get_ydata())
    shared = np.isfinite(curve(axis, "measured").get_ydata())
    assert np.flatnonzero(own).tolist() == [14, *FILLED, 21]
    assert np.flatnonzero(~shared).tolist() == FILLED


def test_recordings_that_differ_where_measured_keep_their_own_lines() -> None:
    moved = Trajectories(
        positions=made_face.truth().positions + 0.1, markers=made_face.MARKERS, rate=60.0
    )
    (axis, *_) = trajectories(across(a=made_face.truth(), b=moved)).axes
    assert np.isfinite(curve(axis, "a").get_ydata()).all()
    assert np.isnan(curve(axis, "measured").get_ydata()).all()


def test_the_default_is_the_gap_with_as_much_around_it() -> None:
    figure = trajectories(two())
    assert figure.axes[0].get_title() == "mouth_l"
    frames = np.asarray(curve(figure.axes[0], "lin").get_xdata())
    assert (frames[0], frames[-1]) == (5, 30)
    (shade,) = figure.axes[0].patches
    shaded = shade.get_extents().transformed(figure.axes[0].transData.inverted())
    assert (shaded.x0, shaded.x1) == (pytest.approx(14.5), pytest.approx(20.5))


def test_missing_samples_leave_a_hole() -> None:
    figure = trajectories(across(captured=made_face.gappy(), lin=made_face.filled(0.0)))
    (axis, *_) = figure.axes
    holed = curve(axis, "captured")
    missing = np.isnan(holed.get_ydata()) & np.isin(holed.get_xdata(), FILLED)
    assert np.asarray(holed.get_xdata())[missing].tolist() == FILLED


def test_markers_and_coordinates_can_be_chosen() -> None:
    figure = trajectories(two(), markers=("chin", "nose"), frames=(0, 5), coordinates=("z", "x"))
    titles = [axis.get_title() for axis in figure.axes]
    assert titles == ["chin", "nose", "", ""]
    labels = [axis.get_ylabel() for axis in figure.axes]
    assert labels == ["z (mm)", "", "x (mm)", ""]
    chin = made_face.truth().positions[:6, made_face.MARKERS.index("chin"), 2]
    assert np.asarray(curve(figure.axes[0], "measured").get_ydata()) == pytest.approx(chin)


def test_methods_look_as_in_other_figures_also_when_one_is_absent() -> None:
    absent = Absent({"fill": "akima"}, "refused", "why")
    recordings = Across(("fill",), two().entries, (absent,))
    expected = looks(["lin", "cubic", "akima"])
    line = curve(trajectories(recordings).axes[0], "cubic, filled")
    assert to_hex(line.get_color()).upper() == expected["cubic"].colour
    assert line.get_marker() == expected["cubic"].marker


def many(*offsets: float) -> Across[Trajectories]:
    return across(**{f"off{offset}": made_face.filled(offset) for offset in offsets})


def names_beside(axis: Axes) -> list[str]:
    return [text.get_text() for text in axis.texts]


def test_of_many_the_best_three_and_the_reference_are_in_full_and_the_rest_grey() -> None:
    recordings = many(0.5, 0.1, -0.3, 0.9, 0.2, 2.0, -4.0)
    figure = trajectories(recordings, made_face.truth(), reference="off2.0")
    full = {"off0.1", "off0.2", "off-0.3", "off2.0"}
    for axis in figure.axes:
        assert names_beside(axis) == ["off-0.3", "truth", "off0.1", "off0.2", "off2.0"]
        labels = [str(line.get_label()) for line in axis.lines]
        dotted = {label.removesuffix(", filled") for label in labels if label.endswith("filled")}
        assert dotted == full
        thin = {name for name in ("off0.5", "off0.9", *full)
                if to_hex(curve(axis, name).get_color()) == REST}  # fmt: skip
        assert thin == {"off0.5", "off0.9"}
        colours = {to_hex(curve(axis, name).get_color()) for name in full}
        assert len(colours) == len(full)
        assert curve(axis, "off2.0").get_linestyle() == "--"
    assert "3 others" in [text.get_text() for text in figure.legends[0].get_texts()]


def test_who_leaves_samples_missing_is_not_the_best() -> None:
    recordings = across(
        none=made_face.gappy(),
        **{f"off{offset}": made_face.filled(offset) for offset in (1.0, 2.0, 3.0, 4.0, 5.0, 6.0)},
    )
    axis = trajectories(recordings, made_face.truth()).axes[0]
    assert names_beside(axis) == ["truth", "off1.0", "off2.0", "off3.0"]


def test_a_reference_that_is_not_there_is_left_out_and_an_unknown_name_is_a_warning() -> None:
    recordings = many(0.5, 0.1, -0.3, 0.9, 0.2, 0.7, 0.8)
    known = Across(("fill",), recordings.entries, known={"fill": ("linear", "off0.5")})
    assert "linear" not in names_beside(trajectories(known, reference="linear").axes[0])
    with pytest.warns(UserWarning, match=r"did you mean 'off0\.1'"):
        trajectories(recordings, reference="off0.11")


def test_a_line_that_strays_does_not_flatten_the_rest() -> None:
    recordings = across(lin=made_face.filled(0.1), wild=made_face.filled(900.0))
    (axis, *_) = trajectories(recordings, made_face.truth()).axes
    assert np.ptp(axis.get_ylim()) < 10 * np.ptp(made_face.truth().positions[:, COLUMN, 0])


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"markers": ("ear", "nose")}, "lin has no marker 'ear'; it has nose, forehead"),
        ({"frames": (10, 99)}, "no frame 99 of lin: it has 40 frames, 0 to 39"),
        ({"frames": (10, 9)}, "the first not after the last"),
    ],
)
def test_what_there_is_not_is_named(settings: dict[str, Any], message: str) -> None:
    with pytest.raises(ValueError, match=message):
        trajectories(two(), **settings)


@pytest.mark.parametrize("frames", [1, 2])
def test_the_only_frame_is_a_dot(frames: int) -> None:
    whole = made_face.truth()
    short = replace(whole, positions=whole.positions[:frames], origin=whole.origin[:frames])
    other = replace(short, positions=short.positions + 1.0)
    for recordings in (across(a=short), across(a=short, b=other)):
        figure = trajectories(recordings, short)
        assert store_figure(figure).svg
        label = "measured" if len(recordings) == 1 else "b"
        for name in (label, "truth"):
            line = curve(figure.axes[0], name)
            assert line.get_markevery() == ([0] if frames == 1 else [])
            assert line.get_marker() == ("." if frames == 1 else "")
    low, high = figure.axes[0].get_xlim()
    assert (low < 0, high > frames - 1) == (True, True)


def test_a_sample_between_two_missing_ones_is_a_dot() -> None:
    positions = made_face.truth().positions.copy()
    positions[[9, 11, 12, 20]] = np.nan
    holed = Trajectories(positions=positions, markers=made_face.MARKERS, rate=60.0)
    line = curve(trajectories(across(a=holed), frames=(5, 39)).axes[0], "measured")
    assert (line.get_marker(), line.get_markevery()) == (".", [10 - 5])


def test_names_of_markers_are_drawn_as_text() -> None:
    markers = (r"$\frac$", "_hidden", "pay $1 or $2")
    take = replace(made_face.truth().keep(made_face.MARKERS[:3]), markers=markers, marker_set=None)
    drawn = store_figure(trajectories(across(a=take), markers=markers)).svg.decode()
    for name in markers:
        assert f"{name}<" in drawn


def test_recordings_without_a_common_marker_are_refused() -> None:
    whole = made_face.truth()
    with pytest.raises(ValueError, match="no marker in common"):
        trajectories(across(a=whole.keep(("nose",)), b=whole.keep(("chin",))))


@pytest.mark.parametrize(
    ("origins", "words"),
    [
        ((Origin.FILLED,), ["gap"]),
        ((Origin.REPAIRED,), ["repaired"]),
        ((Origin.FILLED, Origin.REPAIRED), ["gap or repaired"]),
        ((), []),
    ],
)
def test_the_shading_is_called_what_it_is(origins: tuple[Origin, ...], words: list[str]) -> None:
    take = made_face.truth()
    for place, origin in enumerate(origins):
        changed = np.zeros((made_face.FRAMES, len(take.markers)), dtype=bool)
        changed[15 + 3 * place, COLUMN] = True
        take = take.with_samples(take.positions, changed=changed, origin=origin)
    figure = trajectories(across(one=take), markers=("mouth_l",), frames=(0, 39))
    labels = [text.get_text() for text in figure.legends[0].get_texts()]
    assert labels == ["measured in all", *words]


def test_the_default_marker_is_the_one_with_most_repairs_in_the_frames_drawn() -> None:
    whole, changed = made_face.truth(), np.zeros((made_face.FRAMES, len(made_face.MARKERS)), bool)
    changed[30:38, 2] = True
    changed[5:8, 1] = True
    repaired = whole.with_samples(whole.positions, changed=changed, origin=Origin.REPAIRED)
    shown = across(one=repaired)
    assert trajectories(shown).axes[0].get_title() == made_face.MARKERS[2]
    assert trajectories(shown, frames=(0, 20)).axes[0].get_title() == made_face.MARKERS[1]
