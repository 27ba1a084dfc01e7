from __future__ import annotations

import random
import re
from dataclasses import replace
from itertools import chain as joined
from itertools import pairwise
from xml.etree import ElementTree

import pytest
from hypothesis import given
from hypothesis import strategies as st

from nodegraph.draw import Alternative, Arrow, Axis, Box, Picture, Socket, svg
from nodegraph.draw.boxes import width
from nodegraph.draw.picture import folded

SVG = "{http://www.w3.org/2000/svg}"
RIVALS = (Alternative("guenter"), Alternative("lin", "neighbours: 8"), Alternative("muscle"))
TRIAL = Axis("trial", "", ("seed", "sigma"), (("0", "7", "0.1"), ("first, last", "9", "0.2")))
HOSTILE = "\"><script>alert(1)</script>&amp;\x00'\ud800]]>"


def fill() -> Picture:
    recording = Socket("recording", "Trajectories")
    truth = Socket("truth", "Truth[Trajectories]")
    gaps = (Socket("gappy"), truth, Socket("hidden", "Mask"))
    error = (Socket("estimate"), truth, Socket("hidden"))
    table = (Socket("table"),)
    boxes = (
        Box("capture", ("read.recording",), (), (recording,), kind="input"),
        Box("gaps", ("gaps.cut",), (recording,), gaps, axes=(TRIAL, Axis("length", "5, 15"))),
        Box("fill", (), (recording,), (recording,), RIVALS),
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


def rectangles(
    root: ElementTree.Element, name: str = "data-box"
) -> dict[str, tuple[float, float, float, float]]:
    """Return left, top, right, bottom of each box, or frame."""
    corners = {}
    for group in root.iter(f"{SVG}g"):
        if name in group.attrib:
            place = re.fullmatch(r"translate\(([\d.]+) ([\d.]+)\)", group.attrib["transform"])
            assert place
            x, y = float(place[1]), float(place[2])
            frame = next(rect for rect in group.iter(f"{SVG}rect") if rect.get("class") != "shade")
            wide, high = float(frame.attrib["width"]), float(frame.attrib["height"])
            corners[group.attrib[name]] = (x, y, x + wide, y + high)
    return corners


def arrows_of(root: ElementTree.Element) -> list[ElementTree.Element]:
    return [group for group in root.iter(f"{SVG}g") if "data-arrow" in group.attrib]


def lines(group: ElementTree.Element) -> list[list[tuple[float, float]]]:
    """Return each line of an arrow as points along it."""
    path = next(element for element in group.iter(f"{SVG}path") if element.get("class") == "wire")
    drawn: list[list[tuple[float, float]]] = []
    for command, text in re.findall(r"([A-Z])([^A-Z]*)", path.attrib["d"]):
        values = [float(value) for value in text.split()]
        through = list(zip(values[0::2], values[1::2], strict=True))
        if command == "M":
            drawn.append(through)
        else:
            assert len(through) == {"L": 1, "C": 3}[command]
            drawn[-1] += along([drawn[-1][-1], *through])
    return drawn


def along(through: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Return points along a Bézier curve, by de Casteljau's construction."""
    curve = []
    for step in range(1, 21):
        points = through
        while len(points) > 1:
            points = [
                (a + (c - a) * step / 20, b + (d - b) * step / 20)
                for (a, b), (c, d) in pairwise(points)
            ]
        curve.append((round(points[0][0], 6), points[0][1]))
    return curve


def check(picture: Picture) -> ElementTree.Element:
    """Check that boxes stand apart, texts stay within them and arrows run around them."""
    root = ElementTree.fromstring(svg(picture))
    boxes = rectangles(root)
    check_texts(root)
    width, height = float(root.attrib["width"]), float(root.attrib["height"])
    assert set(boxes) == {box.name for box in picture.boxes}
    for group in arrows_of(root):
        assert all(0 <= x <= width for points in lines(group) for x, _ in points)
    for name, (left, top, right, bottom) in boxes.items():
        assert 0 <= left < right <= width
        assert 0 <= top < bottom <= height
        for other, (a, b, c, d) in boxes.items():
            apart = right < a or c < left or bottom < b or d < top
            assert name == other or apart, f"{name} overlaps {other}"
    drawn = arrows_of(root)
    assert len(drawn) == len(picture.arrows)
    for arrow, group in zip(picture.arrows, drawn, strict=True):
        if lines(group):
            check_arrow(arrow, group, boxes)
        else:
            assert arrow.source in texts_of(root, arrow.target)
    return root


def check_texts(root: ElementTree.Element) -> None:
    """Check that every text stays within its box, as wide as it is in a wide font."""
    for group in root.iter(f"{SVG}g"):
        if "data-box" in group.attrib:
            frame = next(rect for rect in group.iter(f"{SVG}rect") if rect.get("class") == "frame")
            for text in group.iter(f"{SVG}text"):
                left, right = reach(text)
                assert -0.1 <= left < right <= float(frame.attrib["width"]) + 0.1, text.text
                assert 0 < float(text.attrib["y"]) < float(frame.attrib["height"])


def reach(text: ElementTree.Element) -> tuple[float, float]:
    styles = {"name": (15.0, True, False), "line": (11.5, False, True), "type": (9.5, False, False)}
    size, bold, monospace = styles.get(text.get("class", ""), (11.0, False, False))
    wide = width(text.text or "", size, bold=bold, monospace=monospace)
    x = float(text.attrib["x"])
    anchor = text.attrib.get("text-anchor", "start")
    left = x - wide * {"start": 0.0, "middle": 0.5, "end": 1.0}[anchor]
    return left, left + wide


def box_of(root: ElementTree.Element, name: str) -> ElementTree.Element:
    (group,) = (each for each in root.iter(f"{SVG}g") if each.get("data-box") == name)
    return group


def notes_of(root: ElementTree.Element, box: str) -> list[str | None]:
    """Return the notes at the ports of a box."""
    texts = box_of(root, box).iter(f"{SVG}text")
    return [text.text for text in texts if text.get("class") == "note"]


def texts_of(root: ElementTree.Element, box: str) -> str:
    """Return all that a box says of its alternatives and ports."""
    return " ".join(text.text or "" for text in box_of(root, box).iter(f"{SVG}text"))


def check_arrow(
    arrow: Arrow,
    group: ElementTree.Element,
    boxes: dict[str, tuple[float, float, float, float]],
) -> None:
    source, target = boxes[arrow.source], boxes[arrow.target]
    drawn = lines(group)
    (begin, *_), (*_, end) = drawn[0], drawn[-1]
    assert end[0] == pytest.approx(target[0] - 7, abs=0.11)
    assert target[1] < end[1] < target[3]
    assert begin[0] == pytest.approx(source[2], abs=0.11)
    assert source[1] < begin[1] < source[3]
    for points in drawn:
        for name, (left, top, right, bottom) in boxes.items():
            inside = [
                p for p in points if left + 0.11 < p[0] < right - 0.11 and top < p[1] < bottom
            ]
            assert not inside, f"{arrow} runs through {name}"


def test_boxes_stand_apart_and_arrows_run_around_them() -> None:
    check(fill())


@given(st.integers(1, 60), st.integers(0, 10**6), st.integers(1, 4))
def test_any_graph_is_drawn_so(count: int, seed: int, links: int) -> None:
    check(scattered(count, seed, links))


def test_two_hundred_boxes() -> None:
    check(scattered(200, 5))


def plain(names: list[str], arrows: list[tuple[str, str]]) -> Picture:
    port = (Socket("x", "Trajectories"),)
    boxes = tuple(Box(name, ("smooth.bspline",), port, port) for name in names)
    return Picture(
        "plain", boxes, tuple(Arrow(source, "x", target, "x") for source, target in arrows)
    )


def chain(count: int) -> Picture:
    names = [f"step{number}" for number in range(count)]
    return plain(names, list(pairwise(names)))


def test_boxes_of_a_short_chain_stand_level_from_left_to_right() -> None:
    boxes = rectangles(check(chain(4)))
    lefts = [boxes[f"step{number}"][0] for number in range(4)]
    assert lefts == sorted(lefts)
    assert len({top for _, top, _, _ in boxes.values()}) == 1


@given(st.permutations(range(9)))
def test_what_need_not_cross_does_not(readers: list[int]) -> None:
    ways = [(f"a{number}", f"b{reader}") for number, reader in enumerate(readers)]
    boxes = rectangles(check(plain([name for way in ways for name in way], ways)))
    ends = sorted((boxes[source][1], boxes[target][1]) for source, target in ways)
    assert [below for _, below in ends] == sorted(below for _, below in ends)


def test_a_long_wire_runs_level_past_the_boxes_between() -> None:
    names = ["a", "b", "c", "d"]
    root = check(plain(names, [*pairwise(names), ("a", "d")]))
    boxes = rectangles(root)
    (drawn,) = (lines(group) for group in arrows_of(root) if group.get("data-arrow") == "a.x d.x")
    ((*points,),) = drawn
    assert len({y for x, y in points if boxes["b"][0] <= x <= boxes["c"][2]}) == 1
    assert len({box[1] for box in boxes.values()}) == 1


def test_what_is_wider_than_a_page_goes_on_below_like_lines_of_text() -> None:
    root = check(chain(20))
    boxes = list(rectangles(root).values())
    assert 700 < float(root.attrib["width"]) < 900
    assert len({top for _, top, _, _ in boxes}) == 4
    assert sorted(boxes, key=lambda box: (box[1], box[0])) == boxes
    assert len({left for left, _, _, _ in boxes}) < 10  # one column stands below the other


def test_an_arrow_past_a_row_is_named_at_its_ends_and_to_the_next_row_it_is_whole() -> None:
    names = [f"step{number}" for number in range(20)]
    root = check(plain(names, [*pairwise(names), ("step0", "step19")]))
    arrows = {group.get("data-arrow"): lines(group) for group in arrows_of(root)}
    rows = {name: box[1] for name, box in rectangles(root).items()}
    onward = [pair for pair in pairwise(names) if rows[pair[0]] != rows[pair[1]]]
    assert len(onward) == 3
    assert {name for name, drawn in arrows.items() if not drawn} == {"step0.x step19.x"}
    assert [notes_of(root, name) for name in names] == [[]] * 19 + [["from step0"]]
    port, both = (Socket("x"),), (Socket("x"), Socket("y"))
    steps = [Box(name, ("smooth.bspline",), port, port) for name in names]
    first = replace(steps[0], outputs=both)
    last = replace(steps[-1], inputs=(*port, Socket("z")))
    ways = (*chain(20).arrows, Arrow("step0", "y", "step19", "z"))
    root = check(Picture("", (first, *steps[1:-1], last), ways))
    assert notes_of(root, "step0") == ["to step19"]
    assert notes_of(root, "step19") == ["from step0.y"]
    assert "read from box a" in {text.text for text in root.iter(f"{SVG}text")}


def test_an_arrow_that_passes_a_box_to_a_side_input_is_named_at_its_ends() -> None:
    root = check(fill())
    drawn = {group.get("data-arrow"): bool(lines(group)) for group in arrows_of(root)}
    assert drawn["fill.recording error.estimate"]
    assert not drawn["gaps.truth error.truth"]
    assert notes_of(root, "error") == ["from gaps", "from gaps"]
    assert notes_of(root, "gaps")[:2] == ["to error, faces", "to error"]
    assert "from gaps" in notes_of(root, "faces")


def test_an_arrow_that_passes_a_box_to_a_row_is_named_there() -> None:
    port = (Socket("x"),)
    rows = tuple(Alternative(name, "order: 3", name) for name in ("filled", "despiked"))
    boxes = (*plain(["filled", "despiked"], []).boxes, Box("steps", (), port, (), rows))
    ways = [("filled", "despiked"), ("filled", "steps"), ("despiked", "steps")]
    arrows = tuple(Arrow(source, "x", target, "x") for source, target in ways)
    root = check(Picture("", boxes, arrows))
    drawn = {group.get("data-arrow"): bool(lines(group)) for group in arrows_of(root)}
    assert drawn == {
        "filled.x despiked.x": True,
        "filled.x steps.x": False,
        "despiked.x steps.x": True,
    }
    assert notes_of(root, "steps") == ["from filled", "from despiked"]  # and no settings


def test_a_box_without_inputs_tells_what_it_does_beside_its_outputs() -> None:
    outputs = (Socket("detections"), Socket("neutral"), Socket("truth"))
    box = Box("face", ("synthesize.face", "seconds: 8 s"), (), outputs, does="Make a face")
    texts = [*check(Picture("", (box,))).iter(f"{SVG}text")]
    heights = {text.text: float(text.attrib["y"]) for text in texts}
    assert heights["seconds: 8 s"] < heights["truth"]
    assert {text.text for text in texts if text.get("text-anchor") == "end"} == {
        socket.name for socket in outputs
    }


def test_a_box_that_no_arrow_joins_stands_in_the_first_row_with_room() -> None:
    port = (Socket("x"),)
    names = ["a", "b", "c", "d"]
    wide = [Box(name, ("x" * 42,), port, port) for name in names]
    alone = [Box("alone", (), (), port), Box("large", ("x" * 42,), (), port)]
    arrows = tuple(Arrow(source, "x", target, "x") for source, target in pairwise(names))
    boxes = rectangles(check(Picture("", (*wide, *alone), arrows)))
    assert boxes["a"][1] == boxes["b"][1] == boxes["alone"][1] < boxes["c"][1]
    assert boxes["alone"][0] > boxes["b"][2]
    assert boxes["large"][1] > boxes["c"][3]


def test_labels_that_are_fixed_once_are_not_said_again_further_on() -> None:
    port, both = (Socket("x"),), (Socket("x"), Socket("y"))
    boxes = (
        Box("take", (), (), both),
        Box("still", (), port, port),
        Box("solved", (), both, port),
    )
    arrows = (
        Arrow("take", "x", "still", "x", fixed="actor=0"),
        Arrow("still", "x", "solved", "x"),
        Arrow("take", "y", "solved", "y", fixed="actor=0, trial=1"),
    )
    root = check(Picture("", boxes, arrows))
    assert notes_of(root, "still") == ["at actor=0"]
    assert notes_of(root, "solved") == ["from take", "at trial=1"]


def test_parts_that_share_only_their_data_and_the_report_stand_one_below_the_other() -> None:
    port = (Socket("x"),)
    parts = [[f"{part}{at}" for at in range(5)] for part in "ab"]
    boxes = [Box("take", (), (), port), *plain([*joined(*parts)], []).boxes, Box("end", (), port)]
    ways = [*joined(*map(pairwise, parts)), *(("take", part[0]) for part in parts)]
    ways += [(part[-1], "end") for part in parts]
    arrows = tuple(Arrow(source, "x", target, "x") for source, target in ways)
    placed = rectangles(check(Picture("", tuple(boxes), arrows)))
    first, second = ([placed[name] for name in part] for part in parts)
    assert max(bottom for *_, bottom in first) < min(top for _, top, *_ in second)
    boxes[-1] = replace(boxes[-1], kind="report")
    root = check(Picture("", tuple(boxes), arrows))
    drawn = {group.get("data-arrow"): lines(group) for group in arrows_of(root)}
    assert drawn["b4.x end.x"]
    assert not drawn["a4.x end.x"]
    assert rectangles(root)["end"][1] > rectangles(root)["a4"][3]


def test_one_output_of_a_row_leads_to_the_next_and_others_are_named() -> None:
    port, both = (Socket("x"),), (Socket("x"), Socket("y"))
    wide = ("x" * 42,)
    boxes = (
        Box("take", wide, (), port),
        Box("align", wide, port, both),
        Box("one", wide, port, port),
        Box("two", wide, port, port),
        Box("end", wide, both),
    )
    ways = (("take", "x", "align"), ("align", "x", "one"), ("align", "y", "two"))
    arrows = (
        *(Arrow(source, output, target, "x") for source, output, target in ways),
        Arrow("one", "x", "end", "x"),
        Arrow("two", "x", "end", "y"),
    )
    root = check(Picture("", boxes, arrows))
    assert rectangles(root)["align"][3] < rectangles(root)["one"][1]
    drawn = {group.get("data-arrow"): bool(lines(group)) for group in arrows_of(root)}
    assert drawn["align.x one.x"]
    assert not drawn["align.y two.x"]
    assert notes_of(root, "two") == ["from align.y"]
    assert notes_of(root, "align") == ["to two"]


def test_the_arrow_of_an_alternative_with_its_own_source_ends_at_its_row() -> None:
    port = (Socket("x"),)
    own = (Alternative("own", source="repaired"), Alternative("twice", source="repaired"))
    boxes = (
        Box("damage", outputs=port),
        Box("repaired", inputs=port, outputs=port),
        Box("fill", inputs=port, alternatives=(*RIVALS * 5, *own)),
    )
    ways = [("damage", "repaired"), ("damage", "fill"), ("repaired", "fill")]
    arrows = tuple(Arrow(source, "x", target, "x") for source, target in ways)
    root = check(Picture("", boxes, arrows))
    _, top, _, _ = rectangles(root)["fill"]
    rows = {
        chip.get("data-alternative"): top + float(rect.attrib["y"]) + 9.5
        for chip in root.iter(f"{SVG}g")
        for rect in chip.findall(f"{SVG}rect")
        if chip.get("data-alternative")
    }
    ends = [{drawn[-1][1] for drawn in lines(group)} for group in arrows_of(root)]
    assert sorted(ends[2]) == pytest.approx([rows["own"], rows["twice"]], abs=0.11)
    assert max(ends[1]) < min(rows.values())


def test_what_is_read_from_another_row_stands_before_its_reader() -> None:
    names = [f"step{number}" for number in range(8)]
    ways = [*pairwise(names), ("step1", "late"), ("late", "step7")]
    boxes = rectangles(check(plain([*names, "late"], ways)))
    assert boxes["late"][0] == boxes["step6"][0]
    assert boxes["step1"][1] < boxes["late"][1]


def test_lines_that_turn_side_by_side_lie_apart() -> None:
    port, several = (Socket("x"),), tuple(Socket(f"p{number}") for number in range(5))
    boxes = [Box(f"a{number}", ("a.b",), (), port) for number in range(5)]
    boxes += [Box("low", (), several, several)]
    boxes += [Box(f"b{number}", ("a.b",), port) for number in range(5)]
    arrows = [Arrow(f"a{number}", "x", "low", f"p{number}") for number in range(5)]
    arrows += [Arrow("low", f"p{number}", f"b{number}", "x") for number in range(5)]
    root = check(Picture("", tuple(boxes), tuple(arrows)))
    middles: dict[bool, set[float]] = {True: set(), False: set()}
    for group in arrows_of(root):
        ((begin, *between, end),) = lines(group)
        half = (begin[1] + end[1]) / 2
        _, x = min((abs(y - half), x) for x, y in between)
        if abs(begin[1] - end[1]) > 40:
            middles[begin[1] < end[1]].add(x)
    for xs in middles.values():
        assert len(xs) == 4
        assert all(second - first > 5 for first, second in pairwise(sorted(xs)))


def test_what_the_report_shows_is_below_all_boxes_and_names_its_sources() -> None:
    steps = chain(20)
    port, both = (Socket("in"),), (Socket("in"), Socket("like"))
    shows = (Box("table", (), port, kind="report"), Box("faces", (), both, kind="report"))
    ends = [("step0", "table", "in"), ("step19", "faces", "in"), ("step2", "faces", "like")]
    arrows = [Arrow(source, "x", name, port) for source, name, port in ends]
    arrows.append(Arrow("step1", "x", "faces", "like"))
    picture = folded(Picture("", (*steps.boxes, *shows), (*steps.arrows, *arrows)))
    root = check(picture)
    assert not any(
        lines(group) for group in arrows_of(root) if "report" in group.attrib["data-arrow"]
    )
    placed = rectangles(root)
    left, top, right, _ = placed.pop("report")
    assert top > max(bottom for *_, bottom in placed.values())
    assert left <= min(box[0] for box in placed.values())
    assert right >= max(box[2] for box in placed.values())
    told = [text.text for text in box_of(root, "report").iter(f"{SVG}text")]
    assert told == [
        *("In the report", "from step0", "table"),
        *("from step1, step2, step19", "faces"),
    ]
    assert all(notes_of(root, f"step{number}") == [] for number in range(20))
    marked = [
        name
        for name in placed
        if any(each.get("class") == "listed" for each in box_of(root, name).iter())
    ]
    assert marked == ["step0", "step1", "step2", "step19"]
    legend = [text.text for text in root.iter(f"{SVG}text")]
    assert legend.count("in the report") == 1


def test_what_the_report_shows_stands_in_columns_that_a_page_holds() -> None:
    port = (Socket("x"),)
    sources = tuple(Box(f"score{number}", outputs=port) for number in range(9))
    boxes = tuple(Box(f"of_{each.name}", (), port, kind="report") for each in sources)
    arrows = tuple(Arrow(each.name, "x", f"of_{each.name}", "x") for each in sources)
    root = check(folded(Picture("", (*sources, *boxes), arrows)))
    places: dict[str, list[str]] = {}
    for text in box_of(root, "report").iter(f"{SVG}text"):
        if text.get("class") == "port":
            places.setdefault(text.attrib["y"], []).append(text.attrib["x"])
    assert sum(map(len, places.values())) == 9
    assert 1 < len(places) < 9
    assert all(len({*row}) == len(row) for row in places.values())


def test_an_arrow_to_the_next_row_crosses_nothing_on_its_way_out() -> None:
    ways = [
        *(("take", name) for name in ("tested", "overlap", "middle", "end")),
        *(("middle", "others"), ("end", "others"), ("tested", "gaps"), ("gaps", "joined")),
        *(("others", "gaps"), ("joined", "fill")),
        *(("fill", "filled"), ("filled", "error")),
    ]
    port = (Socket("x"),)
    boxes = [Box(name, ("x" * 29,), port, port) for name in dict.fromkeys(joined(*ways))]
    arrows = tuple(Arrow(source, "x", target, "x") for source, target in ways)
    root = check(Picture("", tuple(boxes), arrows))
    whole = filter(lines, arrows_of(root))
    drawn = {group.attrib["data-arrow"]: lines(group)[0] for group in whole}
    placed = rectangles(root)
    assert placed["tested"][2] < placed["others"][0]
    assert placed["others"][3] < placed["gaps"][1]
    assert "tested.x gaps.x" not in drawn  # of two boxes the one that more lead to
    down = max(x for x, _ in drawn["others.x gaps.x"])
    assert all(x < down for name in ("middle", "end") for x, _ in drawn[f"{name}.x others.x"])


def test_a_graph_that_is_used_as_a_node_is_one_box_among_the_folded() -> None:
    port = (Socket("x"),)
    boxes = (
        Box("take", (), (), port, kind="input"),
        Box("damage.noise", (), port, port, axes=(Axis("sigma", "0, 1"),)),
        Box("damage.hits", (), port, port, axes=(Axis("sigma"), Axis("share", "1, 2"))),
        Box("damage.hit", ("damage.yaml",), port, port, passes=True),
        Box("damage", ("damage.yaml",), port, port, passes=True),
        Box("score", (), (Socket("x"), Socket("y")), (), (Alternative("own", source="damage"),)),
    )
    arrows = (
        Arrow("take", "x", "damage.noise", "x"),
        Arrow("damage.noise", "x", "damage.hits", "x"),
        Arrow("damage.hits", "x", "damage.hit", "x"),
        Arrow("damage.noise", "x", "damage", "x"),
        Arrow("damage", "x", "score", "x", fixed="length=5"),
        Arrow("damage.hit", "x", "score", "y"),
    )
    picture = folded(Picture("", boxes, arrows))
    take, damage, score = picture.boxes
    assert (take.name, damage.name, damage.lines) == ("take", "damage", ("damage.yaml",))
    assert {*map(str, damage.axes)} == {"sigma: 0, 1", "share: 1, 2"}
    assert [socket.shown for socket in damage.inputs] == ["x"]
    assert [socket.name for socket in damage.outputs] == ["x", "hit"]
    assert score.alternatives == (Alternative("own", source="damage.x"),)
    assert [(each.source, each.source_port, each.target_port) for each in picture.arrows] == [
        ("take", "x", "take.x"),
        ("damage", "x", "x"),
        ("damage", "hit", "y"),
    ]
    check(picture)


def test_a_source_that_is_needed_late_stands_before_its_reader() -> None:
    names = ["a", "b", "c", "late"]
    boxes = rectangles(check(plain(names, [("a", "b"), ("b", "c"), ("late", "c")])))
    assert boxes["late"][0] == boxes["b"][0]


def test_a_long_chain_needs_no_recursion() -> None:
    root = ElementTree.fromstring(svg(chain(1100)))
    assert len(arrows_of(root)) == 1099


NESTED = plain(
    ["capture", "clean.despike", "clean.fine.fill", "clean.fine", "clean.smooth", "clean", "raw"],
    [
        ("capture", "clean.despike"),
        ("clean.despike", "clean.fine.fill"),
        ("clean.fine.fill", "clean.fine"),
        ("clean.fine", "clean.smooth"),
        ("clean.smooth", "clean"),
        ("clean.fine.fill", "clean"),
        ("capture", "raw"),
    ],
)


def test_names_with_dots_stand_in_frames() -> None:
    root = check(NESTED)
    boxes, frames = rectangles(root), rectangles(root, "data-frame")
    assert set(frames) == {"clean", "clean.fine"}
    inside = {
        "clean": {"clean.despike", "clean.fine.fill", "clean.fine", "clean.smooth", "clean"},
        "clean.fine": {"clean.fine.fill", "clean.fine"},
    }
    for frame, (left, top, right, bottom) in frames.items():
        for name, (a, b, c, d) in boxes.items():
            if name in inside[frame]:
                assert left < a < c < right, name
                assert top < b < d < bottom, name
            else:
                assert right < a or c < left or bottom < b or d < top, name
    labels = [
        element.text for element in root.iter(f"{SVG}text") if element.get("class") == "label"
    ]
    assert labels == ["clean", "fine"]
    names = {element.text for element in root.iter(f"{SVG}text") if element.get("class") == "name"}
    assert names == {"capture", "despike", "fill", "fine", "smooth", "clean", "raw"}


def dotted(count: int, seed: int) -> Picture:
    """Return a scattered picture whose names lie in frames at random, in circles at times."""
    chance = random.Random(seed)
    frames = ["", "", "a.", "b.", "a.c.", "a.d."]
    names = [f"{chance.choice(frames)}n{number}" for number in range(count)] + ["a", "b", "a.c"]
    ways = [(names[chance.randrange(n)], names[n]) for n in range(1, len(names))]
    more = (sorted(chance.sample(range(len(names)), 2)) for _ in range(count // 2))
    return plain(names, list(dict.fromkeys([*ways, *((names[a], names[b]) for a, b in more)])))


@given(st.integers(1, 60), st.integers(0, 10**6))
def test_any_frames_are_drawn_so(count: int, seed: int) -> None:
    root = check(dotted(count, seed))
    boxes, frames = rectangles(root), rectangles(root, "data-frame")
    for frame, (left, top, right, bottom) in frames.items():
        for name, (a, b, c, d) in boxes.items():
            if name == frame or name.startswith(f"{frame}."):
                assert left < a < c < right
                assert top < b < d < bottom
            else:
                assert right < a or c < left or bottom < b or d < top


def test_a_frame_that_is_left_and_entered_again_is_not_drawn() -> None:
    names = ["a.one", "b", "a.two", "c.one", "c.two"]
    ways = [("a.one", "b"), ("b", "a.two"), ("a.two", "c.one"), ("c.one", "c.two")]
    root = check(plain(names, ways))
    assert set(rectangles(root, "data-frame")) == {"c"}
    texts = {element.text for element in root.iter(f"{SVG}text") if element.get("class") == "name"}
    assert texts == {"a.one", "b", "a.two", "one", "two"}


def test_a_program_without_the_style_sheet_finds_all_colours() -> None:
    root = ElementTree.fromstring(svg(fill()))
    (sheet,) = root.iter(f"{SVG}style")
    style, sheet.text = sheet.text or "", ""
    assert style.index("@supports") < style.index("{")
    assert "var(" not in ElementTree.tostring(root, encoding="unicode")
    for kind, needed in (
        ("rect", "fill"), ("path", "fill"), ("text", "font-size"),
    ):  # fmt: skip
        assert all(needed in element.attrib for element in root.iter(f"{SVG}{kind}")), kind


def test_arrows_say_what_they_are() -> None:
    drawn = {
        element.attrib["data-arrow"]: element
        for element in arrows_of(ElementTree.fromstring(svg(fill())))
    }
    assert drawn["gaps.truth error.truth"].attrib["class"] == "arrow truth"
    assert drawn["error.table table.tables"].attrib["class"] == "arrow gathers"
    assert drawn["gaps.gappy fill.recording"].attrib["class"] == "arrow"
    wide, plain_line = (
        float(next(drawn[name].iter(f"{SVG}path")).attrib["stroke-width"])
        for name in ("error.table table.tables", "gaps.gappy fill.recording")
    )
    assert wide > 1.7 * plain_line
    title = drawn["fill.recording faces.recordings"].findtext(f"{SVG}title")
    assert title == "fill.recording to faces.recordings (at trial=0, gathers)"


def test_the_title_and_the_combinations_stand_above_the_boxes() -> None:
    asked = "Which of three ways to fill the gaps of a face comes nearest to the truth?"
    counts = "8 actor \N{MULTIPLICATION SIGN} 3 fill"
    picture = replace(fill(), title=asked, combinations=counts)
    root = check(picture)
    above = [text for text in root.iter(f"{SVG}text") if float(text.attrib["y"]) < 0]
    assert " ".join(text.text or "" for text in above) == f"{asked} {counts}"
    heights = [float(text.attrib["y"]) for text in above]
    assert heights == sorted(heights)
    within = ElementTree.fromstring(svg(picture, heading=False))
    assert float(root.attrib["height"]) > float(within.attrib["height"])
    assert counts not in {text.text for text in within.iter(f"{SVG}text")}


def test_alternatives_axes_ports_and_fixed_labels_are_written() -> None:
    root = ElementTree.fromstring(svg(fill()))
    texts = [element.text for element in root.iter(f"{SVG}text")]
    for text in (
        "guenter",
        "lin",
        "neighbours: 8",
        "muscle",
        "length: 5, 15",
        "gaps.cut",
    ):
        assert text in texts
    (table,) = (
        group for group in root.iter(f"{SVG}g") if group.findtext(f"{SVG}title") == str(TRIAL)
    )
    cells = [(text.text, text.get("x"), text.get("y")) for text in table.iter(f"{SVG}text")]
    rows = [
        [text for text, _, y in cells if y == each] for each in dict.fromkeys(y for *_, y in cells)
    ]
    assert rows == [["trial", "seed", "sigma"], ["0", "7", "0.1"], ["first, last", "9", "0.2"]]
    assert len({x for _, x, _ in cells}) == 3
    hints = [element.findtext(f"{SVG}title") for element in root.iter(f"{SVG}text")]
    assert "hidden: Mask; to error" in hints
    assert texts.count("at trial=0") == 1  # both ports of `faces` have it
    assert root.findtext(f"{SVG}title") == "Three ways to fill"
    assert "gaps gaps.cut" in (root.findtext(f"{SVG}desc") or "")


def test_sockets_tell_types_by_shape_and_colour() -> None:
    root = ElementTree.fromstring(svg(fill(), sockets=True))
    marks = {
        (group.get("data-box"), side, each.get(f"data-{side}")): each
        for group in root.iter(f"{SVG}g")
        for each in group
        for side in ("input", "output")
        if each.get(f"data-{side}")
    }
    assert len(marks) == sum(len(box.inputs) + len(box.outputs) for box in fill().boxes)
    recording = marks["gaps", "input", "recording"]
    assert recording.attrib["class"] == "socket type-1"
    assert recording.get("fill") == marks["capture", "output", "recording"].get("fill")
    mask = marks["gaps", "output", "hidden"]
    assert (mask.get("fill"), mask.get("rx")) != (recording.get("fill"), recording.get("rx"))
    truth = marks["error", "input", "truth"]
    assert truth.attrib["class"] == "socket type-1 truth"
    assert (truth.get("fill"), truth.get("stroke")) == ("#ffffff", recording.get("fill"))
    texts = [element.text for element in root.iter(f"{SVG}text")]
    legend = ["Trajectories", "Mask", "hollow: the truth"]
    assert [text for text in texts if text in legend] == legend
    assert "data-input" not in svg(fill())
    kinds = tuple(Socket(f"p{number}", f"T{number}") for number in range(8))
    root = ElementTree.fromstring(svg(Picture("", (Box("a", (), kinds),)), sockets=True))
    drawn = [each for each in root.iter() if each.get("data-input")]
    looks = {str((each.tag, each.get("rx"), each.get("fill"))) for each in drawn}
    assert len(looks) == 7  # the last two share that of other types
    assert "other types" in [element.text for element in root.iter(f"{SVG}text")]


def test_sockets_stand_out_in_light_and_dark() -> None:
    style = ElementTree.fromstring(svg(fill())).findtext(f"{SVG}style") or ""
    colours = re.findall(r"(--face|--type): [^;]*?light-dark\((#\w{6}), (#\w{6})\)", style)
    faces, *types = [(light, dark) for _, light, dark in colours]
    assert len(types) == len({light for light, _ in types}) == len({dark for _, dark in types}) == 6
    for scheme in (0, 1):
        for each in types:
            assert contrast(each[scheme], faces[scheme]) > 4.5


def contrast(colour: str, other: str) -> float:
    """Return the contrast of two colours by WCAG 2."""

    def luminance(text: str) -> float:
        parts = (int(text[at : at + 2], 16) / 255 for at in (1, 3, 5))
        linear = [x / 12.92 if x <= 0.04045 else ((x + 0.055) / 1.055) ** 2.4 for x in parts]
        return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]

    low, high = sorted((luminance(colour), luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_names_stay_text() -> None:
    ports = (Socket(HOSTILE, HOSTILE),)
    alternatives = (Alternative(HOSTILE, HOSTILE),)
    axis = Axis(HOSTILE, HOSTILE, (HOSTILE,), ((HOSTILE, HOSTILE),))
    box = Box(HOSTILE, (HOSTILE,), ports, ports, alternatives, (axis,))
    last = Box("last", (), ports)
    arrow = Arrow(HOSTILE, HOSTILE, "last", HOSTILE, fixed=HOSTILE)
    drawn = svg(Picture(HOSTILE, (box, last), (arrow,)), sockets=True)
    tags = {element.tag.removeprefix(SVG) for element in ElementTree.fromstring(drawn).iter()}
    assert tags <= {"svg", "title", "desc", "style", "g", "rect", "path", "text"}
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


def test_a_cycle_is_named() -> None:
    port = (Socket("x"),)
    boxes = (Box("a", (), port, port), Box("b", (), port, port))
    picture = Picture("cycle", boxes, (Arrow("a", "x", "b", "x"), Arrow("b", "x", "a", "x")))
    with pytest.raises(ValueError, match="cycle: a -> b -> a"):
        svg(picture)
