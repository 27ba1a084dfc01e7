"""Contracts of every despiker, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Origin, contracts


def missing_stays_missing(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing and present ones present: nothing is filled, nothing cut."""
    for before, after in contracts.before_and_after(tried):
        for what, where in (
            ("filled", ~before.present & after.present),
            ("removed", before.present & ~after.present),
        ):
            if where.any():
                yield f"{contracts.places(before, where)} {what}"


def repaired_samples_are_marked(tried: Tried) -> Iterator[str]:
    """Mark each sample that is changed as repaired, and leave the others as they are."""
    for before, after in contracts.before_and_after(tried):
        both = before.present & after.present
        changed = both & np.any(before.positions != after.positions, axis=2)
        unmarked = changed & (after.origin != Origin.REPAIRED)
        if unmarked.any():
            yield f"{contracts.places(before, unmarked)} changed but not marked: {_HOW_TO_MARK}"
        renamed = both & ~changed & (after.origin != before.origin)
        if renamed.any():
            samples = contracts.places(before, renamed)
            yield f"{samples} not changed but newly marked: {_HOW_TO_MARK}"


def sigma_belongs_to_its_sample(tried: Tried) -> Iterator[str]:
    """Keep the sigma of samples that stay, and not that of samples that are changed."""
    for before, after in contracts.before_and_after(tried):
        if before.sigma is None:
            continue
        if after.sigma is None:
            yield "sigma is gone; keep it where samples stay"
            continue
        changed = np.any(before.positions != after.positions, axis=2) & before.present
        other = (before.sigma != after.sigma) & ~(np.isnan(before.sigma) & np.isnan(after.sigma))
        lost = before.present & ~changed & other
        if lost.any():
            yield f"{contracts.places(before, lost)} not changed but with another sigma"
        kept = changed & ~other & ~np.isnan(before.sigma)
        if kept.any():
            samples = contracts.places(before, kept)
            yield f"{samples} changed but with the sigma of what it was: make it NaN"


CONTRACTS = (
    contracts.takes_and_gives_a_recording,
    missing_stays_missing,
    repaired_samples_are_marked,
    sigma_belongs_to_its_sample,
    contracts.gives_millimetres,
    contracts.looks_ahead_as_declared,
    contracts.moves_with_the_face,
    contracts.turns_with_the_face,
    contracts.scales_with_the_face,
    contracts.runs_with_the_clock,
    contracts.does_not_depend_on_the_order_of_markers,
)

_HOW_TO_MARK = "return recording.with_samples(positions, changed=bad, origin=Origin.REPAIRED)"
