"""The player in a browser: what is drawn is what the data say, and what is pressed happens."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page
from scipy.spatial.transform import Rotation

from nodegraph.report.page import page
from nodegraph.report.study import Section, Study
from nodegraph_mocap import Animation, HeadMotion, Origin, Panel, Playback, Trajectories
from nodegraph_mocap.player.page import render_playback
from nodegraph_mocap.specimens import FRAMES, animations, recordings
from tests.browser import drag, load, middle, until

RIGHT, UP = np.array([0.6, 0.0, -0.8]), np.array([0.0, 1.0, 0.0])
AXES = np.stack([RIGHT, UP, np.cross(RIGHT, UP)])
CENTRE = np.array([3.0, 15.0, 60.0])
RADIUS = 110.0
COLOURS = {Origin.MEASURED: "#2a86c8", Origin.FILLED: "#e0453c", Origin.REPAIRED: "#d98a00"}
PLAYER = "document.querySelectorAll('figure.playback')[%d].playback"
FIRST = PLAYER % 0
STAGE = "figure.playback .stage"
CANVAS = "figure.playback canvas"
HOSTILE = "<img src=x onerror=\"document.title='ran'\">"


def panel(shown: Trajectories | Animation, label: str = "one") -> Panel:
    return Panel(label=label, shown=shown, centre=CENTRE, right=RIGHT, up=UP, radius=RADIUS)


def written(folder: Path, *playbacks: Playback) -> Path:
    sections = tuple(
        Section(str(n), render_playback(shown, "x")) for n, shown in enumerate(playbacks)
    )
    file = folder / "report.html"
    file.write_text(page(Study("A title", sections=sections)), encoding="utf-8")
    return file


def show(tab: Page, folder: Path, *shown: Panel, truth: Panel | None = None, **size: Any) -> None:
    load(tab, written(folder, Playback(panels=shown, truth=truth)), **size)


def moved_by_hand() -> Trajectories:
    """Return a recording of every origin, which moves enough to be seen."""
    face = recordings()["filled, repaired and with sigma"]
    sway = np.linspace(0, 20, FRAMES)[:, None, None] * np.array([1.0, 0.5, 0.0])
    return replace(face, positions=face.positions + sway)


def projected(points: NDArray[np.float64], size: float, turn: float = 0.0) -> Any:
    """Return (..., 3) dots of points in a picture, the camera turned about the picture's up."""
    about = Rotation.from_rotvec(turn * UP).as_matrix()
    seen = (points - CENTRE) @ about.T @ AXES.T * size / (2 * RADIUS)
    return seen * [1, -1, 1] + [size / 2, size / 2, 0]


def dots(state: dict[str, Any], place: int = 0) -> NDArray[np.float64]:
    result = state["panels"][place]["dots"]
    return np.array([np.nan if value is None else value for value in result], float).reshape(-1, 3)


def pixel(tab: Page, x: float, y: float, place: int = 0) -> tuple[int, ...]:
    """Return red, green, blue and opacity of a canvas at a dot."""
    # from a copy, as the browser complains of much reading from what is drawn for eyes
    return tuple(
        tab.evaluate(
            "(() => { const copy = new OffscreenCanvas(1, 1);"
            "const pen = copy.getContext('2d', { willReadFrequently: true });"
            f"pen.drawImage(document.querySelectorAll('canvas')[{place}], {-int(x)}, {-int(y)});"
            "return Array.from(pen.getImageData(0, 0, 1, 1).data); })()"
        )
    )


def rgb(colour: str) -> tuple[int, ...]:
    return (*bytes.fromhex(colour[1:]), 255)


def test_markers_are_drawn_where_and_as_they_are(tab: Page, tmp_path: Path) -> None:
    face = replace(moved_by_hand(), marker_set=None)
    show(tab, tmp_path, panel(face))
    for frame in (0, 12, 22, FRAMES - 1):
        tab.evaluate(f"{FIRST}.seek({frame})")
        state = tab.evaluate(f"{FIRST}.state")
        assert (state["tick"], state["panels"][0]["frame"]) == (frame, frame)
        drawn = dots(state)
        expected = projected(face.positions[frame], state["panels"][0]["size"])
        assert np.array_equal(np.isnan(drawn), np.isnan(expected))
        assert np.nanmax(np.abs(drawn - expected)) < 0.05
        for marker, (x, y, _) in enumerate(drawn):
            if np.isfinite(x):
                assert pixel(tab, x, y) == rgb(COLOURS[Origin(face.origin[frame, marker])])


