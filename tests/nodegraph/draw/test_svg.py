from __future__ import annotations

import random
import re
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nodegraph.draw import Arrow, Box, Picture, Socket, svg

SVG = "{http://www.w3.org/2000/svg}"
HOSTILE = "\"><script>alert(1)</script>&amp;\x00'\ud800]]>"


def fill() -> Picture:
    recording = Socket("recording", "Trajectories")
    truth = Socket("truth", "Truth[Trajectories]")
    gaps = (Socket("gappy"), truth, Socket("hidden", "Mask"))
    error = (Socket("estimate"), truth, Socket("hidden"))
    table = (Socket("table"),)
    boxes = (
        Box("capture", ("read.recording",), (), (recording,), kind="input"),
        Box("gaps", ("gaps.cut",), (recording,), gaps, axes=("trial \u00d720", "length \u00d73")),
        Box("fill", (), (recording,), (recording,), ("guenter", "lin", "muscle")),
        Box("error", ("score.gaps",), error, table),
        Box("table", ("compare.table",), (Socket("tables"),), table, kind="report"),
        Box("faces", ("plot.faces",), (Socket("recordings"), truth), (), kind="report"),
    )
    arrows = (
        Arrow("capture", "recording", "gaps", "recording"),
        Arrow("gaps", "gappy", "fill", "recording"),
        Arrow("fill", "recording", "error", "estimate"),
        Arrow("gaps", "truth", "error", "truth", truth=True),
        Arrow("gaps", "hidden", "error", "hidden"),
        Arrow("error", "table", "table", "tables", gathers=True),
        Arrow("fill", "recording", "faces", "recordings", gathers=True, fixed="trial=0"),
        Arrow("gaps", "truth", "faces", "truth", truth=True, fixed="trial=0"),
    )
    return Picture("Three ways to fill", boxes, arrows)


def scattered(count: int, seed: int, links: int = 2) -> Picture:
    chance = random.Random(seed)
    ports = tuple(Socket(f"p{number}") for number in range(links))
    boxes = [Box(f"n{number}", ("a.b",) * (number % 4), ports, ports) for number in range(count)]
    chance.shuffle(boxes)
    arrows = tuple(
        Arrow(
            f"n{chance.randrange(target)}",
            chance.choice(ports).name,
            f"n{target}",
            port.name,
            gathers=chance.random() < 0.3,
            truth=chance.random() < 0.3,
        )
        for target in range(1, count)
        for port in ports
        if chance.random() < 0.8
    )
    return Picture("scattered", tuple(boxes), arrows)


def rectangles(root: ElementTree.Element) -> dict[str, tuple[float, float, float, float]]:
    """Return left, top, right, bottom of each box."""
    found = {}
    for group in root.iter(f"{SVG}g"):
        if "data-box" in group.attrib:
            place = re.fullmatch(r"translate\(([\d.]+) ([\d.]+)\)", group.attrib["transform"])
            assert place
            x, y = float(place[1]), float(place[2])
            frame = next(one for one in group.iter(f"{SVG}rect") if one.get("class") == "frame")
            wide, high = float(frame.attrib["width"]), float(frame.attrib["height"])
            found[group.attrib["data-box"]] = (x, y, x + wide, y + high)
    return found


def arrows_of(root: ElementTree.Element) -> list[ElementTree.Element]:
    return [group for group in root.iter(f"{SVG}g") if "data-arrow" in group.attrib]


def lines(group: ElementTree.Element) -> list[list[tuple[float, float]]]:
    """Return each line of an arrow as points along it."""
    path = next(one for one in group.iter(f"{SVG}path") if one.get("class") == "wire")
    drawn: list[list[tuple[float, float]]] = []
    for command, text in re.findall(r"([MVC])([^MVC]*)", path.attrib["d"]):
        values = [float(one) for one in text.split()]
        if command == "M":
            drawn.append([(values[0], values[1])])
            continue
        x, y = drawn[-1][-1]
        if command == "V":
            values = [x, y, x, values[0], x, values[0]]
        for step in range(1, 21):
            t = step / 20
            shares = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t * t * (1 - t), t**3)
            xs, ys = (x, *values[0::2]), (y, *values[1::2])
            along = sum(a * b for a, b in zip(shares, xs, strict=True))
            down = sum(a * b for a, b in zip(shares, ys, strict=True))
            drawn[-1].append((along, round(down, 6)))
    return drawn


def check(picture: Picture) -> None:
    root = ElementTree.fromstring(svg(picture))
    boxes = rectangles(root)
    width, height = float(root.attrib["width"]), float(root.attrib["height"])
    assert set(boxes) == {box.name for box in picture.boxes}
    for name, (left, top, right, bottom) in boxes.items():
        assert 0 <= left < right <= width
        assert 0 <= top < bottom <= height
        for other, (a, b, c, d) in boxes.items():
            apart = right < a or c < left or bottom < b or d < top
            assert name == other or apart, f"{name} overlaps {other}"
    drawn = arrows_of(root)
    assert len(drawn) == len(picture.arrows)
    for arrow, group in zip(picture.arrows, drawn, strict=True):
        check_arrow(arrow, group, boxes)


