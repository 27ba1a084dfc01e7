"""Where on the face a method errs."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Annotated, Literal

import numpy as np
from pydantic import Field

from nodegraph import Across, Truth, node
from nodegraph_mocap import Figure, Trajectories
from nodegraph_plot.recordings import check_truth, estimated, named, true_positions

if TYPE_CHECKING:
    from numpy.typing import NDArray


@node("plot.error_map")
def error_map(
    recordings: Across[Trajectories],
    truth: Truth[Trajectories],
    *,
    samples: Literal["made", "all"] = "made",
    view: Annotated[str, Field(pattern=r"^(auto|[+-][xyz][+-][xyz])$")] = "auto",
) -> Figure:
    """Draw the error of every marker on the face, a picture per recording, in one colour scale.

    The error of a marker is the root mean square of its distance to the truth over its samples,
    and is drawn where the truth has the marker on average. Triangles between markers have the
    mean colour of their corners. A marker without such a sample is a hollow circle. The scale
    ends at the largest error of all pictures.

    Parameters
    ----------
    recordings
        Drawn in their order.
    truth
        Its markers are matched by name.
    samples
        ``made``: those that were filled or repaired. ``all``: every present one.
    view
        As for ``plot.faces``.

    Returns
    -------
    Figure

    Raises
    ------
    ValueError
        If a recording has no frames or no markers, the truth has another number of frames than a
        recording, `view` is not of that form, or no recording has a sample whose truth is known.
    """
    from nodegraph_plot.error_map_figure import draw

    by_name = named(recordings)
    check_truth(by_name, truth)
    errors = {name: _errors(values, truth, samples) for name, values in by_name.items()}
    if not any(np.isfinite(values).any() for values in errors.values()):
        raise ValueError(f"no recording has a sample ({samples}) whose truth is known")
    _warn(errors, samples)
    return draw(by_name, errors, truth, view)


def _errors(
    recording: Trajectories, truth: Trajectories, samples: Literal["made", "all"]
) -> NDArray[np.float64]:
    """Return the (M,) root mean square distances, NaN where there is no sample."""
    squared = ((recording.positions - true_positions(truth, recording)) ** 2).sum(axis=2)
    chosen = estimated(recording) if samples == "made" else recording.present
    chosen = chosen & np.isfinite(squared)
    count = chosen.sum(axis=0)
    total = np.where(chosen, squared, 0.0).sum(axis=0)
    return np.sqrt(np.where(count > 0, total / np.maximum(count, 1), np.nan))


def _warn(errors: dict[str, NDArray[np.float64]], samples: str) -> None:
    without = {name: int(np.isnan(values).sum()) for name, values in errors.items()}
    counts = [f"{name or 'recording'} {count}" for name, count in without.items() if count]
    if counts:
        warnings.warn(
            f"markers without a sample ({samples}) of known truth, drawn hollow: "
            f"{', '.join(counts)}",
            stacklevel=3,
        )