def test_edges_are_drawn_where_both_ends_are(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    gap = face.with_samples(
        np.where(np.arange(10)[:, None] == 4, np.nan, face.positions),
        changed=np.arange(10)[None] == np.full((FRAMES, 1), 4),
        origin=Origin.MISSING,
    )
    show(tab, tmp_path, panel(face), panel(gap))
    drawn = dots(tab.evaluate(f"{FIRST}.state"))
    lips = [face.markers.index(name) for name in ("lip_left", "lip_right")]
    x, y = drawn[lips, :2].mean(axis=0)
    assert pixel(tab, x, y, 0)[3] > 100
    assert pixel(tab, x, y, 1) == (0, 0, 0, 0)


def test_the_truth_is_a_circle_and_errors_have_colours(tab: Page, tmp_path: Path) -> None:
    truth = replace(recordings()["complete"], marker_set=None)
    changed = np.zeros(truth.origin.shape, bool)
    changed[:, 6] = True
    moved = truth.positions + changed[..., None] * np.array([0.0, 12.0, 0.0])
    filled = truth.with_samples(moved, changed=changed, origin=Origin.FILLED)
    show(tab, tmp_path, panel(filled, "guess"), truth=panel(truth, "truth"))
    state = tab.evaluate(f"{FIRST}.state")
    assert [panel["label"] for panel in state["panels"]] == ["truth", "guess"]
    there, guess = dots(state, 0)[6], dots(state, 1)[6]
    halfway = (there + guess) / 2
    assert pixel(tab, halfway[0], halfway[1], 1)[3] > 0  # the line from where it should be
    tab.click("figure.playback input[type=checkbox]")
    tab.evaluate(f"{FIRST}.state")
    assert pixel(tab, halfway[0], halfway[1], 1)[3] == 0
    tab.evaluate(
        "{ const one = document.querySelectorAll('.playback select')[1]; "
        "one.value = 'error'; one.dispatchEvent(new Event('change')); }"
    )
    tab.evaluate(f"{FIRST}.state")
    assert pixel(tab, guess[0], guess[1], 1) == (206, 86, 122, 255)
    assert pixel(tab, dots(state, 1)[0, 0], dots(state, 1)[0, 1], 1) == (42, 134, 200, 255)
    assert "20 mm and more" in tab.evaluate("document.querySelector('.legend').textContent")
    text = tab.evaluate("document.querySelectorAll('.readout')[1].textContent")
    assert text == "9 measured, 1 filled; 1 compared: mean error 12.00 mm, largest 12.00 mm"


def test_trails_show_where_markers_came_from(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(replace(moved_by_hand(), marker_set=None)))
    tab.evaluate(f"{FIRST}.seek(0)")
    x, y, _ = dots(tab.evaluate(f"{FIRST}.state"))[7]
    tab.evaluate(f"{FIRST}.seek(25)")
    tab.evaluate(f"{FIRST}.state")
    assert pixel(tab, x, y) == (0, 0, 0, 0)
    tab.click("figure.playback input[type=checkbox]")
    tab.evaluate(f"{FIRST}.state")
    assert pixel(tab, x, y)[3] > 0


def head() -> Animation:
    whole = animations()["complete"]
    turns = Rotation.from_euler("y", np.linspace(0, 0.5, FRAMES)[:, None]).as_matrix()
    motion = HeadMotion(
        rotations=turns, translations=np.full((FRAMES, 3), 2.0), scales=np.full(FRAMES, 0.9)
    )
    return replace(whole, head_motion=motion)


def test_a_head_is_posed_as_its_weights_and_motion_say(tab: Page, tmp_path: Path) -> None:
    whole = head()
    motion = whole.head_motion
    assert motion is not None
    show(tab, tmp_path, panel(whole), panel(replace(whole, head_motion=None)))
    for frame in (0, 17):
        tab.evaluate(f"{FIRST}.seek({frame})")
        state = tab.evaluate(f"{FIRST}.state")
        size = state["panels"][0]["size"]
        posed = whole.head.vertices + np.einsum(
            "k,kvi->vi", whole.morph_weights[frame], whole.head.morphs
        )
        turned = 0.9 * posed @ motion.rotations[frame].T + 2.0
        assert np.abs(dots(state, 0) - projected(turned, size)).max() < 0.1
        assert np.abs(dots(state, 1) - projected(posed, size)).max() < 0.1
        corners = dots(state, 1)[whole.head.faces]
        for x, y, _ in corners.mean(axis=1):
            assert pixel(tab, x, y, 1)[3] == 255
        x, y = corners[..., :2].max(axis=(0, 1)) + 5
        assert pixel(tab, x, y, 1) == (0, 0, 0, 0)


def test_the_nearest_triangle_is_seen_and_lit_from_the_front(tab: Page, tmp_path: Path) -> None:
    towards = AXES[2]
    corners = np.array([[-40, -40, 0], [40, -40, 0], [0, 40, 0]]) @ AXES + CENTRE
    vertices = np.concatenate([corners, corners + 30 * towards, corners - 30 * towards])
    whole = animations()["complete"]
    inside_out = [[3, 5, 4]]  # as seen from the front it turns the other way
    for faces, bright in (([[0, 1, 2], *inside_out, [6, 7, 8]], False), ([[6, 7, 8]], True)):
        flat = replace(
            whole.head,
            vertices=vertices,
            faces=np.array(faces),
            morphs=np.zeros((3, 9, 3)),
            marker_vertices=np.arange(9)[: len(whole.head.markers)],
            markers=whole.head.markers[:9],
        )
        show(tab, tmp_path, panel(replace(whole, head=flat)))
        state = tab.evaluate(f"{FIRST}.state")
        x, y, _ = dots(state)[:3].mean(axis=0)
        red, _, _, opacity = pixel(tab, x, y)
        assert opacity == 255
        assert (red > 180) == bright


def test_a_frame_without_weights_says_so(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(animations()["gaps"]))
    assert tab.evaluate(f"{FIRST}.state")["panels"][0]["dots"] is not None
    tab.evaluate(f"{FIRST}.seek(0)")
    assert tab.evaluate(f"{FIRST}.state")["panels"][0]["dots"] is None
    assert tab.evaluate("document.querySelector('.readout').textContent") == "weights are missing"
    tab.evaluate(f"{FIRST}.seek(5)")
    assert tab.evaluate(f"{FIRST}.state")["panels"][0]["dots"] is not None


def test_play_goes_on_and_pause_stops(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(recordings()["complete"]))
    assert not tab.evaluate(f"{FIRST}.state.playing")  # nothing moves by itself
    button = "document.querySelector('.playback button')"
    assert tab.evaluate(f"{button}.textContent") == "Play"
    tab.click(".playback button")
    until(tab, f"{FIRST}.tick > 3")
    assert tab.evaluate(f"{button}.textContent") == "Pause"
    tab.click(".playback button")
    until(tab, f"{button}.textContent === 'Play'")
    stopped = tab.evaluate(f"{FIRST}.seconds")
    tab.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    assert tab.evaluate(f"{FIRST}.seconds") == stopped


def test_the_clock_runs_slower_faster_and_round(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    show(tab, tmp_path, panel(face))
    passed = f"{{ {FIRST}.seek(0); {FIRST}.last = 0; {FIRST}.advance(80); }}"
    tab.evaluate(passed)
    assert tab.evaluate(f"{FIRST}.seconds") == pytest.approx(0.08)
    for speed in (4, 0.1):
        tab.evaluate(
            "{ const one = document.querySelector('.playback select'); "
            f"one.value = '{speed}'; one.dispatchEvent(new Event('change')); }}"
        )
        tab.evaluate(passed)
        assert tab.evaluate(f"{FIRST}.seconds") == pytest.approx(0.08 * speed)
    tab.evaluate(f"{{ {FIRST}.seconds = 0.66; {FIRST}.last = 0; {FIRST}.advance(100); }}")
    assert tab.evaluate(f"{FIRST}.seconds") == pytest.approx(0.67 - face.frames / face.rate)


def test_who_wants_little_motion_sees_a_take_once(tab: Page, tmp_path: Path) -> None:
    tab.emulate_media(reduced_motion="reduce")
    show(tab, tmp_path, panel(recordings()["complete"]))
    tab.evaluate(f"{FIRST}.seek({FRAMES - 2})")
    tab.evaluate(f"{FIRST}.play()")
    until(tab, f"!{FIRST}.playing")
    assert tab.evaluate(f"{FIRST}.state.tick") == FRAMES - 1


def test_the_slider_seeks(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(recordings()["complete"]))
    tab.click("figure.playback input[type=range]")
    state = tab.evaluate(f"{FIRST}.state")
    assert abs(state["tick"] - FRAMES / 2) < 2
    tab.keyboard.press("ArrowRight")
    assert tab.evaluate(f"{FIRST}.state.tick") == state["tick"] + 1
    clock = tab.evaluate("document.querySelector('.clock').textContent")
    tick = state["tick"] + 1
    assert clock == f"frame {tick} (0 to {FRAMES - 1}) \u00b7 {tick / 60:.2f} s of 0.67 s"


def test_the_slider_stays_where_it_is_while_the_clock_runs(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    again = np.arange(1200) % FRAMES
    long = replace(face, positions=face.positions[again], origin=face.origin[again])
    show(tab, tmp_path, panel(long))
    where = (
        "JSON.stringify(document.querySelector('figure.playback input').getBoundingClientRect())"
    )
    seen = []
    for tick in (0, 8, 111, 1199):
        tab.evaluate(f"{FIRST}.seek({tick})")
        assert tab.evaluate(f"{FIRST}.state.tick") == tick
        seen.append(tab.evaluate(where))
    assert len(set(seen)) == 1


def test_one_clock_drives_other_rates_and_lengths(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    half = replace(face, positions=face.positions[::2], origin=face.origin[::2], rate=30.0)
    short = recordings()["two frames"]
    show(tab, tmp_path, panel(half), panel(face), panel(short))
    for tick, frames in ((0, [0, 0, 0]), (1, [0, 1, 1]), (7, [3, 7, 1]), (39, [19, 39, 1])):
        tab.evaluate(f"{FIRST}.seek({tick})")
        state = tab.evaluate(f"{FIRST}.state")
        assert [panel["frame"] for panel in state["panels"]] == frames
    text = tab.evaluate(
        "[...document.querySelectorAll('.readout')].map((each) => each.textContent)"
    )
    assert text == ["10 measured", "10 measured", "ended after 0.03 s"]


def test_the_frames_of_a_thinned_take_keep_their_numbers(tab: Page, tmp_path: Path) -> None:
    thin = replace(recordings()["complete"], rate=20.0)
    load(tab, written(tmp_path, Playback(panels=(panel(thin),), every=3)))
    tab.evaluate(f"{FIRST}.seek(4)")
    tab.evaluate(f"{FIRST}.state")
    assert "frame 12 (0 to 117)" in tab.evaluate("document.querySelector('.clock').textContent")


@pytest.mark.parametrize("name", ["one frame", "all missing", "one marker"])
def test_odd_recordings_are_shown(tab: Page, tmp_path: Path, name: str) -> None:
    show(tab, tmp_path, panel(recordings()[name]), panel(animations()["one frame"]))
    drawn = dots(tab.evaluate(f"{FIRST}.state"))
    assert np.array_equal(np.isfinite(drawn[:, 0]), recordings()[name].present[0])
    text = tab.evaluate("document.querySelector('.readout').textContent")
    counts = np.bincount(recordings()[name].origin[0], minlength=2)
    expected = [(counts[1], "measured"), (counts[0], "missing")]
    assert text == ", ".join(f"{count} {word}" for count, word in expected if count)


def test_all_panels_turn_together_by_a_drag(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    show(tab, tmp_path, panel(face), panel(face, "other"))
    width = tab.evaluate("document.querySelector('canvas').clientWidth")
    drag(tab, CANVAS, width / 4, 0)
    state = tab.evaluate(f"{FIRST}.state")
    assert tab.evaluate(f"{FIRST}.camera.yaw") == pytest.approx(np.pi / 4, abs=0.02)
    turn = tab.evaluate(f"{FIRST}.camera.yaw")
    expected = projected(face.positions[0], state["panels"][0]["size"], turn)
    for place in (0, 1):
        assert np.abs(dots(state, place) - expected).max() < 0.1
    nose = face.markers.index("nose")
    tab.evaluate(f"{FIRST}.look(() => ({{ ...{FIRST}.camera, yaw: 0 }}))")
    front = dots(tab.evaluate(f"{FIRST}.state"))
    assert expected[nose, 0] > front[nose, 0]  # what is near goes with the hand


def swipe(tab: Page, steps: list[list[tuple[float, float]]]) -> None:
    """Touch the picture with fingers at offsets from its middle, step by step."""
    x, y = middle(tab, CANVAS)
    protocol = tab.context.new_cdp_session(tab)  # Playwright itself has one finger
    protocol.send("Emulation.setTouchEmulationEnabled", {"enabled": True, "maxTouchPoints": 2})
    for number, fingers in enumerate([*steps, []]):
        kind = "touchEnd" if not fingers else "touchMove" if number else "touchStart"
        points = [{"x": x + right, "y": y + down} for right, down in fingers]
        protocol.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})


def test_fingers_turn_move_and_enlarge(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(recordings()["complete"]))
    swipe(tab, [[(0.0, 0.0)], [(30.0, 0.0)], [(60.0, 0.0)]])
    assert tab.evaluate(f"{FIRST}.camera.yaw") > 0.2
    yaw = tab.evaluate(f"{FIRST}.camera.yaw")
    apart: list[list[tuple[float, float]]] = [
        [(-20 - reach, 5.0), (20 + reach + 10, 5.0)] for reach in (0.0, 10.0, 20.0)
    ]
    swipe(tab, apart)
    camera = tab.evaluate(f"{FIRST}.camera")
    assert camera["zoom"] == pytest.approx(90 / 50, rel=0.02)
    assert camera["yaw"] == yaw


def test_everything_can_be_done_with_keys(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(recordings()["complete"]))
    tab.evaluate(f"document.querySelector({STAGE!r}).focus()")

    def now(what: str) -> object:
        return tab.evaluate(f"{FIRST}.state.{what}")

    tab.keyboard.press("ArrowRight")
    tab.keyboard.press("ArrowRight")
    tab.keyboard.press("ArrowLeft")
    assert now("tick") == 1
    tab.keyboard.press("End")
    assert now("tick") == FRAMES - 1
    tab.keyboard.press("Home")
    assert now("tick") == 0
    tab.keyboard.press("Shift+ArrowRight")
    tab.keyboard.press("Shift+ArrowDown")
    tab.keyboard.press("Shift++")
    camera = tab.evaluate(f"{FIRST}.camera")
    assert camera["yaw"] > 0
    assert camera["pitch"] > 0
    assert camera["zoom"] == 1.25
    tab.keyboard.press("0")
    tab.keyboard.press("u")
    front = {"yaw": 0, "pitch": 0, "zoom": 1, "x": 0, "y": 0}
    assert tab.evaluate(f"{FIRST}.camera") == {**front, "over": -1}
    tab.keyboard.press("u")
    tab.keyboard.press("Space")
    assert now("playing")
    tab.keyboard.press("Space")
    assert not now("playing")


def test_every_control_has_a_name(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    show(tab, tmp_path, panel(face), panel(head(), "head"), truth=panel(face, "truth"))
    tree = tab.context.new_cdp_session(tab).send("Accessibility.getFullAXTree")["nodes"]
    named = {
        (node["role"]["value"], node["name"]["value"])
        for node in tree
        if "name" in node and not node.get("ignored")
    }
    controls = {"button", "slider", "checkbox", "combobox"}
    assert {name for role, name in named if role in controls} >= {
        *("Play", "One frame back", "One frame on", "Frame", "Speed", "Colour", "Truth", "Trails"),
        *("Smaller", "Larger", "From the front", "Errors", "Enlarge one"),
    }
    assert all(name for role, name in named if role in controls)
    assert {("image", "one"), ("image", "head"), ("image", "truth")} <= {
        ("image" if role == "img" else role, name) for role, name in named
    }


def filled(offset: float, marker: int = 6, first: int = 8, stop: int = 20) -> Trajectories:
    """Return a recording with one gap, filled off its truth by so many mm upwards."""
    whole = replace(recordings()["complete"], marker_set=None)
    changed = np.zeros(whole.origin.shape, bool)
    changed[first:stop, marker] = True
    moved = whole.positions + changed[..., None] * np.array([0.0, offset, 0.0])
    return whole.with_samples(moved, changed=changed, origin=Origin.FILLED)


def shown_panels(tab: Page) -> list[str]:
    labels = "[...document.querySelectorAll('.stage .name span')].map((one) => one.textContent)"
    return list(tab.evaluate(labels))


def test_of_many_panels_the_best_are_shown_until_others_are_chosen(
    tab: Page, tmp_path: Path
) -> None:
    truth = recordings()["complete"]
    fills = [panel(filled(offset), f"off by {offset}") for offset in (8, 7, 6, 5, 4, 3, 2, 1)]
    show(tab, tmp_path, *fills, truth=panel(truth, "truth"))
    assert shown_panels(tab) == ["truth", "off by 3", "off by 2", "off by 1"]
    chips = "[...document.querySelectorAll('.chooser button')].map((one) => one.textContent)"
    assert tab.evaluate(chips)[:2] == ["truth", "off by 8 8.00"]
    for place in (2, 4):
        tab.click(f".chooser button:nth-of-type({place})")
    assert shown_panels(tab) == ["truth", *(f"off by {offset}" for offset in (8, 6, 3, 2, 1))]
    assert len(tab.evaluate(f"{FIRST}.state.panels")) == 6
    tab.evaluate(f"{FIRST}.follow({{ method: 'off by 7', marker: null }})")
    assert shown_panels(tab) == ["truth", *(f"off by {offset}" for offset in (8, 7, 6, 2, 1))]
    selected = tab.evaluate("document.querySelector('.panel.selected .name span').textContent")
    assert selected == "off by 7"
    tab.click(".chooser button:nth-of-type(2)")
    assert "off by 8" not in shown_panels(tab)


def test_gaps_are_marked_and_visited_one_after_the_other(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, panel(filled(3.0)), panel(filled(3.0, 2, 22, 34), "other"))
    assert tab.evaluate("document.querySelectorAll('.gaps span').length") == 2
    seen = []
    for _ in range(3):
        tab.click(".playback [aria-label='Next gap']")
        seen.append((tab.evaluate(f"{FIRST}.state.tick"), tab.evaluate(f"{FIRST}.marker")))
    nose, cheek = recordings()["complete"].markers[6], recordings()["complete"].markers[2]
    assert seen[0] in ((14, nose), (28, cheek))
    assert set(seen) == {(14, nose), (28, cheek)}


def test_pointing_at_a_marker_names_it_and_a_click_enlarges(tab: Page, tmp_path: Path) -> None:
    face = filled(3.0)
    show(tab, tmp_path, panel(face), panel(face, "other"), truth=panel(filled(0.0), "truth"))
    tab.evaluate(f"{FIRST}.seek(10)")
    state = tab.evaluate(f"{FIRST}.state")
    x, y, _ = dots(state, 1)[6]
    share = state["panels"][1]["size"]
    left, top, width = tab.evaluate(
        "(() => { const canvas = document.querySelectorAll('canvas')[1];"
        "canvas.scrollIntoView({ block: 'center' });"
        "const box = canvas.getBoundingClientRect(); return [box.x, box.y, box.width]; })()"
    )
    at = left + x / share * width, top + y / share * width
    tab.mouse.move(*at)
    tip = "[...document.querySelectorAll('.tip:not([hidden])')].map((one) => one.textContent)"
    assert tab.evaluate(tip) == [f"{face.markers[6]}: filled, 3.00 mm off the truth"]
    tab.mouse.click(*at)
    wide = "document.querySelectorAll('canvas')[1].clientWidth"
    assert tab.evaluate(wide) > 1.5 * width
    tab.click(".playback [aria-label='Shrink one']")
    assert tab.evaluate(wide) == pytest.approx(width, abs=1)


def test_errors_are_drawn_ten_times_as_large(tab: Page, tmp_path: Path) -> None:
    truth = filled(0.0)
    show(tab, tmp_path, panel(filled(2.0)), truth=panel(truth, "truth"))
    tab.evaluate(f"{FIRST}.seek(10)")
    tab.evaluate(
        "{ const one = document.querySelectorAll('.playback select')[2]; "
        "one.value = '10'; one.dispatchEvent(new Event('change')); }"
    )
    state = tab.evaluate(f"{FIRST}.state")
    expected = projected(filled(20.0).positions[10], state["panels"][1]["size"])
    assert np.abs(dots(state, 1) - expected).max() < 0.6
    assert "10 times" in tab.evaluate("document.querySelector('.legend').textContent")


def test_labels_with_markup_are_text(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    named = replace(face, markers=(HOSTILE, *face.markers[1:]), marker_set=None)
    show(tab, tmp_path, panel(named, HOSTILE), panel(face, "</template><b>x"))
    assert tab.evaluate("document.querySelector('.playback .name span').textContent") == HOSTILE
    assert tab.evaluate("document.querySelectorAll('main img, main b').length") == 0
    assert tab.evaluate("document.title") == "A title"


@pytest.mark.parametrize("width", [360, 1400])
def test_nothing_is_wider_than_the_page(tab: Page, tmp_path: Path, width: int) -> None:
    face = recordings()["complete"]
    shown = [panel(face, f"a rather long label of method {number}") for number in range(5)]
    show(tab, tmp_path, *shown, truth=panel(face, "truth"), width=width, height=800)
    assert tab.evaluate("document.documentElement.scrollWidth") <= width
    figure = "document.querySelector('figure.playback')"
    assert tab.evaluate(f"{figure}.scrollWidth <= {figure}.clientWidth + 1")
    sizes = tab.evaluate("[...document.querySelectorAll('canvas')].map((one) => one.clientWidth)")
    assert min(sizes) > 140


def test_the_clock_stays_in_reach_of_every_picture(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    show(
        tab,
        tmp_path,
        *(panel(face, f"method {number}") for number in range(9)),
        width=390,
        height=600,
    )
    middle(tab, ".playback .panel:last-child canvas")
    assert tab.evaluate("scrollY") > 400
    assert 0 <= tab.evaluate("document.querySelector('.time').getBoundingClientRect().top") < 20
    assert tab.evaluate("document.querySelector('.clock').ariaLive") == "off"


def test_the_colours_follow_the_theme_that_the_reader_chooses(tab: Page, tmp_path: Path) -> None:
    face = recordings()["complete"]
    show(tab, tmp_path, panel(face))
    lips = [face.markers.index(name) for name in ("lip_left", "lip_right")]
    x, y = dots(tab.evaluate(f"{FIRST}.state"))[lips, :2].mean(axis=0)
    light = pixel(tab, x, y)
    tab.click("#theme")
    tab.evaluate(f"{FIRST}.state")
    assert pixel(tab, x, y) != light
    tab.evaluate("localStorage.clear()")


def test_paper_gets_the_colours_of_paper_and_no_controls(tab: Page, tmp_path: Path) -> None:
    tab.emulate_media(color_scheme="dark")
    show(tab, tmp_path, panel(recordings()["complete"]))
    face = recordings()["complete"]
    lips = [face.markers.index(name) for name in ("lip_left", "lip_right")]
    x, y = dots(tab.evaluate(f"{FIRST}.state"))[lips, :2].mean(axis=0)
    dark = pixel(tab, x, y)
    tab.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert pixel(tab, x, y)[:3] > dark[:3]
    tab.evaluate("dispatchEvent(new Event('afterprint'))")
    tab.emulate_media(media="print")
    assert tab.evaluate("getComputedStyle(document.querySelector('.options')).display") == "none"
    assert tab.evaluate("document.querySelector('.clock').offsetHeight") > 0
    assert tab.evaluate("document.querySelector('canvas').offsetHeight") > 100
    tab.emulate_media(media="screen")


def test_data_that_cannot_be_read_say_so(tab: Page, tmp_path: Path) -> None:
    file = written(tmp_path, Playback(panels=(panel(recordings()["complete"]),)))
    text = file.read_text(encoding="utf-8")
    start = text.index("<template>") + len("<template>")
    file.write_text(text[:start] + "!" + text[start:], encoding="utf-8")
    load(tab, file)
    expected = tab.evaluate("document.querySelector('figure.playback').textContent")
    assert expected.startswith("This playback cannot be shown: ")


def test_the_page_beside_the_report_plays(tab: Page, tmp_path: Path) -> None:
    whole = render_playback(Playback(panels=(panel(head(), "head"),)), "heads")
    file = tmp_path / "heads.html"
    file.write_bytes(whole.files[".html"])
    load(tab, file)
    tab.evaluate(f"{FIRST}.seek(3)")
    assert tab.evaluate(f"{FIRST}.state")["panels"][0]["frame"] == 3
