"""What is read from files is played together, and nothing of it is lost in silence."""

from __future__ import annotations

import base64
import re
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from playwright.sync_api import Page, expect
from scipy.signal import welch

import nodegraph as ng
from nodegraph import Refusal
from nodegraph_mocap import MarkerSet, Marks, Origin, Trajectories, Weights
from nodegraph_mocap.player import fitting, spans, strip
from nodegraph_mocap.player.strip import MOST_STRETCHES, strip_of
from nodegraph_mocap.player.viewer import view
from nodegraph_mocap.specimens import animations, heads, marks, models, recordings, weights
from nodegraph_mocap.suspect import impulses
from tests.browser import assert_all_can_read_it, needs_axe, until
from tests.plugins.nodegraph_mocap.player.unpacked import Read

PLAYER = "document.querySelector('figure.playback').playback"


def packed(values: Mapping[str, object]) -> Read:
    """Return what the page of values holds for its script."""
    (data,) = re.findall(r"<template>(.*?)</template>", view(values).html)
    return Read(base64.b64decode(data))


def test_every_value_of_a_file_is_shown() -> None:
    for values in (recordings(), weights(), models(), heads(), animations()):
        for name, value in values.items():
            if getattr(value, "frames", 1) and len(getattr(value, "faces", [0])):
                head = packed({name: value}).head
                assert head["panels"] or head["curves"], name


def test_shapes_of_a_model_come_one_after_the_other() -> None:
    model = models()["complete"]
    read = packed({"model.npz": model})
    (panel,), (curves,) = read.head["panels"], read.head["curves"]
    assert curves["names"] == list(model.names)
    moved = read.positions(0) - model.neutral
    peaks = read.steps(curves["weights"]).argmax(axis=1)
    assert (np.diff(peaks) > 0).all()
    assert np.abs(moved[peaks] - model.shapes).max() < 0.01
    assert panel["frames"] == curves["frames"]
    assert panel["strip"] is None


def test_a_head_moves_as_weights_of_its_names_say() -> None:
    head, moving = heads()["complete"], weights()["complete"]
    named = replace(moving, names=head.names[: len(moving.names)])
    both = packed({"head.glb": head, "a.csv": named}).head
    assert (len(both["panels"]), both["panels"][0]["frames"]) == (1, named.frames)
    assert [curves["label"] for curves in both["curves"]] == ["a.csv"]
    assert "Name a head or model with these shapes, too" in view({"a.csv": named}).html
    strange = replace(moving, names=tuple(f"strange {name}" for name in moving.names))
    shown = view({"head.glb": head, "a.csv": strange}).html
    assert "head.glb does not move as a.csv says: the head has no morph target" in shown
    assert "head.glb: its shapes are shown one after the other" in shown


def test_a_model_moves_as_weights_of_its_names_say() -> None:
    model, moving = models()["complete"], weights()["complete"]
    count = min(len(model.names), len(moving.names))
    named = replace(moving, names=model.names[:count][::-1], values=moving.values[:, :count])
    read = packed({"model.npz": model, "a.csv": named})
    expected = model.neutral + np.tensordot(named.values[:, ::-1], model.shapes[:count], axes=1)
    assert np.abs(read.positions(0) - expected).max() < 0.01
    assert [curves["label"] for curves in read.head["curves"]] == ["a.csv"]
    strange = replace(named, names=tuple(f"strange {name}" for name in named.names))
    assert "the model has no shape for the weights" in view({"m": model, "a": strange}).html


def test_a_marker_set_joins_the_markers_of_a_recording() -> None:
    face = replace(recordings()["complete"], marker_set=None)
    first, second, *_ = face.markers
    edges = MarkerSet(markers=(first, second), edges=((first, second),))
    other = MarkerSet(markers=("elsewhere",))
    assert packed({"a": face, "markers.yaml": edges}).head["panels"][0]["edges"] == [[0, 1]]
    assert packed({"a": face, "markers.yaml": other}).head["panels"][0]["edges"] == []


