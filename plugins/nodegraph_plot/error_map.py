"""The error of a method at each place of the face."""

from __future__ import annotations

import warnings
from collections import defaultdict
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from nodegraph import Across, Truth, node
from nodegraph_mocap import Figure, Trajectories
from nodegraph_plot.recordings import (
    agreeing,
    check_something,
    check_truth,
    estimated,
    true_positions,
)

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nodegraph import Label
    from nodegraph_plot.error_map_figure import MarkerErrors

Samples = Literal["made", "all"]


@node("plot.error_map")
def error_map(
    recordings: Across[Trajectories],
    truth: Truth[Across[Trajectories]],
    *,
    samples: Samples = "made",
    view: Annotated[str, Field(pattern=r"^(auto|[+-][xyz][+-][xyz])$")] = "auto",
) -> Figure:
    """Draw the error of every marker as a disc on the face, a picture per method, in one scale.

    Recordings whose labels differ only along axes of the truth (recordings, trials, lengths of
    gaps) are in one picture: the same method, applied to several takes. The error of a marker in a
    take is the root mean square of its distance to the truth over its samples; what is drawn is
    the mean over the takes in which it has any. Area and colour of a disc say the same, on a
    logarithmic scale from the least to the largest error of all pictures; above a picture stands
    the median of its markers. A marker stands at its mean position in the truths, seen from the
    front of each. The last picture has, at each marker, how many samples are behind its error: the
    least number of all pictures. A marker without one is a hollow circle.

    Parameters
    ----------
    recordings
        Drawn in their order.
    truth
        The truth of each recording, that of its labels. Markers are matched by name.
    samples
        ``made``: those that were filled or repaired. ``all``: every present one.
    view
        As for ``plot.faces``.

    Raises
    ------
    ValueError
        If a recording has no frames or no markers, has no truth or several, the truth has another
        number of frames, `view` is not of that form, or no recording has a sample whose truth is
        known.
    """
    from nodegraph_plot.error_map_figure import draw

    pairs = _pairs(recordings, truth)
    pictures = {name: _errors(takes, samples) for name, takes in pairs.items()}
    if not any(np.isfinite(list(each.errors.values())).any() for each in pictures.values()):
        raise ValueError(f"no recording has a sample ({samples}) whose truth is known")
    _warn(pictures, samples)
    return draw(pictures, truth.values(), view)


def _pairs(
    recordings: Across[Trajectories], truth: Across[Trajectories]
) -> dict[str, list[tuple[Trajectories, Trajectories]]]:
    """Return each recording with its truth, by the labels that the truth does not have."""
    if not len(recordings):
        raise ValueError("there is no recording to draw")
    pairs: dict[str, list[tuple[Trajectories, Trajectories]]] = defaultdict(list)
    for name, (labels, recording) in zip(recordings.names(), recordings, strict=True):
        check_something(name, recording)
        true = _truth_of(name, labels, truth)
        check_truth({name: recording}, true)
        own = {axis: label for axis, label in labels.items() if axis not in truth.axes}
        pairs[Across(tuple(own), ((own, recording),)).names()[0]].append((recording, true))
    return dict(pairs)


def _truth_of(name: str, labels: Mapping[str, Label], truth: Across[Trajectories]) -> Trajectories:
    alike = agreeing(truth, labels)
    if len(alike) == 1:
        return alike[0]
    of = f" of {name}" if name else ""
    if not alike:
        raise ValueError(f"there is no truth{of}")
    free = [axis for axis in truth.axes if axis not in labels]
    raise ValueError(f"there are {len(alike)} truths{of}: fix {', '.join(free)} with `at`")


def _errors(takes: list[tuple[Trajectories, Trajectories]], samples: Samples) -> MarkerErrors:
    """Return the mean over takes of the root mean square distances."""
    from nodegraph_plot.error_map_figure import MarkerErrors

    errors: dict[str, list[float]] = defaultdict(list)
    counts: dict[str, int] = defaultdict(int)
    for recording, truth in takes:
        squared = ((recording.positions - true_positions(truth, recording)) ** 2).sum(axis=2)
        chosen = estimated(recording) if samples == "made" else recording.present
        chosen = chosen & np.isfinite(squared)
        count = chosen.sum(axis=0)
        total = np.where(chosen, squared, 0.0).sum(axis=0)
        for marker, number, each in zip(recording.markers, count, total, strict=True):
            counts[marker] += int(number)
            errors[marker] += [float(np.sqrt(each / number))] if number else []
    means = {marker: float(np.mean(each)) if each else np.nan for marker, each in errors.items()}
    return MarkerErrors(means, dict(counts), len(takes))


def _warn(pictures: Mapping[str, MarkerErrors], samples: Samples) -> None:
    without = {
        name: sum(number == 0 for number in picture.samples.values())
        for name, picture in pictures.items()
    }
    counts = [f"{name or 'recording'} {count}" for name, count in without.items() if count]
    if counts:
        warnings.warn(
            f"markers without a sample ({samples}) of known truth, drawn hollow: "
            f"{', '.join(counts)}",
            stacklevel=3,
        )
