"""The text of the score of steps: a sentence per step, warnings, and what does not count."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph import listed

if TYPE_CHECKING:
    from nodegraph import Across
    from nodegraph_mocap import Trajectories

BETTER, WORSE = "better", "worse"


def sentence(row: Mapping[str, Any]) -> str:
    """Return what a step did."""
    step, verdict = row["step"], row["verdict"]
    if verdict == "begins" and not row["added"]:
        return f"{step} has no sample, and lacks {row['missing']}"
    if verdict == "begins":
        return (
            f"{step} has {row['added']} samples with an error of {row['rmse']:.3g} mm (root mean "
            f"square), {row['misplaced']} of them nearer to another marker's place, and lacks "
            f"{row['missing']}"
        )
    changes = {
        BETTER: f"makes it better: {_moved(row)}",
        WORSE: f"makes it WORSE: {_moved(row)}",
        "same": f"changes {row['changed']} samples and the error of none",
        "nothing": "does nothing",
    }
    parts = [changes[verdict]] if verdict in changes else []
    if row["added"]:
        parts.append(f"adds {row['added']} samples with an error of {row['added rmse']:.3g} mm")
    if row["removed"]:
        parts.append(f"removes {row['removed']} samples")
    whole = "nothing" if np.isnan(row["rmse"]) else f"{row['rmse']:.3g} mm over all that"
    return f"{step} {', '.join(parts)}; {whole} is there, {row['missing']} missing"


def worse(rows: Iterable[Mapping[str, Any]]) -> Iterator[str]:
    """Yield a warning for each step that makes it worse."""
    for row in rows:
        if row["verdict"] == WORSE:
            yield f"{row['step']} makes it worse: {_moved(row)}"


def left_out(stages: Across[Trajectories], truth: Trajectories) -> Iterator[str]:
    """Yield which stages are absent, and which markers and samples do not count."""
    if stages.absent:
        yield f"stages are passed over{absences(stages)}"
    known = set(truth.markers)
    extra: dict[tuple[str, ...], list[str]] = {}
    for name, stage in zip(stages.names(), stages.values(), strict=True):
        beyond = tuple(marker for marker in stage.markers if marker not in known)
        extra.setdefault(beyond, []).append(name)
    for markers, names in extra.items():
        if markers:
            yield (
                f"{len(markers)} markers of {', '.join(names)} are not in the truth and do not "
                f"count: {listed(markers)}"
            )
    unknown = np.count_nonzero(~truth.present)
    if unknown:
        yield f"{unknown} of {truth.origin.size} samples lack a truth and do not count"


def absences(stages: Across[Trajectories]) -> str:
    """Return which stages are absent, and why."""
    reasons = [
        f"{', '.join(map(str, absence.labels.values()))} was {absence.kind} ({absence.reason})"
        for absence in stages.absent
    ]
    return f"; {'; '.join(reasons)}" if reasons else ""


def _moved(row: Mapping[str, Any]) -> str:
    return (
        f"{row['before']:.3g} mm before and {row['after']:.3g} mm after, over the "
        f"{row['changed']} samples that it changed"
    )