def check_arrow(
    arrow: Arrow, group: ElementTree.Element, boxes: dict[str, tuple[float, float, float, float]]
) -> None:
    source, target = boxes[arrow.source], boxes[arrow.target]
    assert source[3] < target[1], "an arrow must run downwards"
    for points in lines(group):
        assert points[0][1] == pytest.approx(source[3], abs=0.11)
        assert points[-1][1] == pytest.approx(target[1] - 7, abs=0.11)
        assert source[0] < points[0][0] < source[2]
        assert target[0] < points[-1][0] < target[2]
        downs = [y for _, y in points]
        assert downs == sorted(downs)
        for name, (left, top, right, bottom) in boxes.items():
            inside = [p for p in points if left < p[0] < right and top + 0.1 < p[1] < bottom - 0.1]
            assert not inside, f"{arrow} runs through {name}"


def test_boxes_stand_apart_and_arrows_run_down_around_them() -> None:
    check(fill())


@settings(max_examples=25, deadline=None)
@given(st.integers(1, 24), st.integers(0, 10**6), st.integers(1, 4))
def test_any_graph_is_drawn_so(count: int, seed: int, links: int) -> None:
    check(scattered(count, seed, links))


def test_two_hundred_boxes() -> None:
    check(scattered(200, 5))


def test_a_long_chain_needs_no_recursion() -> None:
    port = (Socket("x"),)
    boxes = tuple(Box(str(number), (), port, port) for number in range(3000))
    arrows = tuple(Arrow(str(n), "x", str(n + 1), "x") for n in range(2999))
    root = ElementTree.fromstring(svg(Picture("chain", boxes, arrows)))
    assert len(arrows_of(root)) == 2999


def test_arrows_say_what_they_are() -> None:
    drawn = {
        one.attrib["data-arrow"]: one for one in arrows_of(ElementTree.fromstring(svg(fill())))
    }
    assert drawn["gaps.truth error.truth"].attrib["class"] == "arrow truth"
    assert drawn["error.table table.tables"].attrib["class"] == "arrow gathers"
    assert drawn["gaps.gappy fill.recording"].attrib["class"] == "arrow"
    assert len(lines(drawn["error.table table.tables"])) == 3
    assert len(lines(drawn["gaps.gappy fill.recording"])) == 1
    title = drawn["fill.recording faces.recordings"].findtext(f"{SVG}title")
    assert title == "fill.recording to faces.recordings (at trial=0, gathers)"


def test_alternatives_axes_ports_and_fixed_labels_are_written() -> None:
    root = ElementTree.fromstring(svg(fill()))
    texts = [one.text for one in root.iter(f"{SVG}text")]
    for text in (
        "guenter",
        "lin",
        "muscle",
        "trial \u00d720",
        "length \u00d73",
        "gaps.cut",
        "Mask",
    ):
        assert text in texts
    assert texts.count("at trial=0") == 2
    assert root.findtext(f"{SVG}title") == "Three ways to fill"
    assert "gaps gaps.cut" in (root.findtext(f"{SVG}desc") or "")


def test_of_many_ports_those_without_arrow_are_counted_and_named_on_hover() -> None:
    outputs = tuple(Socket(f"out{number}") for number in range(8))
    boxes = (Box("a", (), (), outputs), Box("b", (), (Socket("x"),)))
    drawn = svg(Picture("many", boxes, (Arrow("a", "out5", "b", "x"),)))
    texts = {one.text for one in ElementTree.fromstring(drawn).iter(f"{SVG}text")}
    assert {"out5", "+7 more"} <= texts
    assert "out4" not in texts
    assert "<title>out0, out1, out2, out3, out4, out6, out7</title>" in drawn


def test_names_stay_text() -> None:
    ports = (Socket(HOSTILE, HOSTILE),)
    box = Box(HOSTILE, (HOSTILE,), ports, ports, (HOSTILE,), (HOSTILE,))
    last = Box("last", (), ports)
    arrow = Arrow(HOSTILE, HOSTILE, "last", HOSTILE, fixed=HOSTILE)
    drawn = svg(Picture(HOSTILE, (box, last), (arrow,)))
    tags = {one.tag.removeprefix(SVG) for one in ElementTree.fromstring(drawn).iter()}
    assert tags <= {"svg", "title", "desc", "style", "g", "rect", "line", "path", "text"}
    assert "<script" not in drawn


def test_nothing_is_fetched() -> None:
    addresses = set(re.findall(r"https?://[^\"' >]+", svg(fill())))
    assert addresses == {"http://www.w3.org/2000/svg"}
    assert not re.search(r"url\(|@import|href", svg(fill()))


def test_the_same_picture_is_drawn_the_same() -> None:
    assert svg(scattered(40, 3)) == svg(scattered(40, 3))


def test_an_empty_picture() -> None:
    root = ElementTree.fromstring(svg(Picture("", ())))
    assert root.findtext(f"{SVG}title") == "graph"


def test_a_circle_is_named() -> None:
    port = (Socket("x"),)
    boxes = (Box("a", (), port, port), Box("b", (), port, port))
    picture = Picture("circle", boxes, (Arrow("a", "x", "b", "x"), Arrow("b", "x", "a", "x")))
    with pytest.raises(ValueError, match="in a circle among or into: a, b"):
        svg(picture)
