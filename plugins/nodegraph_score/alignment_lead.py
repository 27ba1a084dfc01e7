"""The answer of an alignment's score at a glance: a card per recording with its components."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from nodegraph import listed
from nodegraph_score.alignment_text import FACE, HEAD, named
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
        "Scope: these recordings. Large: what the first principal component is. Bars: the share of "
        "all variance that each component has; "
        "filled, what head motion makes of it."
    )
    return Lead(_sentence(parts, axes), tuple(_card(part, axes) for part in parts), scope)


def _sentence(parts: Sequence[Table], axes: tuple[str, ...]) -> tuple[str, ...]:
    sentence = ["PCA finds "]
    for finds, what in ((HEAD, HEAD), (FACE, "the face")):
        names = [named(part, axes) for part in parts if _finds(part) == finds]
        where = listed(names) if len(names) < len(parts) else f"all {len(names)} recordings"
        if names:
            joint = ", " if len(sentence) > 1 else ""
            sentence[-1] += joint
            sentence += [what, f" first in {where}" if len(parts) > 1 else " first"]
    most = max(parts, key=_in_all)
    rest = [_in_all(part) for part in parts if part is not most]
    sentence[-1] += "; head motion makes "
    sentence.append(f"{_percent(_in_all(most))} of all variance")
    if not rest:
        return (*sentence, ".")
    others = "the other" if len(rest) == 1 else f"the {len(rest)} others"
    return (*sentence, f" in {named(most, axes)}, and at most {_percent(max(rest))} in {others}.")


def _card(part: Table, axes: tuple[str, ...]) -> Card:
    return Card(
        title=named(part, axes) or "recording",
        headline=_finds(part),
        value=_percent(_in_all(part)),
        aside="of all variance is head motion",
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


def _finds(part: Table) -> str:
    return str(part["finds"].iloc[0])


def _in_all(part: Table) -> float:
    return float(part["in all"].iloc[0])


def _percent(share: float) -> str:
    """Return a share; where head and face work against each other, it may be below 0."""
    return f"{round(100 * share) + 0} %"
