"""A drawing as PDF: one page, the same bytes every time, whatever names are."""

from __future__ import annotations

import re

from nodegraph.draw import Alternative, Arrow, Axis, Box, Picture, Socket, pdf

HOSTILE = "\"><script>&amp;\x00'\ud800]]> $x_1$ \\frac"


def test_a_picture_is_one_page_and_the_same_every_time() -> None:
    ports = (Socket(HOSTILE, HOSTILE),)
    axis = Axis(HOSTILE, HOSTILE, (HOSTILE,), ((HOSTILE, HOSTILE),))
    alternatives = (Alternative(HOSTILE, HOSTILE),)
    boxes = (
        Box(HOSTILE, (HOSTILE,), ports, ports, alternatives, (axis,)),
        Box("b.c", (), ports),
    )
    arrow = Arrow(HOSTILE, HOSTILE, "b.c", HOSTILE, truth=True, gathers=True, fixed=HOSTILE)
    picture = Picture(HOSTILE, boxes, (arrow,))
    drawn = pdf(picture)
    assert drawn.startswith(b"%PDF")
    assert re.search(rb"/Type /Pages.*?/Count 1\b", drawn, re.S)
    assert drawn == pdf(picture)
    assert pdf(Picture("", ())).startswith(b"%PDF")