def test_marks_without_a_recording_are_rows_of_spans(monkeypatch: pytest.MonkeyPatch) -> None:
    every = marks()["gaps"]
    monkeypatch.setattr(spans, "MOST_SPANS", 3)
    html = view({"<b>.csv": every, "markers.yaml": MarkerSet(markers=("nose",))}).html
    found = re.findall(r'class="(\w+)" style="left:([\d.]+)%;width:([\d.]+)%"', html)
    frames = max(mark.stop for mark in every.marks)
    assert [(kind, float(left), float(width)) for kind, left, width in found] == [
        (mark.kind, 100 * mark.start / frames, 100 * mark.frames / frames)
        for mark in every.marks[:3]
    ]
    assert "&lt;b&gt;.csv: what is marked, by frame, 0 to 39" in html
    assert "1 spans more are not drawn" in html
    assert "<li>" not in view({"none": Marks()}).html


def test_what_cannot_be_shown_is_refused() -> None:
    none = Trajectories(positions=np.empty((0, 1, 3)), markers=("nose",), rate=60.0)
    still = Weights(values=np.empty((0, 1)), names=("a",), rate=60.0)
    flat = replace(heads()["complete"], faces=np.empty((0, 3), dtype=np.int64))
    for value, message in (
        (none, "a has no frame"),
        (still, "a has no frame"),
        (flat, "the head of a has no triangles"),
        (MarkerSet(markers=("nose",)), "name a recording, too: a is drawn over one"),
    ):
        with pytest.raises(Refusal, match=message):
            view({"a": value})


