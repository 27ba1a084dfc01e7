"""Contracts of every node that makes gaps, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from nodegraph import Tried
from nodegraph_mocap import Mask, Trajectories

_PORTS = {"recording": Trajectories, "gappy": Trajectories, "truth": Trajectories, "hidden": Mask}


def has_the_ports_of_a_cut(tried: Tried) -> Iterator[str]:
    """Take `recording`, and give `gappy` first, then `truth` and `hidden`."""
    ports: dict[str, object] = {**tried.inputs, **tried.outputs}
    for name, kind in _PORTS.items():
        if not isinstance(ports.get(name), kind):
            yield f"{name!r} is not a {kind.__name__}; its ports are {', '.join(ports)}"
    if next(iter(tried.outputs)) != "gappy":
        yield f"the first output is {next(iter(tried.outputs))!r}, not 'gappy'"


def truth_is_the_recording(tried: Tried) -> Iterator[str]:
    """Give as the truth what port `truth` has, or else the recording itself."""
    if any(has_the_ports_of_a_cut(tried)):
        return
    source = "truth" if isinstance(tried.inputs.get("truth"), Trajectories) else "recording"
    expected, truth = tried.inputs[source], tried.outputs["truth"]
    if not _alike(expected, truth) or np.any(expected.origin != truth.origin):
        yield f"the truth differs from the input {source!r}: return it as it came"


def hides_what_it_says(tried: Tried) -> Iterator[str]:
    """Hide the samples that `hidden` names, all of them present before, and change no other."""
    if any(has_the_ports_of_a_cut(tried)):
        return
    recording, gappy = tried.inputs["recording"], tried.outputs["gappy"]
    hidden = tried.outputs["hidden"].hidden
    if not _alike(recording, gappy, but=hidden):
        yield "samples that are not hidden differ from the recording's"
    if np.any(hidden & ~recording.present):
        yield f"{np.count_nonzero(hidden & ~recording.present)} hidden samples were missing before"
    if np.any(hidden & gappy.present):
        yield f"{np.count_nonzero(hidden & gappy.present)} hidden samples are still there"


CONTRACTS = (has_the_ports_of_a_cut, truth_is_the_recording, hides_what_it_says)


def _alike(recording: Trajectories, other: Trajectories, *, but: object = False) -> bool:
    same = (recording.positions == other.positions) | (
        np.isnan(recording.positions) & np.isnan(other.positions)
    )
    return recording.markers == other.markers and bool(np.all(same.all(axis=2) | but))
