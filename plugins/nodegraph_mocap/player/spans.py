"""Marks without the recording that they speak of: a row of spans per marker."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from html import escape

from nodegraph import Rendered
from nodegraph_mocap.marks import Mark, Marks
from nodegraph_mocap.player.page import script_or_style

MOST_SPANS = 5000
"""Of which a page shows the first."""


def render_spans(files: Mapping[str, Marks]) -> Rendered:
    """Return the spans of each file over its frames; their last is that of the last mark."""
    html = "".join(_figure(label, marks.marks) for label, marks in files.items())
    return Rendered(html, styles=(script_or_style("spans.css"),))


def _figure(label: str, marks: tuple[Mark, ...]) -> str:
    frames = max((mark.stop for mark in marks), default=1)
    rows: dict[str, list[Mark]] = defaultdict(list)
    for mark in marks[:MOST_SPANS]:
        rows[mark.marker].append(mark)
    left_out = len(marks) - MOST_SPANS
    more = f" {left_out:,} spans more are not drawn." if left_out > 0 else ""
    about = (
        f"{label}: what is marked, by frame, 0 to {frames - 1}. View it with its recording to see "
        f"the samples.{more}"
    )
    lines = "".join(
        f"<li><span>{escape(marker)}</span><span>"
        f"{''.join(_span(mark, frames) for mark in spans)}</span></li>"
        for marker, spans in rows.items()
    )
    return (
        f'<figure class="spans"><figcaption>{escape(about)}</figcaption><ul>{lines}</ul></figure>'
    )


def _span(mark: Mark, frames: int) -> str:
    words = f"{mark.marker}, frames {mark.start} to {mark.stop - 1}: {mark.kind} {mark.other}"
    left, width = 100 * mark.start / frames, 100 * mark.frames / frames
    return (
        f'<i class="{mark.kind}" style="left:{left:.3f}%;width:{width:.3f}%" '
        f'title="{escape(words.rstrip(), quote=True)}"></i>'
    )
