"""The view of a block in a browser: it draws what was packed, and does what is pressed."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page

from nodegraph import Rendered, json_script
from nodegraph.report.page import page
from nodegraph.report.study import Section, Study
from nodegraph_mocap import Origin, Trajectories
from nodegraph_mocap.gap.view import detail
from tests.browser import load, until
from tests.plugins.nodegraph_mocap.gap.test_pack import GAP, inputs
from tests.plugins.nodegraph_plot import made_face

HOSTILE = "</script><img src=x onerror=\"document.title='ran'\">"
BEST, REFERENCE, OTHER = "off by 0.25", "off by -0.5", "off by 1.0"
DETAIL = detail()
SHOW = """
nodegraph.define("test", ["page", "selection", "mocap/gap"], (page, selection, gap) => {
  const { packed, context } = page.data("block");
  const place = document.querySelector("#block-view");
  globalThis.view = gap.show(place, packed, { ...context, selection });
  globalThis.selection = selection;
});
"""


def show(
    tab: Page,
    folder: Path,
    given: Mapping[str, Mapping[str, object]],
    block: Mapping[str, object] = GAP,
    width: int = 1200,
) -> None:
    overview = {
        "methods": [{"label": method} for method in given],
        "groups": [{"best": [list(given).index(BEST)] if BEST in given else []}],
    }
    content = {
        "packed": DETAIL.pack(block, given),
        "context": {"overview": overview, "group": 0, "block": 0, "errors": [], "command": ""},
    }
    rendered = Rendered(
        '<div id="block-view"></div>' + json_script(content, "block"),
        scripts=(*DETAIL.scripts, SHOW),
        styles=DETAIL.styles,
    )
    file = folder / "report.html"
    study = Study("A title", sections=(Section("one", rendered),))
    file.write_text(page(study), encoding="utf-8")
    load(tab, file, width=width)


def methods() -> dict[str, dict[str, object]]:
    return inputs(0.25, -0.5, 1.0)


def frame(tab: Page) -> object:
    return tab.evaluate("document.querySelector('.gap-view .clock').textContent").split(",")[0]


def test_all_methods_are_drawn_in_their_roles_and_follow_the_selection(
    tab: Page, tmp_path: Path
) -> None:
    show(tab, tmp_path, methods())
    tab.evaluate(f"selection.set({{ reference: {json.dumps(REFERENCE)} }})")
    drawn = "[...document.querySelectorAll('.curves [data-line]')].map((one) => "
    roles = dict(tab.evaluate(f"{drawn}[one.dataset.line, one.getAttribute('class')])"))
    assert roles == {BEST: "best", REFERENCE: "reference", OTHER: "rest", "truth": "truth"}
    tab.evaluate(f"selection.set({{ method: {json.dumps(OTHER)} }})")
    roles = dict(tab.evaluate(f"{drawn}[one.dataset.line, one.getAttribute('class')])"))
    assert roles[OTHER] == "selected"
    labels = tab.evaluate(
        "[...document.querySelectorAll('.curves .words text')].map((one) => "
        "[one.querySelector('title').textContent, Number(one.getAttribute('y'))])"
    )
    assert {name for name, _ in labels} == {*methods(), "truth"}
    for k in range(3):
        places = sorted(y for _, y in labels[4 * k : 4 * k + 4])
        assert np.diff(places).min() >= 13.9
    tab.evaluate(f"selection.set({{ methods: {json.dumps([BEST])}, method: null }})")
    assert OTHER not in tab.evaluate(f"{drawn}one.dataset.line)")


def test_the_lines_lie_where_the_samples_are_at_one_scale(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, methods())
    paths = tab.evaluate(
        f"[...document.querySelectorAll('.curves [data-line={json.dumps(OTHER)}]')]"
        ".map((one) => one.getAttribute('d'))"
    )
    truth = tab.evaluate(
        "[...document.querySelectorAll('.curves [data-line=truth]')]"
        ".map((one) => one.getAttribute('d'))"
    )

    def points(path: str) -> dict[float, float]:
        pairs = (pair.split(",") for pair in path.replace("M", "L").split("L")[1:])
        return {float(x): float(y) for x, y in pairs}

    for line, true in zip(paths, truth, strict=True):
        assert len(points(line)) == 6 + 2
        apart = [points(true)[x] - y for x, y in points(line).items()]
        steps = np.diff(sorted(points(true).values()))
        assert len(steps) == 25
        assert apart[1:-1] == pytest.approx([apart[1]] * 6, abs=0.25)
    firsts = [list(points(line).values())[1] for line in paths]
    trues = [list(points(true).values())[10] for true in truth]
    assert np.ptp(np.subtract(trues, firsts)) < 0.25


def test_keys_step_and_play_and_the_slider_seeks(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, methods())
    assert frame(tab) == "frame 18"
    tab.evaluate("document.querySelector('.gap-view button').focus()")
    tab.keyboard.press("ArrowRight")
    tab.keyboard.press("ArrowRight")
    tab.keyboard.press("ArrowLeft")
    assert frame(tab) == "frame 19"
    tab.evaluate(
        "{ const one = document.querySelector('.gap-view input'); "
        "one.value = 2; one.dispatchEvent(new Event('input')); }"
    )
    assert frame(tab) == "frame 7"
    errors = tab.evaluate("document.querySelector('.gap-view .errors').textContent")
    assert errors.startswith("Off the truth here")
    assert f"{BEST} 0" in errors
    tab.click(".gap-view button")
    until(tab, "view.at > 4 && view.playing")
    tab.evaluate("document.querySelector('.curves').setAttribute('tabindex', 0)")
    tab.evaluate("document.querySelector('.curves').focus()")
    tab.keyboard.press("Space")
    assert not tab.evaluate("view.playing")


def test_a_link_shows_the_frame_that_was_seen(tab: Page, tmp_path: Path) -> None:
    show(tab, tmp_path, methods())
    assert tab.evaluate("location.hash") == ""
    tab.focus(".gap-view button")
    for _ in range(3):
        tab.keyboard.press("ArrowLeft")
    until(tab, "location.hash.includes('frame=15')")
    address = tab.url
    tab.goto("about:blank")
    tab.goto(address)
    assert frame(tab) == "frame 15"
    tab.evaluate("location.hash = '#select:frame=20'")
    until(tab, "view.at === 15")
    tab.evaluate("location.hash = '#select:frame=4000'")
    tab.reload()
    assert frame(tab) == "frame 18"


def test_who_wants_little_motion_sees_a_block_once(tab: Page, tmp_path: Path) -> None:
    tab.emulate_media(reduced_motion="reduce")
    show(tab, tmp_path, methods())
    tab.evaluate("view.move(24)")
    tab.evaluate("view.start()")
    until(tab, "!view.playing")
    assert frame(tab) == "frame 30"


def test_pointing_at_a_line_names_it_to_the_page_and_a_click_selects(
    tab: Page, tmp_path: Path
) -> None:
    show(tab, tmp_path, methods())
    x, y = tab.evaluate(
        "(() => { const line = "
        f"document.querySelector('.curves [data-line={json.dumps(OTHER)}]');"
        "line.scrollIntoView({ block: 'center' });"
        "const at = line.getPointAtLength(line.getTotalLength() / 2);"
        "const box = line.ownerSVGElement.getBoundingClientRect();"
        "return [box.x + at.x, box.y + at.y]; })()"
    )
    tab.mouse.move(x, y)
    assert tab.evaluate("document.querySelector('.curves .hovered').dataset.line") == OTHER
    assert tab.evaluate("document.querySelector('.curves .tip').textContent") == OTHER
    tab.mouse.click(x, y)
    assert tab.evaluate("selection.state.method") == OTHER


def test_a_suspect_sample_is_circled_and_opened(tab: Page, tmp_path: Path) -> None:
    given = methods()
    spiked = made_face.truth().positions.copy()
    spiked[16, made_face.GAP_MARKER, 2] += 9.0
    truth = replace(made_face.truth(), positions=spiked)
    show(tab, tmp_path, {method: {**ports, "truth": truth} for method, ports in given.items()})
    assert frame(tab) == "frame 16"
    assert tab.evaluate("document.querySelectorAll('.curves .suspect').length") == 3


def test_the_face_plays_in_space_with_all_methods_on_it(tab: Page, tmp_path: Path) -> None:
    given = methods()
    show(tab, tmp_path, given)
    truth = made_face.truth()
    tab.evaluate("view.move(13)")
    names = tab.evaluate("view.face.lines.map((line) => line.name)")
    assert set(names) == {*given, "truth"}

    def dots() -> dict[str, NDArray[np.float64]]:
        return dict(zip(names, np.array(tab.evaluate("view.face.dots")), strict=True))

    seen = dots()
    apart = {
        name: given[name]["estimate"].positions[18, made_face.GAP_MARKER]  # type: ignore[attr-defined]
        - truth.positions[18, made_face.GAP_MARKER]
        for name in (BEST, OTHER)
    }
    millimetre = np.linalg.norm(seen[OTHER] - seen["truth"]) / np.linalg.norm(apart[OTHER])
    for name, offset in apart.items():
        pixels = (seen[name] - seen["truth"])[:3] * [1, -1, 1] / millimetre
        assert pixels == pytest.approx(offset, abs=0.05)
    tab.focus(".gap-view .face")
    tab.keyboard.press("Shift+ArrowRight")
    turned = dots()
    assert frame(tab) == "frame 18"
    assert np.abs(turned["truth"] - seen["truth"]).max() > 1
    tab.keyboard.press("0")
    tab.keyboard.press("ArrowRight")
    assert frame(tab) == "frame 19"
    x, y = tab.evaluate(
        f"view.face.dots[{names.index(OTHER)}].map((value) => value * view.face.canvas.clientWidth "
        "/ view.face.canvas.width)"
    )[:2]
    tab.hover(".face canvas", position={"x": x, "y": y})
    assert tab.locator(".face .tip").inner_text() in given
    tab.click(".face canvas", position={"x": x, "y": y})
    assert tab.evaluate("selection.state.method") in given


def test_what_leaves_the_close_up_is_marked_at_its_edge(tab: Page, tmp_path: Path) -> None:
    far = {**inputs(0.25, -0.5), **inputs(90.0)}
    show(tab, tmp_path, far)
    outside = tab.locator(".close circle.outside")
    assert outside.evaluate_all("(dots) => dots.map((dot) => dot.dataset.line)") == ["off by 90.0"]
    x, y = (float(outside.get_attribute(name) or "nan") for name in ("cx", "cy"))
    assert 0 < x < 200
    assert y == pytest.approx(7, abs=0.1)  # above: it is off upwards
    caption = ".gap-view .quiet"
    assert "1 of 4 lines" in (tab.text_content(caption) or "")
    tab.evaluate("selection.set({ method: 'off by 90.0' })")
    assert outside.count() == 0
    assert "Hollow" not in (tab.text_content(caption) or "")


def hostile() -> dict[str, dict[str, object]]:
    def renamed(recording: Trajectories) -> Trajectories:
        markers = (*made_face.MARKERS[:7], HOSTILE, *made_face.MARKERS[8:])
        return replace(recording, markers=markers, marker_set=None)

    return {
        HOSTILE: {"estimate": renamed(made_face.filled(0.5)), "truth": renamed(made_face.truth())}
    }


def nowhere() -> dict[str, dict[str, object]]:
    whole = made_face.truth()
    missing = whole.with_samples(
        np.full_like(whole.positions, np.nan),
        changed=np.ones(whole.origin.shape, bool),
        origin=Origin.MISSING,
    )
    return {"a": {"estimate": missing, "truth": missing}}


def one_frame() -> dict[str, dict[str, object]]:
    whole = made_face.truth()
    single = replace(whole, positions=whole.positions[:1], origin=whole.origin[:1])
    return {"a": {"estimate": single, "truth": single}}


@pytest.mark.parametrize(
    ("given", "block"),
    [
        (hostile(), {"marker": HOSTILE, "start": 15, "frames": 6}),
        (nowhere(), GAP),
        (one_frame(), {"marker": "nose", "start": 0, "frames": 1}),
        ({"a": {"recording": made_face.truth()}}, {"marker": "nose"}),
    ],
    ids=["markup", "nothing", "one frame", "no truth"],
)
def test_odd_blocks_are_shown_without_a_complaint(
    tab: Page, tmp_path: Path, given: dict[str, dict[str, object]], block: dict[str, object]
) -> None:
    show(tab, tmp_path, given, block)
    tab.evaluate(f"selection.set({{ method: {json.dumps(next(iter(given)))} }})")
    tab.evaluate("view.seek(view.at + 1)")
    assert tab.evaluate("document.title") == "A title"
    assert tab.evaluate("document.querySelectorAll('.gap-view img').length") == 0
    paths = "[...document.querySelectorAll('.gap-view path')].map((one) => one.getAttribute('d'))"
    assert "NaN" not in "".join(filter(None, tab.evaluate(paths)))


def test_nothing_is_wider_than_a_phone(tab: Page, tmp_path: Path) -> None:
    given = {name * 4: ports for name, ports in methods().items()}
    show(tab, tmp_path, given, width=390)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
