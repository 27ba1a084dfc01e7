"""Contracts of nodes that add noise or impulses, third-party ones included."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING

import numpy as np

from nodegraph import Contract, Tried
from nodegraph_mocap import Mask, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

_PORTS: Mapping[str, Mapping[str, type]] = {
    "noisy": {"noisy": Trajectories, "truth": Trajectories},
    "spiky": {"spiky": Trajectories, "truth": Trajectories, "impulses": Mask},
}


def gives_noisy_and_truth(tried: Tried) -> Iterator[str]:
    """Take `recording`, and give `noisy` first, then `truth`."""
    yield from _wrong_ports(tried, "noisy")


def gives_spiky_truth_and_impulses(tried: Tried) -> Iterator[str]:
    """Take `recording`, and give `spiky` first, then `truth` and `impulses`."""
    yield from _wrong_ports(tried, "spiky")


def truth_is_the_recording(tried: Tried) -> Iterator[str]:
    """Return as the truth the value of port `truth`, or else the recording itself."""
    source = "truth" if isinstance(tried.inputs.get("truth"), Trajectories) else "recording"
    expected, truth = tried.inputs.get(source), tried.outputs.get("truth")
    if not isinstance(expected, Trajectories) or not isinstance(truth, Trajectories):
        return
    if not _kept(expected, truth) or _changed(expected, truth).any():
        yield f"the truth differs from the input {source!r}: return it as it came"


def keeps_what_is_missing(tried: Tried) -> Iterator[str]:
    """Leave missing samples missing, present ones present, and every sample's origin."""
    recording, output = tried.inputs.get("recording"), next(iter(tried.outputs.values()))
    if not isinstance(recording, Trajectories) or not isinstance(output, Trajectories):
        return
    if not _kept(recording, output):
        yield "markers, rate, frames or origins differ from the recording's"


def hits_what_it_says(tried: Tried) -> Iterator[str]:
    """Move the samples that `impulses` names, and no other."""
    if any(_wrong_ports(tried, "spiky")) or any(keeps_what_is_missing(tried)):
        return
    moved = _changed(tried.inputs["recording"], tried.outputs["spiky"])
    hit = tried.outputs["impulses"].hidden
    if np.any(moved & ~hit):
        yield f"{np.count_nonzero(moved & ~hit)} samples differ that are not among the impulses"
    if np.any(hit & ~moved):
        yield f"{np.count_nonzero(hit & ~moved)} impulses are where nothing differs"


CONTRACTS: Mapping[str, tuple[Contract, ...]] = {
    "noise": (gives_noisy_and_truth, truth_is_the_recording, keeps_what_is_missing),
    "impulses": (
        gives_spiky_truth_and_impulses,
        truth_is_the_recording,
        keeps_what_is_missing,
        hits_what_it_says,
    ),
}


def _wrong_ports(tried: Tried, first: str) -> Iterator[str]:
    ports: dict[str, object] = {**tried.inputs, **tried.outputs}
    for name, kind in {"recording": Trajectories, **_PORTS[first]}.items():
        if not isinstance(ports.get(name), kind):
            yield f"{name!r} is not a {kind.__name__}; its ports are {', '.join(ports)}"
    if next(iter(tried.outputs)) != first:
        yield f"the first output is {next(iter(tried.outputs))!r}, not {first!r}"


def _kept(first: Trajectories, second: Trajectories) -> bool:
    return (first.markers, first.rate) == (second.markers, second.rate) and np.array_equal(
        first.origin, second.origin
    )


def _changed(first: Trajectories, second: Trajectories) -> NDArray[np.bool_]:
    same = (first.positions == second.positions) | ~first.present[..., None]
    return np.asarray(~same.all(axis=2))
