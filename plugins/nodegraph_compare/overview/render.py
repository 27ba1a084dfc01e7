"""An overview in a report and in a notebook: its lead, and the section with its charts."""

from __future__ import annotations

import re
from functools import cache
from html import escape, unescape
from importlib.resources import files
from typing import TYPE_CHECKING

from nodegraph import Rendered, json_script
from nodegraph_compare.left_out import start_text
from nodegraph_compare.overview.cards import scope_line, verdicts
from nodegraph_compare.overview.details import details_of
from nodegraph_compare.overview.findings import (
    block_finding,
    cost_finding,
    place_finding,
    ranking_finding,
)
from nodegraph_compare.overview.pack import excerpt_of, packed
from nodegraph_compare.overview.sentence import sentences
from nodegraph_compare.overview.words import varying
from nodegraph_tables.lead import MOST_CARDS

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nodegraph import Origin
    from nodegraph_compare.overview.value import Overview


def render_overview(overview: Overview, title: str) -> Rendered:
    """Return the verdicts alone, as a notebook shows them."""
    answer = _answer(overview)
    return Rendered(lead_of(overview, title), styles=(_text("cards.css"),), answer=answer)


def render_overview_in_run(overview: Overview, title: str, origin: Origin) -> Rendered:
    """Return the verdicts as the lead of a report, and the charts as its section.

    Parameters
    ----------
    overview
        The comparison.
    title
        Of the section.
    origin
        Of the run, which knows the times of methods and the inputs of scores.
    """
    name = f"overview-{origin.node}"
    # of a metric without a better end, the table's own lead says more
    described = overview.metric.better == "none" and len(overview.groups) == 1
    lead = "" if described and 1 < len(overview.methods) <= MOST_CARDS else lead_of(overview, name)
    styles = (_text("cards.css"), *_web(".css"))
    answer = _answer(overview) if lead else ()
    if not overview.groups:
        return Rendered("", "there are no blocks", lead=lead, styles=styles, answer=answer)
    excerpt = excerpt_of(overview)
    details = details_of(overview, excerpt, origin)
    data = {**packed(overview, excerpt, title, origin), **details.data}
    seconds = origin.seconds(overview.compare)
    layout = data["layout"]
    charts = [("controls", "", "")]
    if any(group.best for group in overview.groups) and len(overview.methods) > 1:
        charts += [
            ("ranking", _ranking_heading(overview), ranking_finding(overview)),
        ]
        if len(seconds) > 1:
            charts.append(("cost", "What does accuracy cost?", cost_finding(overview, seconds)))
    if layout is not None:
        heading = f"Where {layout['title']} is it hard?"
        charts.append(("layout", heading, place_finding(overview, layout["column"])))
    charts.append(
        ("blocks", f"Is it a few {overview.blocks}, or all of them?", block_finding(overview))
    )
    html = "".join(_chart(*chart) for chart in charts)
    return Rendered(
        f'<div class="overview" data-overview="{escape(name)}">{html}</div>'
        f"{json_script(data, name)}{details.html}",
        answer=answer,
        lead=lead,
        replaces=("figure",),
        scripts=(*_web(".js"), *details.scripts),
        styles=(*styles, *details.styles),
    )


def lead_of(overview: Overview, name: str) -> str:
    """Return the answer at a glance: its sentences, the verdicts of the groups, the scope."""
    return f'<div class="overview-lead">{verdicts(overview, name)}{scope_line(overview)}</div>'


def _answer(overview: Overview) -> tuple[str, ...]:
    """Return the sentences as text, as a terminal shows them."""
    return tuple(
        f"{start_text(label)}{unescape(re.sub(r'<[^>]*>', '', html))}"
        for label, html in sentences(overview).items()
    )


def _ranking_heading(overview: Overview) -> str:
    names = [overview.within[axis] for axis in varying(overview)]
    if len(overview.groups) < 2:
        return "How far are they apart?"
    return f"How does the ranking change with {' and '.join(names)}?"


def _chart(name: str, heading: str, finding: str) -> str:
    """Return the place of a chart, with what can be said without it."""
    head = f"<h3>{escape(heading)}</h3>" if heading else ""
    text = f'<p class="finding">{finding[:1].upper()}{finding[1:]}</p>' if finding else ""
    return f'{head}{text}<div data-chart="{name}"></div>'


def _web(suffix: str) -> Iterator[str]:
    folder = files("nodegraph_compare.overview").joinpath("web")
    names = sorted(item.name for item in folder.iterdir()) if folder.is_dir() else []
    return (_text(f"web/{name}") for name in names if name.endswith(suffix))


@cache
def _text(path: str) -> str:
    return files("nodegraph_compare.overview").joinpath(path).read_text(encoding="utf-8")
