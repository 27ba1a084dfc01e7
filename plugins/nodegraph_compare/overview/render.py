"""An overview in a report and in a notebook: its lead, and the section with its charts."""

from __future__ import annotations

from functools import cache
from importlib.resources import files
from typing import TYPE_CHECKING

from markupsafe import Markup, escape

from nodegraph import Rendered, json_script
from nodegraph_compare.left_out import start_text
from nodegraph_compare.overview.cards import answer_html, scope_line
from nodegraph_compare.overview.cost import typical_seconds
from nodegraph_compare.overview.details import details_of
from nodegraph_compare.overview.pack import excerpt_of, packed
from nodegraph_compare.table.lead import is_described
from nodegraph_compare.words import scope_sentences, sentences, varying, with_units
from nodegraph_tables.lead import lead_of_parts, lead_style

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from nodegraph import Origin
    from nodegraph_compare.overview.value import Overview
    from nodegraph_compare.verdict import Verdicts


def render_overview(overview: Overview, title: str) -> Rendered:
    """Return the verdicts alone, as a notebook shows them."""
    lead = _lead(overview.verdicts, title, {})
    return Rendered(lead, styles=(lead_style(),), answer=_answer(overview.verdicts))


def render_overview_in_run(overview: Overview, title: str, origin: Origin) -> Rendered:
    """Return the verdicts as the lead of a report, and the charts as its section.

    Parameters
    ----------
    overview
        The comparison.
    title
        Of the section.
    origin
        Of the run, which knows the times of methods, the inputs of scores and what axes are.
    """
    name = f"overview-{origin.node}"
    verdicts = overview.verdicts
    named = with_units(verdicts, origin)
    # of a metric without a better end, the table's own lead says more
    is_lead = not is_described(verdicts)
    meanings = {axis: origin.meaning(axis) for axis in verdicts.within}
    lead = _lead(named, name, meanings) if is_lead else ""
    answer = _answer(named) if is_lead else ()
    styles = (lead_style(), *_web(".css"))
    if not verdicts.groups:
        return Rendered("", "there are no blocks", lead=lead, styles=styles, answer=answer)
    excerpt = excerpt_of(overview)
    details = details_of(overview, excerpt, origin)
    seconds = typical_seconds(origin.seconds(verdicts.compare))
    data = {**packed(overview, named, excerpt, origin.node, seconds), **details.data}
    layout = data["layout"]
    charts = {"controls": ""}
    if any(group.best for group in verdicts.groups) and len(verdicts.methods) > 1:
        charts["ranking"] = _ranking_heading(verdicts)
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


def _lead(verdicts: Verdicts, name: str, meanings: Mapping[str, str]) -> str:
    """Return the answer at a glance: its sentences, the verdicts of the groups, the scope."""
    return lead_of_parts(answer_html(verdicts, name, meanings), scope=scope_line(verdicts))


def _answer(verdicts: Verdicts) -> tuple[str, ...]:
    """Return the sentences as text, as a terminal shows them."""
    verdict = (
        f"{start_text(label)}{Markup(html).striptags()}"
        for label, html in sentences(verdicts).items()
    )
    return (*verdict, scope_sentences(verdicts).striptags())


def _ranking_heading(verdicts: Verdicts) -> str:
    names = [verdicts.within[axis] for axis in varying(verdicts)]
    if verdicts.is_sequence:
        return f"What does each {verdicts.compare} do?"
    if len(verdicts.groups) < 2:
        return "How far are they apart?"
    return f"How does the ranking change with {' and '.join(names)}?"


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