def test_what_is_too_long_is_thinned_and_that_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    face, moving = recordings()["complete"], weights()["complete"]
    size = face.frames * len(face.markers) + moving.frames * len(moving.names)
    monkeypatch.setattr(fitting, "MOST_SAMPLES", size // 2)
    read = packed({"a": face, "b": moving})
    assert read.head["every"] == 2
    assert read.head["panels"][0]["rate"] == face.rate / 2
    assert read.head["curves"][0]["rate"] == moving.rate / 2
    assert "of 2 frames one is shown" in view({"a": face, "b": moving}).html


@pytest.mark.parametrize("frames", [1, 50, MOST_STRETCHES, 7 * MOST_STRETCHES + 3])
def test_no_gap_is_too_short_for_the_strip(frames: int) -> None:
    random = np.random.default_rng(frames)
    positions = random.normal(0, 30, (frames, 4, 3))
    positions[frames // 2, 1] = np.nan
    positions[:, 2] = np.nan
    face = Trajectories(positions=positions, markers=("a", "b", "c", "d"), rate=60.0)
    missing = strip_of(face).missing
    assert len(missing) == min(frames, MOST_STRETCHES)
    assert not missing[:, [0, 3]].any()
    assert np.count_nonzero(missing[:, 1]) == 1
    assert (missing[:, 2] == 255).all()


def test_made_samples_are_in_the_strip() -> None:
    face = recordings()["filled, repaired and with sigma"]
    shown = strip_of(face)
    for part, origin in ((shown.filled, Origin.FILLED), (shown.repaired, Origin.REPAIRED)):
        assert np.array_equal(part == 255, face.origin == origin)


def test_of_too_many_impulses_the_largest_are_marked(monkeypatch: pytest.MonkeyPatch) -> None:
    positions = np.zeros((100, 1, 3)) + np.random.default_rng(1).normal(0, 0.01, (100, 1, 3))
    for frame, size in ((20, 5.0), (50, 9.0), (80, 7.0)):
        positions[frame, 0, 0] = size
    face = Trajectories(positions=positions, markers=("a",), rate=50.0)
    assert strip_of(face).impulse_seconds.tolist() == [0.4, 1.0, 1.6]
    monkeypatch.setattr(strip, "MOST_IMPULSES", 2)
    fewer = strip_of(face)
    assert (fewer.impulse_seconds.tolist(), fewer.left_out) == ([1.0, 1.6], 1)


@contextmanager
def served(*files: str) -> Iterator[str]:
    """Start the command with files; yield the address that it prints."""
    words = [sys.executable, "-m", "nodegraph.cli.main", "view", *files, "--no-browser"]
    with subprocess.Popen(words, text=True, stdout=subprocess.PIPE) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip()
        finally:
            process.kill()


def check_marker_in_hand(tab: Page, face: Trajectories) -> None:
    """Check the strip of gaps, and speed and spectrum of a marker that has none."""
    rows = tab.locator(".rows[aria-label*='of take.npz']")
    faulty = ~face.present.all(axis=0) | (impulses(face.positions) > 0).any(axis=0)
    named = rows.locator(".labels").inner_text().split("\n")
    assert named == [face.markers[column] for column in np.flatnonzero(faulty)]
    rows.locator("canvas").click(position={"x": 100, "y": 14 * 3 + 7})
    assert tab.evaluate(f"{PLAYER}.state.hand.marker") == named[3]
    complete = int(np.flatnonzero(face.present.all(axis=0))[0])
    tab.locator("label:has-text('Marker') select").select_option(face.markers[complete])
    _, line = tab.evaluate(f"{PLAYER}.state.hand.lines")
    positions = face.positions[:, complete]
    speeds = np.linalg.norm(positions[2:] - positions[:-2], axis=1) * face.rate / 2
    assert np.abs(line["speeds"][1:-1] - speeds).max() < 0.02 * face.rate
    hertz, power = welch(positions, face.rate, nperseg=512, axis=0, detrend="constant")
    drawn = np.array(line["spectrum"])
    assert drawn[:, 0] == pytest.approx(hertz[1:])
    assert drawn[:, 1] == pytest.approx(np.sqrt(power.sum(axis=1))[1:], rel=0.1, abs=0.005)
    assert tab.locator(".hand-chart").count() == 2


@needs_axe
def test_files_are_seen_in_a_browser(tab: Page, tmp_path: Path) -> None:
    face = ng.get_node("read.recording")(path="sample:face")
    names = ("jawOpen", "<b>blink</b>", "still")
    time = np.arange(600)[:, np.newaxis] / 60
    values = np.sin(time * [1.0, 2.0, 0.0]) ** 2
    moving = Weights(values=values[:300], names=names, rate=60.0)
    shifted = replace(
        face,
        positions=face.positions[::2] + np.array([3.0, 0, 0]),
        origin=face.origin[::2],
        rate=30.0,
    )
    for node, value, name in (
        ("write.npz", face, "take"),
        ("write.npz", shifted, "shifted"),
        ("write.weights_csv", moving, "weights"),
    ):
        ((file, content),) = ng.get_node(node)(value, name=name).content.items()
        (tmp_path / file).write_bytes(content)
    with served(*map(str, sorted(tmp_path.iterdir()))) as address:
        tab.goto(address)
        tab.wait_for_selector(".viewed-file")
        until(tab, PLAYER)
        assert "take.npz" in tab.inner_text("h1")
        assert "30 Hz" in tab.inner_text(".viewed-facts >> nth=0")
        tab.evaluate(f"{PLAYER}.seek(90)")
        state = tab.evaluate(f"{PLAYER}.state")
        assert [panel["label"] for panel in state["panels"]] == ["shifted.npz", "take.npz"]
        rows = tab.locator(".rows").last
        assert rows.locator(".labels").inner_text().split("\n") == ["jawOpen", "<b>blink</b>"]
        assert "1 of 3 shapes stay below" in (rows.get_attribute("aria-label") or "")
        shown = [float(text) for text in rows.locator(".values").inner_text().split()]
        assert shown == pytest.approx(values[90, :2], abs=0.006)
        tab.evaluate(f"{PLAYER}.seek(301)")
        until(tab, f"{PLAYER}.state.tick === 301")
        assert rows.locator(".values").inner_text().split() == []
        rows.locator("canvas").click(position={"x": 5, "y": 5})
        assert tab.evaluate(f"{PLAYER}.state.tick") < 90
        tab.evaluate(f"{PLAYER}.seek(90)")
        drawn = tab.evaluate(f"{PLAYER}.state.panels[1]")
        across = tab.evaluate("document.querySelectorAll('.panel canvas')[1].clientWidth")
        tab.focus(".stage")
        tab.keyboard.press("u")
        over = tab.evaluate(f"{PLAYER}.state.panels[1]")
        turned = np.array(over["dots"], float)
        assert turned[:2] == pytest.approx(drawn["size"] - np.array(drawn["dots"][:2]), abs=1e-6)
        assert turned[2] == pytest.approx(drawn["dots"][2])
        tab.keyboard.press("u")
        first = 3 * face.markers.index("M_nose2")
        x, y = (value * across / drawn["size"] for value in drawn["dots"][first : first + 2])
        tab.locator(".panel canvas").nth(1).click(position={"x": x, "y": y})
        assert tab.evaluate(f"{PLAYER}.state.hand.marker") == "M_nose2"
        assert len(tab.evaluate(f"{PLAYER}.state.hand.lines")) == 2
        tab.locator("label:has-text('Over each other') input").press("Space")
        tab.evaluate(f"{PLAYER}.seek(90)")
        both = face.present[90].sum()
        assert tab.evaluate(f"{PLAYER}.state.panels[0].frame") == 45
        apart = f"take.npz: {both} markers compared, 3.00 mm apart on average"
        assert tab.locator(".panel .readout").all_inner_texts()[0].startswith(apart)
        assert tab.locator(".panel").count() == 1
        check_marker_in_hand(tab, face)
        tab.locator("label:has-text('Names') input").press("Space")
        before = tab.evaluate(f"{PLAYER}.state.tick")
        rows.press("ArrowRight")
        assert tab.evaluate(f"{PLAYER}.state.tick") == before + 1
        assert_all_can_read_it(tab)


def seen(tab: Page, markers: Sequence[str]) -> Trajectories:
    """Return the recording that the player shows."""
    panel = tab.evaluate(
        f"(({{ markers, frames, rate, places, origin }}) => ({{ markers, frames, rate, "
        f"places: [...places], origin: [...origin] }}))({PLAYER}.study.panels[0])"
    )
    places = np.array(panel["places"]).reshape(len(panel["markers"]), 3, -1).transpose(2, 0, 1)
    origin = np.array(panel["origin"], dtype=np.uint8).reshape(len(panel["markers"]), -1).T
    places[origin == Origin.MISSING] = np.nan
    whole = Trajectories(
        positions=places, markers=tuple(panel["markers"]), rate=panel["rate"], origin=origin
    )
    return whole.keep(markers)


@needs_axe
def test_samples_are_marked_by_hand_and_applied_in_a_run(
    tab: Page, tmp_path: Path, complaints: list[str]
) -> None:
    face = replace(recordings()["gaps"], marker_set=None)
    named = replace(face, markers=(*face.markers[:6], 'a "nose", up', *face.markers[7:]))
    ((file, content),) = ng.get_node("write.npz")(named).content.items()
    take, kept = tmp_path / file, tmp_path / f"{file}.marks.csv"
    take.write_bytes(content)
    other = tmp_path / "other.npz"
    other.write_bytes(content)
    with served(str(take), str(other)) as address:
        tab.goto(address)
        tab.wait_for_selector(".viewed-file")
        until(tab, PLAYER)
        marks = tab.get_by_role("group", name=f"Marked by hand in {file}", exact=True)
        status = marks.get_by_role("status")

        def mark(marker: str, span: tuple[int, int] | None, kind: str, other: str = "") -> None:
            tab.locator("label:has-text('Marker') select").select_option(marker)
            if span is None:
                marks.get_by_text("Whole take").click()
            else:
                tab.evaluate(f"{PLAYER}.seek({span[0]})")
                marks.get_by_text("From here").press("Enter")
                tab.evaluate(f"{PLAYER}.seek({span[1]})")
            marks.get_by_label("Other marker").fill(other)
            marks.get_by_role("button", name=kind, exact=True).press("Enter")

        mark("brow_left", (12, 8), "Bad")
        mark(named.markers[6], (20, 20), "Bad")
        mark("cheek_left", (2, 30), "Swap", "cheek_right")
        mark("cheek_left", (3, 5), "Name", "cheek_right")
        assert "cheek_right is there in 3 of these frames" in status.inner_text()
        mark("brow_left", (8, 9), "Name", "cheek_left")
        assert (
            "brow_left, frames 8 to 9: named cheek_left: there is no sample" in status.inner_text()
        )
        mark("lip_right", (2, 5), "Swap", "nonsense")
        assert "there is no marker nonsense" in status.inner_text()
        marks.get_by_text("lip_right, frames 2 to 5", exact=True).wait_for()
        marks.get_by_label("Other marker").fill("lip_left")
        marks.get_by_role("button", name="Swap", exact=True).press("Enter")
        marks.get_by_text("lip_right, frame 5", exact=True).wait_for()
        mark("forehead", None, "Name", "hairline")
        mark("lip_left", (0, 9), "Name", "corner")
        mark("brow_right", (0, 1), "Bad")
        marks.get_by_text("Undo").click()
        marks.get_by_text("What is marked").click()
        marks.get_by_role("button", name="cheek_left, frames 2 to 30: swapped with").press("Enter")
        assert tab.evaluate(f"[{PLAYER}.tick, {PLAYER}.state.hand.marker]") == [2, "cheek_left"]
        assert not marks.get_by_text("Click a marker").is_visible()
        expect(status).to_have_text(re.compile(rf"in 6 spans.*; kept in {file}\.marks\.csv$"))
        assert tab.locator(".rows .labels").first.inner_text().split("\n")[-1] == "corner"
        assert_all_can_read_it(tab, ".below")
        shown = status.inner_text()
        samples = re.fullmatch(r"(\d+) samples in 6 spans: (.*); kept in .*", shown)
        assert samples is not None
        tab.reload()
        until(tab, PLAYER)
        assert status.inner_text() == shown
        assert f"{file} is shown as it is marked in {kept.name}" in tab.inner_text("main")
        of_marks = tab.locator(".viewed-file", has=tab.get_by_role("heading", name=kept.name))
        assert "read by read.marks" in of_marks.inner_text()
        assert of_marks.locator("dt").count() == 0
        kept.write_text(kept.read_text() + "nose,0,1,bad,\n")
        mark("brow_right", (0, 1), "Bad")
        expect(status).to_have_text(re.compile("has changed since the page was loaded"))
        assert marks.get_by_text("Save marks").is_visible()
        assert [complaint for complaint in complaints if "409" not in complaint] == []
        complaints.clear()
        kept.write_text(kept.read_text().removesuffix("nose,0,1,bad,\n"))
        tab.evaluate(f"{PLAYER}.marks[0].takeBack()")
        expect(status).to_have_text(re.compile("kept in"))
        graph = tmp_path / "graph.yaml"
        graph.write_text(
            "nodegraph: 1\nnodes:\n"
            f"  take: {{use: read.recording, with: {{path: {file}}}}}\n"
            f"  marks: {{use: read.marks, with: {{path: {kept.name}}}}}\n"
            "  clean: {use: recording.apply_marks, in: {recording: take, marks: marks}}\n"
        )
        run = ng.run(graph, store=tmp_path / "store")
        clean = run["clean"].value
        there = seen(tab, clean.markers)
    assert take.read_bytes() == content
    assert not Path(f"{other}.marks.csv").exists()
    assert np.array_equal(there.origin, clean.origin)
    assert np.nanmax(np.abs(there.positions - clean.positions)) < 0.01
    run.save(tmp_path / "run")
    report = (tmp_path / "run" / "report.html").read_text(encoding="utf-8")
    assert f"{samples[1]} samples marked by hand: {samples[2]}" in report
