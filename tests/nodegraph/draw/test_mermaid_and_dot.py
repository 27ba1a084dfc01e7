"""Mermaid and DOT say what a picture shows, and the libraries of both draw it.

Set ``NODEGRAPH_MERMAID`` and ``NODEGRAPH_VIZ`` to the folders of the packages ``mermaid`` and
``@viz-js/viz``, as ``npm pack`` gives them.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Page

import nodegraph as ng
from nodegraph.draw import Alternative, Arrow, Axis, Box, Picture, Socket, dot, mermaid
from nodegraph.draw.boxes import clean
from nodegraph.draw.from_graph import picture_of
from tests.browser import load
from tests.studies import ROOT

HOSTILE = 'x"]\n click "javascript:alert(1)" <b>&#34; `a` \\" \\N --> y;'
PORT = (Socket("out", "Table"),)
RIVALS = (Alternative("lin"), Alternative("muscle", "order: 2"))


def two(**how: object) -> Picture:
    boxes = (
        Box("a", ("read.x",), outputs=PORT, kind="input"),
        Box("b", (), PORT, alternatives=RIVALS, axes=(Axis("k", "1, 2"),), kind="report"),
    )
    return Picture("Two", boxes, (Arrow("a", "out", "b", "out", **how),))  # type: ignore[arg-type]


def hostile() -> Picture:
    ports = (Socket(HOSTILE, HOSTILE),)
    boxes = (
        Box(HOSTILE, (HOSTILE,), ports, ports, (Alternative(HOSTILE, HOSTILE),), (Axis(HOSTILE),)),
        Box("b", (), ports),
    )
    return Picture(HOSTILE, boxes, (Arrow(HOSTILE, HOSTILE, "b", HOSTILE, fixed=HOSTILE),))


def test_mermaid() -> None:
    assert mermaid(two()).splitlines() == [
        "---",
        'title: "Two"',
        "---",
        "flowchart LR",
        '  n0(["a<br/>read.x"])',
        '  n1[["b<br/>lin #124; muscle order: 2<br/>k: 1, 2"]]',
        '  n0 -->|"out"| n1',
    ]


def test_mermaid_lines() -> None:
    assert 'n0 -.->|"out"| n1' in mermaid(two(truth=True))
    assert 'n0 ==>|"out"| n1' in mermaid(two(gathers=True))
    assert 'n0 ==>|"out<br/>truth"| n1' in mermaid(two(gathers=True, truth=True))
    assert 'n0 -->|"out<br/>at k=3"| n1' in mermaid(two(fixed="k=3"))


def test_no_name_ends_a_mermaid_label() -> None:
    drawn = mermaid(hostile()).splitlines()
    assert drawn[1].startswith("title: ")
    assert json.loads(drawn[1].removeprefix("title: ")) == (
        clean(HOSTILE).replace("<", "&lt;").replace(">", "&gt;")
    )
    assert len(drawn) == 7
    for line in drawn[4:]:
        inside = line.split('"')
        assert len(inside) == 3
        text = inside[1].replace("<br/>", "")
        assert re.fullmatch(r"(?:[\w .,:=-]|#\d+;)*", text)


def test_dot() -> None:
    drawn = dot(two(truth=True, gathers=True, fixed="k=3"))
    assert drawn.startswith("digraph {\n")
    assert 'graph [label="Two"' in drawn
    assert '<TD PORT="o0" COLSPAN="1">out: Table</TD>' in drawn
    assert 'n0:o0:s -> n1:i0:n [style=dashed, penwidth=3, label="at k=3"];' in drawn
    assert "n0:o0:s -> n1:i0:n;" in dot(two())


def test_no_name_ends_a_dot_label() -> None:
    drawn = dot(hostile())
    quoted = re.findall(r"label=(\"(?:[^\"\\]|\\.)*\")", drawn)
    assert len(quoted) == 2
    shown = [re.sub(r"\\(.)", r"\1", text[1:-1]).replace("&amp;", "&") for text in quoted]
    assert shown == [clean(HOSTILE), f"at {clean(HOSTILE)}"]
    markup = "".join(re.findall(r"label=<(<TABLE.*</TABLE>)>\];", drawn))
    assert "\\\\N" in markup
    assert not re.search(r"(?<!\\)(?:\\\\)*\\(?!\\)", markup), "each backslash is doubled"
    tags = set(re.findall(r"</?(\w+)", markup))
    assert tags == {"TABLE", "TR", "TD", "B"}


def nested() -> Picture:
    names = ("a", "clean.one", "b", "clean.fine.two", "clean.fine", "clean")
    return Picture("Nested", tuple(Box(name) for name in names))


def test_names_with_dots_stand_in_mermaid_subgraphs() -> None:
    assert mermaid(nested()).splitlines()[4:] == [
        '  n0["a"]',
        '  subgraph frame0["clean"]',
        '    n1["one"]',
        '    subgraph frame1["fine"]',
        '      n3["two"]',
        '      n4["fine"]',
        "    end",
        '    n5["clean"]',
        "  end",
        '  n2["b"]',
    ]


def test_names_with_dots_stand_in_dot_clusters() -> None:
    lines = [line.strip().partition(" [")[0] for line in dot(nested()).splitlines()[4:-1]]
    assert lines == [
        "n0",
        "subgraph cluster_0 {",
        "graph",
        "n1",
        "subgraph cluster_1 {",
        "graph",
        "n3",
        "n4",
        "}",
        "n5",
        "}",
        "n2",
    ]
    assert 'graph [label="fine", labelloc=t, labeljust=l' in dot(nested())


# what of a library is loaded, and what draws a text with it, without a complaint
MERMAID = (
    "dist/mermaid.min.js",
    """async (text) => { document.body.innerHTML = (await mermaid.render("drawn", text)).svg; }""",
)
VIZ = (
    "dist/viz-global.js",
    """async (text) => {
      document.body.innerHTML = (await Viz.instance()).renderString(text, { format: "svg" });
    }""",
)
TEXTS = """[...document.querySelectorAll("svg text, svg foreignObject p")]
  .map((text) => text.textContent).join(" ").replace(/\\s+/g, " ")"""


def pictures() -> list[Picture]:
    shipped = picture_of(ng.load(ROOT / "graphs" / "fill.yaml"))
    return [two(gathers=True, fixed="k=3"), hostile(), nested(), shipped]


@pytest.mark.parametrize(
    ("write", "variable", "library"),
    [(mermaid, "NODEGRAPH_MERMAID", MERMAID), (dot, "NODEGRAPH_VIZ", VIZ)],
    ids=["mermaid", "dot"],
)
def test_every_name_is_seen_where_a_picture_is_rendered(
    tab: Page,
    tmp_path: Path,
    write: Callable[[Picture], str],
    variable: str,
    library: tuple[str, str],
) -> None:
    folder = os.environ.get(variable, "")
    if not folder:
        pytest.skip(f"{variable} names no folder of the npm package")
    script, draw = library
    page = tmp_path / "page.html"
    source = Path(folder, script).as_uri()
    page.write_text(f'<!DOCTYPE html><meta charset="utf-8"><body><script src="{source}"></script>')
    load(tab, page)
    for picture in pictures():
        tab.evaluate(draw, write(picture))
        shown = tab.evaluate(TEXTS)
        for box in picture.boxes:
            name = box.name if box.name == HOSTILE else box.name.rpartition(".")[2]
            assert " ".join(clean(name).split()) in shown, picture.title
        assert tab.locator("svg :is(a, b, script, image)").count() == 0


def test_no_frame_ends_its_label() -> None:
    name = 'x"] y.z'
    assert '  subgraph frame0["x#34;#93; y"]' in mermaid(Picture("", (Box(name),)))
    assert 'label="x\\"] y"' in dot(Picture("", (Box(name),)))
