"""The answer of an alignment's score at a glance: a card per recording with its components."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from nodegraph_score.alignment_text import named
from nodegraph_tables.lead import Card, Lead, svg

if TYPE_CHECKING:
    from nodegraph_mocap import Table

_MOST_BARS = 8
_TALL = 60.0


def lead_of(parts: Sequence[Table], axes: tuple[str, ...]) -> Lead:
    """Return the lead: how much of the variance head motion makes, in each recording.

    Parameters
    ----------
    parts
        The rows of each recording.
    axes
        Their columns with labels.
    """
    scope = (
        "Scope: these recordings. Large: the share of head motion in the first principal "
        "component; the rest is the face's. Bars: the share of all variance that each component "
        "has; filled, what head motion makes of it."
    )
    return Lead(_sentence(parts, axes), tuple(_card(part, axes) for part in parts), scope)


def _sentence(parts: Sequence[Table], axes: tuple[str, ...]) -> tuple[str, ...]:
    most = max(parts, key=_in_first)
    rest = [part for part in parts if part is not most]
    sentence = (
        "The first principal component is ", f"{_percent(_in_first(most))} head motion",
        f"{f' in {named(most, axes)}' if rest else ''}, as is ",
        f"{_percent(_in_all(most))} of all variance",
    )  # fmt: skip
    if not rest:
        return (*sentence, ".")
    others = "the other" if len(rest) == 1 else f"the {len(rest)} others"
    first, every = (_percent(max(map(share, rest))) for share in (_in_first, _in_all))
    return (*sentence, f"; in {others} at most {first}, and {every}.")


def _card(part: Table, axes: tuple[str, ...]) -> Card:
    return Card(
        title=named(part, axes) or "recording",
        headline=_percent(_in_first(part)),
        aside=f"head motion; {_percent(_in_all(part))} of all variance",
        picture=_picture(part),
    )


def _picture(part: Table) -> str:
    rows = part.head(_MOST_BARS)
    wide = 240.0 / max(len(rows), 4)
    bars = []
    largest = float(rows["share"].max())
    for place, (share, head) in enumerate(zip(rows["share"], rows["head motion"], strict=True)):
        x = place * wide
        for kind, size in (("", share), ("part", share * min(max(head, 0.0), 1.0))):
            tall = _TALL * size / largest
            bars.append(
                f'<rect class="{kind}" x="{x:g}" y="{_TALL - tall:.1f}" width="{wide - 6:g}" '
                f'height="{tall:.1f}"/>'
            )
        bars.append(
            f'<text class="middle" x="{x + wide / 2 - 3:g}" y="{_TALL + 14:g}">{share:.0%}</text>'
        )
    return svg("shares of the variance of the principal components", _TALL + 18.0, bars)


def _in_first(part: Table) -> float:
    return float(part["head motion"].iloc[0])


def _in_all(part: Table) -> float:
    return float(part["in all"].iloc[0])


def _percent(share: float) -> str:
    """Return a share; where head and face work against each other, it may be below 0."""
    return f"{round(100 * share) + 0} %"
