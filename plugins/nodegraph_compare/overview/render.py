"""An overview in a report and in a notebook: its lead, and the section with its charts."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from markupsafe import escape

from nodegraph import Rendered, json_script
from nodegraph_compare.described import is_described
from nodegraph_compare.overview.cards import answer_html
from nodegraph_compare.overview.cost import typical_seconds
from nodegraph_compare.overview.details import details_of
from nodegraph_compare.overview.pack import excerpt_of, packed
from nodegraph_compare.words import varying, with_units
from nodegraph_tables.authors_answer import in_authors_words
from nodegraph_tables.lead import lead_style
from nodegraph_tables.text import listing, plain

if TYPE_CHECKING:
    from collections.abc import Iterator

    from nodegraph import Provenance
    from nodegraph_compare.overview.value import Overview
    from nodegraph_compare.verdict import Verdicts


def render_overview(overview: Overview, title: str) -> Rendered:
    """Return the verdicts alone, as a notebook shows them."""
    lead = answer_html(overview.answer, with_units(overview.verdicts), {})
    return Rendered(lead, styles=(lead_style(),), answer=overview.answer.lines)


def render_overview_in_run(overview: Overview, title: str, origin: Provenance) -> Rendered:
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
    verdicts = overview.verdicts
    # of a metric without a better end, the table's own lead says more
    is_lead = not is_described(verdicts)
    named = with_units(verdicts)
    told = in_authors_words(overview.answer, origin.answer)
    summaries = origin.summaries(verdicts.compare)
    lead = answer_html(told, named, summaries, origin.caption) if is_lead else ""
    answer = told.lines if is_lead else ()
    styles = (lead_style(), *_web(".css"))
    if not verdicts.groups:
        return Rendered("", "there are no blocks", lead=lead, styles=styles, answer=answer)
    excerpt = excerpt_of(overview)
    details = details_of(overview, excerpt, origin)
    seconds = typical_seconds(origin.seconds(verdicts.compare))
    data = {
        **packed(overview, with_units(verdicts, times=False), excerpt, origin.node, seconds),
        **details.data,
    }
    layout = data["layout"]
    charts = {"controls": ""}
    if any(group.best for group in verdicts.groups) and len(verdicts.methods) > 1:
        charts["ranking"] = _ranking_heading(named)
        if seconds:
            charts["cost"] = "What does accuracy cost?"
    if layout is not None:
        charts["layout"] = f"Where {layout['title']} is it hard?"
    charts["blocks"] = f"Is it a few {verdicts.blocks}, or all of them?"
    html = "".join(_chart(*chart) for chart in charts.items())
    return Rendered(
        f'<div class="overview" data-overview="{escape(name)}">{html}</div>'
        f"{json_script(data, name)}{details.html}",
        answer=answer,
        lead=lead,
        replaces=("figure",),
        scripts=(*_web(".js"), *details.scripts),
        styles=(*styles, *details.styles),
    )


def _ranking_heading(verdicts: Verdicts) -> str:
    names = [verdicts.within[axis] for axis in varying(verdicts)]
    if verdicts.is_sequence:
        return f"What does each {verdicts.compare} do?"
    if len(verdicts.groups) < 2:
        return "How far are they apart?"
    return f"How does the ranking change with {plain(listing(names))}?"


def _chart(name: str, heading: str) -> str:
    """Return the place of a chart; its script draws it, and says what it shows."""
    head = f"<h3>{escape(heading)}</h3>" if heading else ""
    return f'{head}<div data-chart="{name}"></div>'


def _web(suffix: str) -> Iterator[str]:
    folder = files("nodegraph_compare.overview").joinpath("web")
    names = sorted(item.name for item in folder.iterdir()) if folder.is_dir() else []
    return (_text(f"web/{name}") for name in names if name.endswith(suffix))


@cache
def _text(path: str) -> str:
    return files("nodegraph_compare.overview").joinpath(path).read_text(encoding="utf-8")
