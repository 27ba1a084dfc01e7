"""Words for what a result holds for: over several actors, or for further gaps of one recording."""

from __future__ import annotations

from typing import TYPE_CHECKING

from nodegraph_compare.inference import FEWEST_JUDGED, FEWEST_SETTLED

if TYPE_CHECKING:
    from nodegraph_compare.question import Question
    from nodegraph_compare.units import Units

_FEW_BLOCKS = 10


def scope(units: Units, question: Question, blocks: str) -> str:
    """Return what a result holds for: ``over 8 actors``, ``for further gaps in this recording``.

    Parameters
    ----------
    units, question
        Of the comparison.
    blocks
        What several blocks are called.
    """
    if units.kind == "clusters":
        return f"over {units.clusters} {cluster_text(question)}"
    if question.clusters and set(question.blocks) <= set(question.clusters):
        return f"for further {cluster_text(question)}"
    where = "this recording" if units.clusters == 1 else f"these {units.clusters} recordings"
    if units.kind == "draws":
        blocks = f"{question.drawn[0]}s" if len(question.drawn) == 1 else "repetitions"
    return f"for further {blocks} in {where}"


def cluster_text(question: Question) -> str:
    """Return what several clusters are called: ``actors``."""
    names = question.clusters
    return f"{names[0]}s" if len(names) == 1 else f"combinations of {' and '.join(names)}"


def unit_text(units: Units, question: Question) -> str:
    """Return the number of units with their name: ``8 actors``, ``10 segments``."""
    if units.kind == "clusters":
        return f"{units.clusters} {cluster_text(question)}"
    named = {
        "segments": "segments of the recording",
        "runs": "runs of blocks in their order",
        "draws": "repetitions",
    }
    return f"{len(units.means)} {named.get(units.kind, 'recordings')}"


def caution(units: Units, question: Question) -> str:
    """Return what too few units leave open; empty for eight or more."""
    if units.speech == "nothing":
        return ""
    if units.speech == "described":
        return f"{unit_text(units, question)} describe the methods and decide nothing"
    if units.speech == "provisional":
        return f"provisional, as of {unit_text(units, question)}"
    return ""


def rules(question: Question) -> str:
    """Return the scope of a result, given its numbers of units."""
    of = cluster_text(question) if question.clusters else "units"
    few = (
        f"Fewer than {FEWEST_JUDGED} {of} are described, without p; fewer than {FEWEST_SETTLED} "
        "are provisional."
    )
    if question.clusters:
        return f"The independent units are {of}, which weigh equally. {few}"
    return (
        "All blocks are of one recording, and results hold for further ones of it: the units are "
        "equal segments of it, long against the time over which errors are correlated; where "
        "blocks have no place in time, its repetitions, or equal runs of blocks in their order. "
        f"{few}"
    )


def few_blocks(units: Units, question: Question) -> str:
    """Return a remark on units of so few blocks that the means of skewed errors are biased."""
    if units.kind != "clusters" or not 1 < units.fewest < _FEW_BLOCKS:
        return ""
    return (
        f"fewer than {_FEW_BLOCKS} blocks in some of the {cluster_text(question)} "
        f"(at least {units.fewest}): means of skewed errors are biased"
    )
