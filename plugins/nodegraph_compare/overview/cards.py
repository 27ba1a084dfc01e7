"""The answer of a comparison on a page: its sentence over cards in panels, or a grid of winners."""

from __future__ import annotations

import re
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from markupsafe import Markup, escape

from nodegraph_compare.cards import line_of
from nodegraph_compare.words import (
    best_words,
    group_title,
    has_panels,
    method_words,
    over_all_text,
    varying,
)
from nodegraph_tables.answer import (
    HERE,
    MOST_CARDS,
    Word,
    cards_html,
    few,
    html_of,
    joined,
    lead_of_parts,
    listing,
    say,
)
from nodegraph_tables.numbers import number_text, span_text

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from nodegraph import Label
    from nodegraph_compare.verdict import Verdict, Verdicts
    from nodegraph_tables.answer import Answer

_MOST_COLUMNS = 6
_MOST_NAMES = 3
_MOST_ROWS = 60
_SOURCE = re.compile(r" \([^()]*\)\.$")


def answer_html(
    answer: Answer,
    verdicts: Verdicts,
    name: str,
    meanings: Mapping[str, str],
    summaries: Mapping[Label, str],
) -> Markup:
    """Return the answer, and the verdicts of all groups.

    Up to eight groups have a card each, of which a reader sees those of one label of the first
    axis where there are more than four; more groups stand in a grid.

    Parameters
    ----------
    answer
    verdicts
        Of the comparison, with labels as a reader sees them.
    name
        Distinguishes its parts from those of another on one page.
    meanings
        What the labels of an axis are.
    summaries
        What methods do, by their labels, in a sentence.
    """
    if line_of(verdicts) is None:
        inside = ""
    elif len(verdicts.groups) > MOST_CARDS:
        inside = _grid(verdicts)
    elif has_panels(verdicts):
        inside = _tabs(answer, verdicts, name, meanings)
    else:
        inside = cards_html(answer.cards)
    return lead_of_parts(answer, _described(answer, summaries) + inside, legend(verdicts))


def _described(answer: Answer, summaries: Mapping[Label, str]) -> str:
    """Return what each method does that stands out in the sentence; its source is left out."""
    named = [word for word in answer.sentence if isinstance(word, Word) and word.kind == "strong"]
    texts = [
        say(f"{HERE}: {_SOURCE.sub('.', summaries[label])}", Word(label, "method"))
        for label in dict.fromkeys(word.method for word in named)
        if summaries.get(label)
    ]
    inside = html_of(joined(" ", texts))
    return f'<p class="lead-methods">{inside}</p>' if texts else ""


def _tabs(answer: Answer, verdicts: Verdicts, name: str, meanings: Mapping[str, str]) -> str:
    """Return cards behind a radio button per label, which needs no script."""
    axis, *rest = varying(verdicts)
    labels = list(dict.fromkeys(group.labels[axis] for group in verdicts.groups))
    axis_name = escape(verdicts.within[axis])
    buttons, panels = [], []
    for at, label in enumerate(labels):
        tab = f"{escape(name)}-{axis_name}-{at}"
        checked = " checked" * (at == 0)
        text = escape(str(label))
        buttons.append(
            f'<input type="radio" name="{escape(name)}-{axis_name}" id="{tab}"{checked}>'
            f'<label for="{tab}">{text}</label>'
        )
        inside = cards_html(
            [
                replace(card, title=group_title(verdicts, group, rest))
                for card, group in zip(answer.cards, verdicts.groups, strict=True)
                if group.labels[axis] == label
            ]
        )
        panels.append(
            f'<div class="lead-panel"><p class="lead-label">{axis_name} {text}</p>{inside}</div>'
        )
    meaning = meanings.get(verdicts.within[axis], "")
    title = f' title="{escape(meaning)}"' if meaning else ""
    return (
        f'<div class="lead-tabs" role="group" aria-label="{axis_name}">'
        f'<span class="lead-axis"{title}>{axis_name}</span>'
        f"{''.join(buttons)}{''.join(panels)}</div>"
    )


def _grid(verdicts: Verdicts) -> str:
    """Return the best of every group in rows and columns, where there are many groups."""
    axes = varying(verdicts)
    last = axes[-1]
    tops = list(dict.fromkeys(group.labels[last] for group in verdicts.groups))
    if len(axes) < 2 or len(tops) > _MOST_COLUMNS:
        return _list(verdicts)
    cells = {
        (tuple(group.labels[axis] for axis in axes[:-1]), group.labels[last]): group
        for group in verdicts.groups
    }
    sides = list(dict.fromkeys(side for side, _ in cells))
    names = [verdicts.within[axis] for axis in axes[:-1]]
    titles = {top: escape(f"{verdicts.within[last]} {top}") for top in tops}
    heads = "".join(
        f'<th scope="col">{text}</th>' for text in (*map(escape, names), *titles.values())
    )
    # on a phone each cell says itself what it is about
    rows = [
        "".join(
            f'<th scope="row" data-head="{escape(name)}">{escape(str(label))}</th>'
            for name, label in zip(names, side, strict=True)
        )
        + "".join(
            f'<td data-head="{title}"{_mark(verdicts, cells.get((side, top)))}>'
            f"{_cell(verdicts, cells.get((side, top)))}</td>"
            for top, title in titles.items()
        )
        for side in sides
    ]
    if verdicts.overall is not None:
        rows.append(
            f'<th scope="row" data-head="all" colspan="{len(names)}">'
            f"{len(verdicts.groups)} groups together</th>"
            f'<td data-head="best" colspan="{len(titles)}"{_mark(verdicts, verdicts.overall)}>'
            f"{_cell(verdicts, verdicts.overall)}</td>"
        )
    return _table(heads, rows)


