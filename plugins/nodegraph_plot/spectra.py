"""Power of the markers' movement at each frequency."""

from __future__ import annotations

import warnings
from typing import TYPE_CHECKING, Annotated

import numpy as np
from pydantic import Field

from nodegraph import Across, Truth, Unit, node
from nodegraph_mocap import Figure, Trajectories, figure_text
from nodegraph_mocap.frame_ranges import runs_of
from nodegraph_plot.recordings import check_all_markers, named, named_looks
from nodegraph_tables.axes import SMALL, name_lines, plain
from nodegraph_tables.style import BLACK, QUIET

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_tables.style import Look

    Line = tuple[NDArray[np.float64], NDArray[np.float64]]

_WIDE, _TALL = 6.4, 4.0
_LETTERS = 24
"""Letters in a name beside a line."""

_SEGMENT = 256
_SHORTEST = 8


@node("plot.spectra", cite="welch1967")
def spectra(
    recordings: Across[Trajectories],
    truth: Truth[Trajectories] | None = None,
    *,
    markers: tuple[str, ...] = (),
    segment: Annotated[int, Field(ge=_SHORTEST), Unit("frames")] | None = None,
) -> Figure:
    """Draw the power spectral density of the markers' positions, a line per recording.

    Welch's estimate [1]_: the mean over Hann-windowed, half-overlapping segments without a gap,
    each with its mean taken off; summed over the three coordinates, averaged over the markers.
    What a smoothing takes away, and the noise that is left, are where a line leaves the truth.

    Parameters
    ----------
    recordings
        Drawn in their order.
    truth
        Drawn as a thin black line.
    markers
        Names of markers that are averaged. Default: all that the recording has.
    segment
        Length of a segment. Default: 256, or the largest power of two for which half of the
        markers of every recording have a run without a gap. Markers without such a run are left
        out, and counted in a warning.

    Raises
    ------
    ValueError
        If a recording has no frames or no markers, lacks one that is asked for, or no marker of
        it has a run of that length without a gap.

    References
    ----------
    .. [1] P. D. Welch, The use of fast Fourier transform for the estimation of power spectra,
       IEEE Transactions on Audio and Electroacoustics 15(2), 1967, 70-73.
    """
    by_name = named(recordings)
    check_all_markers(by_name, markers)
    chosen = {
        name: recording.keep(markers) if markers else recording
        for name, recording in by_name.items()
    }
    frames = segment or _common_segment(chosen)
    lines = {name: _spectrum(name, recording, frames) for name, recording in chosen.items()}
    known = None if truth is None else _spectrum("the truth", truth, frames)
    return _draw(lines, known, named_looks(recordings))


def _common_segment(recordings: dict[str, Trajectories]) -> int:
    longest = {
        name: float(np.median(runs_of(recording.present).longest(len(recording.markers))))
        for name, recording in recordings.items()
    }
    name, shortest = min(longest.items(), key=lambda item: item[1])
    frames, called = recordings[name].frames, name or "the recording"
    if frames < _SHORTEST:
        raise ValueError(f"{called} is too short: {frames} of at least {_SHORTEST} frames")
    if shortest < _SHORTEST:
        raise ValueError(
            f"half of the markers of {called} have no {_SHORTEST} frames without a gap: "
            "fill it first"
        )
    return min(_SEGMENT, 1 << int(np.log2(shortest)))


def _spectrum(
    name: str, recording: Trajectories, segment: int
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return frequencies in Hz and the mean density in mm^2/Hz."""
    from scipy.signal import welch

    runs = runs_of(recording.present)
    long = runs.stop - runs.start >= segment
    power = np.zeros((len(recording.markers), segment // 2 + 1))
    count = np.zeros(len(recording.markers))
    for marker, start, stop in zip(*(ends[long] for ends in runs), strict=True):
        pieces = 1 + (stop - start - segment) // (segment - segment // 2)
        track = recording.positions[start:stop, marker]
        _, density = welch(track, fs=recording.rate, nperseg=segment, axis=0)
        power[marker] += pieces * density.sum(axis=1)
        count[marker] += pieces
    _warn(name, recording, count, segment)
    mean = power[count > 0] / count[count > 0, np.newaxis]
    frequency = np.asarray(np.fft.rfftfreq(segment, 1 / recording.rate), dtype=np.float64)
    return frequency, np.asarray(mean.mean(axis=0))


def _warn(name: str, recording: Trajectories, count: NDArray[np.float64], segment: int) -> None:
    lacking = [
        marker for marker, pieces in zip(recording.markers, count, strict=True) if not pieces
    ]
    if len(lacking) == len(recording.markers):
        raise ValueError(
            f"no marker{f' of {name}' if name else ''} has {segment} frames without a gap"
        )
    if lacking:
        warnings.warn(
            f"{name or 'recording'}: {len(lacking)} markers without {segment} frames in a row are "
            f"left out: {', '.join(lacking[:8])}",
            stacklevel=4,
        )


def _draw(lines: dict[str, Line], truth: Line | None, look: dict[str, Look]) -> Figure:
    """Return the figure: density by frequency, both without the mean, which was taken off."""
    from matplotlib.figure import Figure as Drawing

    figure = Drawing(figsize=(_WIDE, _TALL))
    axis = figure.add_axes((0.1, 0.12, 0.88, 0.86))
    for name, (frequency, density) in lines.items():
        style = look[name]
        axis.plot(
            frequency[1:],
            density[1:],
            style.line,
            color=style.colour,
            linewidth=1.2,
            label=figure_text(name, across=_LETTERS) or "recording",
        )
    if truth is not None:
        axis.plot(truth[0][1:], truth[1][1:], color=BLACK, linewidth=0.8, label="truth", zorder=5)
    axis.set(yscale="log")
    axis.set_xlabel("frequency (Hz)", fontsize=SMALL, color=QUIET)
    axis.set_ylabel("power (mm\N{SUPERSCRIPT TWO}/Hz)", fontsize=SMALL, color=QUIET)
    axis.margins(x=0.0)
    plain(axis)
    drawn = axis.get_lines()
    name_lines(
        axis,
        [str(line.get_label()) for line in drawn],
        [float(np.asarray(line.get_ydata())[-1]) for line in drawn],
        [str(line.get_color()) for line in drawn],
        _TALL * axis.get_position().height,
    )
    return figure
