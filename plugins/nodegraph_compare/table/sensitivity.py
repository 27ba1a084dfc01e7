"""Whether a verdict stands under other rules: for missing blocks, and without suspect ones."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING, Final

import numpy as np

from nodegraph import listed
from nodegraph_compare.table.summary import Variant

if TYPE_CHECKING:
    from collections.abc import Callable

    from numpy.typing import NDArray

    from nodegraph import Label
    from nodegraph_compare.blocks import Group
    from nodegraph_compare.suspects import Suspects
    from nodegraph_compare.table.summary import Summary

COMMON: Final = "common blocks"
WORST: Final = "worst of block"
PLAIN: Final = "without suspects"


def summary_of(
    group: Group,
    plain: Group | None,
    suspects: Suspects,
    fallback: Label | None,
    summarise: Callable[[Group], Summary],
) -> Summary:
    """Return the summary of a group, with those under other rules beside it.

    Parameters
    ----------
    group
        As it is.
    plain
        Without its suspect blocks; None where there are none.
    suspects
        Those blocks.
    fallback
        The method whose value stands where another has none; then the blocks that all methods
        have, and the worst value of the block in its place, are the other rules.
    summarise
        Returns the summary of a group.
    """
    filled = group if fallback is None else group.filled(fallback)
    summary = summarise(filled)
    variants = []
    if fallback in group.methods:
        worst = group.with_worst(summary.end)
        variants += [Variant(COMMON, summarise(group)), Variant(WORST, summarise(worst))]
    if plain is not None:
        plain = plain if fallback is None else plain.filled(fallback)
        variants.append(Variant(PLAIN, summarise(plain)))
    return replace(summary, variants=tuple(variants), suspects=suspects.names)


def objections(summary: Summary, blocks: str) -> str:
    """Return what is the best by other rules for missing blocks; empty if the same is.

    Parameters
    ----------
    summary
        With its variants.
    blocks
        What several blocks are called.
    """
    return " and ".join(
        f"{rule_text(rule, blocks)} {text}"
        for rule, other in _by_other_rules(summary).items()
        if (text := other_best(summary, other))
    )


def rule_text(rule: str, blocks: str) -> str:
    """Return a rule for missing blocks as a sentence has it: ``over common gaps``."""
    if rule == COMMON:
        return f"over common {blocks}"
    return f"with the worst error of {blocks} instead"


def stands(summary: Summary) -> bool:
    """Whether there is a verdict: units enough, a better end, and one best by every rule."""
    return summary.judged and summary.best is not None and not objections(summary, "")


def behind_by_all_rules(summary: Summary) -> NDArray[np.bool_]:
    """Return (K,), the methods clearly behind by every rule for missing blocks."""
    if not stands(summary):
        return np.zeros(summary.level.shape, dtype=bool)
    rules = [other.behind for other in _by_other_rules(summary).values()]
    return np.asarray(np.logical_and.reduce([summary.behind, *rules]))


def equal_by_all_rules(summary: Summary) -> NDArray[np.bool_]:
    """Return (K,), the methods shown to be equal to the reference by every rule."""
    rules = [other.equal for other in _by_other_rules(summary).values()]
    return np.asarray(np.logical_and.reduce([summary.equal, *rules]))


def apart_by_all_rules(summary: Summary) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    """Return two (K,), the methods that are lower and those higher than the reference by p.

    By every rule for missing blocks.
    """
    sides = [_sides(each) for each in (summary, *_by_other_rules(summary).values())]
    lower, higher = (np.logical_and.reduce(side) for side in zip(*sides, strict=True))
    return lower, higher


def _sides(summary: Summary) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
    paired = summary.paired
    if paired is None:
        none = np.zeros(summary.level.shape, dtype=bool)
        return none, none
    middle = 1.0 if summary.ratio else 0.0
    return paired.apart & (paired.value < middle), paired.apart & (paired.value > middle)


def tied_with_best(summary: Summary) -> NDArray[np.bool_]:
    """Return (K,), the methods that a verdict does not tell from the best."""
    if not stands(summary):
        return np.zeros(summary.level.shape, dtype=bool)
    return (summary.blocks > 0) & ~summary.bests & ~behind_by_all_rules(summary)


def without_suspects(summary: Summary) -> Summary | None:
    """Return the summary without suspect blocks; None where there are none."""
    return _variants(summary).get(PLAIN)


def _variants(summary: Summary) -> dict[str, Summary]:
    return {variant.rule: variant.summary for variant in summary.variants}


def _by_other_rules(summary: Summary) -> dict[str, Summary]:
    """Return the summaries by the other rules for missing blocks."""
    variants = _variants(summary)
    return {rule: variants[rule] for rule in (COMMON, WORST) if rule in variants}


def change_to(summary: Summary, other: Summary) -> str:
    """Return what another rule says in place of the verdict; empty where it says the same."""
    if best := other_best(summary, other):
        return best
    behind, still = _names(summary, summary.behind), _names(other, other.behind)
    gone = [name for name in behind if name not in still]
    new = [name for name in still if name not in behind]
    return " and ".join(
        f"{listed(names)} {'are' if len(names) > 1 else 'is'} {how} clearly behind"
        for names, how in ((gone, "no longer"), (new, "also"))
        if names
    )


def other_best(summary: Summary, other: Summary) -> str:
    """Return what has the best mean by another rule; empty where the same has."""
    bests, others = _names(summary, summary.bests), _names(other, other.bests)
    if bests == others:
        return ""
    verb = "share" if len(others) > 1 else "has"
    return f"{listed(others)} {verb} the best mean" if others else "nothing can be said"


def _names(summary: Summary, where: NDArray[np.bool_]) -> list[str]:
    return [str(summary.group.methods[place]) for place in np.flatnonzero(where).tolist()]
