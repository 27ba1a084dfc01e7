from __future__ import annotations

import pytest

from nodegraph.draw.boxes import clean, shape, shortened, width
from nodegraph.draw.picture import Alternative, Axis, Box, Socket


def test_texts_that_xml_cannot_hold_are_marked() -> None:
    assert clean("a\x00b\n c\ud800") == "a\ufffdb c\ufffd"


def test_long_texts_are_shortened() -> None:
    assert shortened("x" * 50, 10) == "x" * 9 + "…"
    assert shortened("x" * 10, 10) == "x" * 10


def test_widths_grow_with_text_and_type() -> None:
    assert width("iii", 10) < width("mmm", 10) == pytest.approx(27.6)
    assert width("abc", 10, bold=True) > width("abc", 10)
    assert width("日本", 10) == pytest.approx(21)
    assert width("il", 10, monospace=True) == pytest.approx(12.2)


def test_labels_that_all_arrows_fix_are_said_once_in_lines() -> None:
    box = Box("table", inputs=(Socket("scores"), Socket("truth"), Socket("hidden")))
    common = "actor=1, damage=occlusions, length=45"
    drawn = shape(box, "table", (("scores", f"{common}, fill=muscle"), ("truth", common)))
    notes = [text.text for text in drawn.texts if text.style == "note"]
    assert notes == ["at fill=muscle", "at actor=1,", "damage=occlusions, length=45"]
    alone = shape(box, "table", (("scores", common),))
    assert {text.hint for text in alone.texts if text.style == "note"} == {f"scores; at {common}"}


def test_lines_end_between_labels_and_settings() -> None:
    axis = Axis("occlusion", "1 marker, 4 markers, 12 markers")
    settings = "strategy: together, weight_missing: 1e-06, singular_values: 1"
    box = Box("gaps", ("cut", settings), (), (), (Alternative("pca", settings),), (axis,))
    drawn = shape(box, "gaps")
    texts = [[text for text, *_ in chip.texts] for chip in drawn.chips]
    assert texts == [
        ["occlusion: 1 marker, 4 markers,", "12 markers"],
        ["pca", "strategy: together,", "weight_missing: 1e-06,", "singular_values: 1"],
    ]
    assert [text.text for text in drawn.texts if text.style == "line"] == [
        *("cut", "strategy: together,", "weight_missing: 1e-06,", "singular_values: 1"),
    ]


def test_texts_of_ports_at_one_height_lie_beside_each_other() -> None:
    recording, hidden = Socket("recording"), Socket("hidden")
    readers = (("hidden", "an_error_in_the_gaps"),)
    level = shape(Box("a", (), (recording,), (hidden,)), "a", readers=readers)
    below = shape(Box("a", (), (recording,), (Socket("x"), hidden)), "a", readers=readers)
    both = shape(Box("a", (), (recording, recording), (hidden,)), "a", readers=readers)
    assert below.width < level.width == both.width


def test_a_note_stands_beside_its_port_unless_it_is_long() -> None:
    box = Box("a", (), (Socket("reference"),), (Socket("head_motion"),))
    for source, beside in (("model.neutral", True), ("actor_model.neutral", False)):
        height = {
            text.text: text.y for text in shape(box, "a", sources=(("reference", source),)).texts
        }
        assert (height["reference"] == height[f"from {source}"]) == beside
    readers = (("head_motion", "animation"),)
    drawn = shape(Box("a", (), (), box.outputs), "a", readers=readers)
    ends = {text.text: text.x for text in drawn.texts if text.at_end}
    assert ends["to animation"] - ends["head_motion"] > width("to animation", 11.0)
