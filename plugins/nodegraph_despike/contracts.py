"""What every despiker promises, whoever wrote it."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Origin, promises


def missing_stays_missing(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing and present ones present: nothing is filled, nothing cut."""
    for given, made in promises.before_and_after(tried):
        for what, where in (
            ("filled", ~given.present & made.present),
            ("removed", given.present & ~made.present),
        ):
            if where.any():
                yield f"{promises.spots(given, where)} {what}"


def repaired_samples_are_marked(tried: Tried) -> Iterator[str]:
    """Mark each sample that is changed as repaired, and leave the others as they are."""
    for given, made in promises.before_and_after(tried):
        both = given.present & made.present
        changed = both & np.any(given.positions != made.positions, axis=2)
        unmarked = changed & (made.origin != Origin.REPAIRED)
        if unmarked.any():
            yield f"{promises.spots(given, unmarked)} changed but not marked: {_HOW_TO_MARK}"
        renamed = both & ~changed & (made.origin != given.origin)
        if renamed.any():
            yield f"{promises.spots(given, renamed)} not changed but marked anew: {_HOW_TO_MARK}"


def sigma_belongs_to_its_sample(tried: Tried) -> Iterator[str]:
    """Keep the sigma of samples that stay, and not that of samples that are changed."""
    for given, made in promises.before_and_after(tried):
        if given.sigma is None:
            continue
        if made.sigma is None:
            yield "sigma is gone; keep it where samples stay"
            continue
        changed = np.any(given.positions != made.positions, axis=2) & given.present
        other = (given.sigma != made.sigma) & ~(np.isnan(given.sigma) & np.isnan(made.sigma))
        lost = given.present & ~changed & other
        if lost.any():
            yield f"{promises.spots(given, lost)} not changed but with another sigma"
        kept = changed & ~other & ~np.isnan(given.sigma)
        if kept.any():
            spots = promises.spots(given, kept)
            yield f"{spots} changed but with the sigma of what it was: make it NaN"


CONTRACTS = (
    promises.takes_and_gives_a_recording,
    missing_stays_missing,
    repaired_samples_are_marked,
    sigma_belongs_to_its_sample,
    promises.gives_millimetres,
    promises.moves_with_the_face,
    promises.turns_with_the_face,
    promises.scales_with_the_face,
    promises.runs_with_the_clock,
    promises.does_not_depend_on_the_order_of_markers,
)

_HOW_TO_MARK = "return recording.with_samples(positions, changed=bad, origin=Origin.REPAIRED)"
