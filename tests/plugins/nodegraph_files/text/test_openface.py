"""Tables of OpenFace: of all that they hold, the points in space are read."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from nodegraph import get_node

FRAMES, POINTS = 6, 68
MORE = ("gaze_0_x", "eye_lmk_X_0", "pose_Tx")
LEFT_OUT = "left out: confidence, gaze_0_x, eye_lmk_X_0, pose_Tx, x_0, x_1, and 135 more"


def table(*, faces: int = 1, without: str = "", success: bool = True) -> tuple[str, object]:
    """Return a table as OpenFace writes one, and the points in space of its frames."""
    points = np.random.default_rng(0).uniform(-90, 90, (FRAMES, 3, POINTS)).round(1)
    points[:, 2] += 500
    head = ["frame", "face_id", "timestamp", "confidence", "success", *MORE]
    pixels = [f"{axis}_{number}" for axis in "xy" for number in range(POINTS)]
    space = [f"{axis}_{number}" for axis in "XYZ" for number in range(POINTS)]
    names = [*head, *pixels, *space, "AU01_r"]
    rows = []
    for frame in range(FRAMES):
        failed = frame == 2
        first = [
            frame + 1,
            frame % faces,
            round(frame / 30, 3),
            0.9,
            int(not failed),
            0.1,
            7.0,
            8.0,
        ]
        rows.append([*first, *[640] * len(pixels), *points[frame].ravel(), 0.5])
    kept = [
        place
        for place, name in enumerate(names)
        if name != without and (success or name not in ("success", "confidence"))
    ]
    lines = [[str(row[place]) for place in kept] for row in [names, *rows]]
    return "\n".join(", ".join(cells) for cells in lines) + "\n", points.transpose(0, 2, 1)


def test_the_points_in_space_are_read_and_frames_without_a_face_are_missing(tmp_path: Path) -> None:
    text, points = table()
    (tmp_path / "take.csv").write_text(text)
    with (
        pytest.warns(UserWarning, match="1 of 6 frames have success 0.* the first is row 3"),
        pytest.warns(UserWarning, match=LEFT_OUT),
    ):
        recording = get_node("read.recording")(path=tmp_path / "take.csv")
    assert recording.markers == tuple(f"landmark_{number}" for number in range(POINTS))
    assert recording.rate == 30.0
    expected = np.array(points)
    expected[2] = np.nan
    np.testing.assert_array_equal(recording.positions, expected)


@pytest.mark.filterwarnings("ignore:.* columns of OpenFace")
def test_a_table_without_successes_has_every_frame(tmp_path: Path) -> None:
    text, points = table(success=False)
    (tmp_path / "take.csv").write_text(text)
    recording = get_node("read.recording")(path=tmp_path / "take.csv", unit="cm")
    np.testing.assert_allclose(recording.positions, 10 * np.asarray(points))


@pytest.mark.filterwarnings("ignore:.* columns of OpenFace", "ignore:1 of 6 frames")
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"without": "Y_67"}, r":1: no column Y_67"),
        ({"without": "timestamp"}, r": no rate; set `rate`"),
        ({"faces": 2}, r": 2 faces, by the column face_id"),
    ],
)
def test_tables_that_are_no_recording_are_refused(
    tmp_path: Path, change: dict[str, object], message: str
) -> None:
    (tmp_path / "take.csv").write_text(table(**change)[0])  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=rf"take\.csv{message}"):
        get_node("read.recording")(path=tmp_path / "take.csv")


def test_points_in_pixels_alone_are_refused_with_the_option_that_is_missing(tmp_path: Path) -> None:
    (tmp_path / "take.csv").write_text(
        "frame, timestamp, confidence, success, x_0, y_0\n1, 0, 1, 1, 5, 6\n"
    )
    with pytest.raises(ValueError, match=r"take\.csv:1: .*-3Dfp"):
        get_node("read.recording")(path=tmp_path / "take.csv")
