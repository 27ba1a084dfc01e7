"""One name per marker, from the labels that a file gives."""

from __future__ import annotations

import warnings
from collections import Counter
from collections.abc import Sequence

from nodegraph import listed, quoted

_MOST_NAMES = 10


def unique_names(labels: Sequence[str], count: int) -> tuple[str, ...]:
    """Return one name per marker: one without a label, or with another's, gets its own.

    A subject's prefix (``subject:marker``) that all labels share is taken off. Warnings name the
    labels that were left out or changed.

    Parameters
    ----------
    labels
        As the file gives them; there may be fewer than markers, or more.
    count
        Number of markers.
    """
    spare = [label for label in labels[count:] if label]
    if spare:
        _warn(f"{len(spare)} labels beyond the {count} markers were left out", spare)
    wanted = _without_subject([*labels[:count], *[""] * (count - len(labels))])
    taken = set(wanted)
    names: dict[str, None] = {}
    renamed = []
    for place, label in enumerate(wanted, start=1):
        name = label if label and label not in names else _free(label, place, taken)
        if name != label:
            renamed.append(f"{quoted(label)} is now {quoted(name)}")
        names[name] = None
        taken.add(name)
    if renamed:
        _warn(f"{len(renamed)} markers had no label, or another's", renamed)
    return tuple(names)


def _free(label: str, place: int, taken: set[str]) -> str:
    name = f"{label or 'unnamed'}_{place}"
    while name in taken:
        name += "_"
    return name


def _without_subject(labels: list[str]) -> list[str]:
    parts = [label.partition(":") for label in labels]
    subjects = Counter(subject for subject, _, marker in parts if marker)
    shared = len(subjects) == 1 and subjects.total() == len([label for label in labels if label])
    return [marker for _, _, marker in parts] if shared else labels


def _warn(what: str, which: Sequence[str]) -> None:
    warnings.warn(f"{what}: {listed(which, _MOST_NAMES)}", stacklevel=4)