def _list(verdicts: Verdicts) -> str:
    names = (
        ", ".join(verdicts.within[axis] for axis in varying(verdicts)),
        "best",
        "not certain",
    )
    heads = "".join(f'<th scope="col">{escape(name)}</th>' for name in names)
    rows = [
        f'<th scope="row">{escape(group_title(verdicts, group))}</th>'
        f"<td{_mark(verdicts, group)}>{_cell(verdicts, group)}</td>"
        f"<td>{_not_certain(verdicts, group)}</td>"
        for group in verdicts.groups
    ]
    return _table(heads, rows)


def _not_certain(verdicts: Verdicts, group: Verdict) -> str:
    tied = group.tied if group.told else []
    return html_of(few(method_words(verdicts, tied), _MOST_NAMES))


def _mark(verdicts: Verdicts, group: Verdict | None) -> str:
    """Return the class of a cell whose best method is the one to take for all groups."""
    best = () if group is None or not group.told else group.best
    return ' class="for-all"' if verdicts.for_all in best else ""


def _cell(verdicts: Verdicts, group: Verdict | None) -> str:
    if group is None or not group.known:
        return "\N{EN DASH}"
    unit = verdicts.metric.unit
    if not group.best:
        return escape(span_text([np.nanmin(group.mean), np.nanmax(group.mean)], unit))
    mean = span_text([group.mean[group.best[0]]], unit)
    over_all = html_of(over_all_text(verdicts, group))
    more = f"<div><small>{over_all}</small></div>" if over_all else ""
    if not group.told:
        why = "none clearly best" if group.stands else "no verdict"
        first = html_of(listing(method_words(verdicts, group.best)))
        return f"<small>{why}; first: {first} {escape(mean)}</small>{more}"
    others = f", {len(group.tied)} not certain" if group.tied else ""
    names = html_of(listing(best_words(verdicts, group.best)))
    return f"{names} <small>{escape(mean)}{others}</small>{more}"


def _table(heads: str, rows: Sequence[str]) -> str:
    body = "".join(f"<tr>{row}</tr>" for row in rows[:_MOST_ROWS])
    more = len(rows) - _MOST_ROWS
    rest = f'<p class="lead-scope">{more} more rows are in the table.</p>' if more > 0 else ""
    return (
        f'<figure class="table lead-grid"><table><thead><tr>{heads}</tr></thead>'
        f"<tbody>{body}</tbody></table></figure>{rest}"
    )


def legend(verdicts: Verdicts) -> str:
    """Return what the dots of the cards are, when none is clearly best, and what is suspect."""
    groups = [group for group in verdicts.groups if group.stands and not verdicts.is_sequence]
    unclear = any(not group.told for group in groups)
    texts = ["None clearly best: no other is clearly worse than the first." * unclear]
    if len(verdicts.groups) > MOST_CARDS:
        several = any(group.told and group.tied for group in groups)
        texts.append("Not certain: how many others are not certain to be worse." * several)
        texts.append(f"Tinted: {_tinted(verdicts)}." * (verdicts.for_all is not None))
    else:
        suspect = any(group.suspects_matter for group in verdicts.groups)
        doubt = f"\N{WHITE DIAMOND}: {verdicts.blocks} whose truth may be damaged." * suspect
        texts += [_dots(verdicts), doubt]
    return " ".join(filter(None, texts))


def _tinted(verdicts: Verdicts) -> str:
    return "the best over all" if verdicts.best_over_all is not None else "clearly behind nowhere"


def _dots(verdicts: Verdicts) -> str:
    told = [group for group in verdicts.groups if group.told]
    line = line_of(verdicts)
    if verdicts.is_sequence and any(group.stands for group in verdicts.groups):
        return (
            f"Percentages: to the {verdicts.compare} before; dots: hollow where it begins, "
            "blue clearly better than before, orange clearly worse, grey not clearly changed."
        )
    if not told or len(verdicts.methods) < 2:
        return ""
    others = "; ringed: not certain to be worse" * any(group.tied for group in told)
    behind = "; grey: clearly behind" if any(group.behind for group in told) else ""
    baseline = "" if verdicts.baseline is None else f"; hollow: {verdicts.baseline}"
    tinted = f"; tinted: {_tinted(verdicts)}" * (verdicts.for_all is not None)
    scale = ", on a logarithmic scale" if line is not None and line.log else ""
    scale += f" above {number_text(line.least)}" if line is not None and line.least else ""
    return (
        f"Dots: a method each with its 95 % interval{scale}; "
        f"filled: the best{others}{behind}{baseline}{tinted}."
    )
