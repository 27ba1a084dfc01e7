"""What the step-wise neighbour fills share: passes over the take, and how a gap is closed.

A missing sample is the marker's last position plus a displacement made from its neighbours':
``P'[t, m] = P[t-1, m] + sum(w_i (P[t, i] - P[t-1, i]))``. Each method's file says the weights.

The neighbours are the nearest to ``P[t-1, m]`` among the markers that are usable at both t-1
and t, equally near ones in marker order. Measured (and repaired) samples are usable; with
`use_filled` so are samples filled earlier, by this fill or before it, but they come after all
measured ones. The pass runs forward over the whole take, so that a gap of many frames goes on
from its own fills. Where there is no usable neighbour, or the last position is missing, the
sample stays missing, and so does the rest of the gap. Gaps at the start of the take are then
filled by the same rule backward in time, from the marker's first sample.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from nodegraph_fill.gaps import LONG, NEVER, Gaps, to_gap_end, to_limit, warn_left
from nodegraph_fill.meet_ends import Ends, are_met, check_ends, meet_ends
from nodegraph_mocap import Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

CloseGap = Literal["none", "ramp", "blend"]
"""How a fill meets the sample that ends the gap.

``none``: it does not, and a jump stays. ``ramp``: the sample that ends the gap is predicted too;
its mismatch e is spread, ``e j / (L + 1)`` at the j-th of L frames, where both ends and that
prediction are there. ``blend``: a forward and a backward pass, each by itself, cross-faded
linearly; where one is missing, the other.
"""


def lookahead(settings: Mapping[str, Any]) -> int | None:
    """Return the look-ahead of a step-wise fill."""
    return to_gap_end(settings) if meets_ends(settings) else to_limit(settings)


def meets_ends(settings: Mapping[str, Any]) -> bool:
    """Return whether a step-wise fill meets both ends of a gap."""
    return settings["close_gap"] != "none" or are_met(settings)


@dataclass(frozen=True, kw_only=True)
class Rule:
    """How one method predicts a sample.

    Attributes
    ----------
    weights : str
        One of the kernel's `WEIGHTS`.
    neighbours : int
        How many neighbours at most.
    use_filled : bool
        Whether filled samples serve as neighbours.
    ring : int
        0 to fill a frame's markers in their order, else the size of the ring of the greedy order.
    full_radius, falloff_radius : float
        Millimetres, for Waters' rule.
    allowed : (M, M) array of bool, or None
        Which marker may be a neighbour of which; None: any of any other.

    Raises
    ------
    ValueError
        If there is to be no neighbour.
    """

    weights: str
    neighbours: int
    use_filled: bool
    ring: int = 0
    full_radius: float = 0.0
    falloff_radius: float = 0.0
    allowed: NDArray[np.bool_] | None = None

    def __post_init__(self) -> None:
        if self.neighbours < 1:
            raise ValueError(f"neighbours must be at least 1, got {self.neighbours}")

    def arguments(self, markers: int) -> tuple[Any, ...]:
        """Return what the kernel's functions take, from the kind of weights on."""
        from nodegraph_fill import stepwise_kernel

        others = ~np.eye(markers, dtype=np.bool_)
        return (
            stepwise_kernel.WEIGHTS[self.weights],
            min(self.neighbours, max(markers, 1)),
            float(self.full_radius),
            float(self.falloff_radius),
            others if self.allowed is None else self.allowed & others,
            self.use_filled,
        )


@dataclass
class _Pass:
    """Positions and states of samples while a pass writes them."""

    positions: NDArray[np.float64]
    state: NDArray[np.uint8]
    still: int = 0
    """Predictions that left a marker where it was."""

    @staticmethod
    def over(recording: Trajectories) -> _Pass:
        states = np.zeros(len(Origin), dtype=np.uint8)
        states[[Origin.MEASURED, Origin.REPAIRED]] = 1
        states[Origin.FILLED] = 2
        return _Pass(recording.positions.copy(), states[recording.origin])

    def run(self, gaps: Gaps, rule: Rule, *, backward: bool) -> None:
        from nodegraph_fill import stepwise_kernel

        markers = self.state.shape[1]
        reach = gaps.stop.max(initial=0) + 1
        samples = self.positions[:reach], self.state[:reach], gaps.mask[:reach]
        self.still += stepwise_kernel.run(
            *samples, backward, *rule.arguments(markers), min(rule.ring, markers)
        )


def fill_stepwise(
    recording: Trajectories, rule: Rule, *, close_gap: CloseGap, ends: Ends, max_gap: int | None
) -> Trajectories:
    """Fill a recording's gaps by a rule, and warn of what is left; called by a node.

    Parameters
    ----------
    recording
        Trajectories with gaps.
    rule
        How a sample is predicted.
    close_gap
        See `CloseGap`.
    ends
        The setting; ``met`` is a ramp where `close_gap` is ``none``: a gap begins at its first
        end, so that its whole mismatch is at the other.
    max_gap
        Longer gaps stay missing.

    Returns
    -------
    Trajectories
        The recording; present samples bit for bit as they were, written ones called filled.

    Raises
    ------
    ValueError
        If `close_gap` or `ends` is none of its choices.
    """
    check_ends(ends)
    if close_gap not in get_args(CloseGap):
        raise ValueError(f"close_gap must be none, ramp or blend, got {close_gap!r}")
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
    wanted = gaps.subset(~(long | gaps.never))
    positions = _blended if close_gap == "blend" else _chained
    chain = positions(recording, wanted, rule)
    if close_gap == "ramp" or (close_gap == "none" and ends == "met"):
        _ramp(chain, wanted.subset(wanted.inner), rule)
    filled = recording.with_samples(chain.positions, changed=wanted.mask, origin=Origin.FILLED)
    reasons = [(gaps.subset(gaps.never), NEVER), (gaps.subset(long), LONG)]
    warn_left(filled, reasons, "no usable neighbour", stacklevel=3)
    if chain.still:
        warnings.warn(
            f"{chain.still} predictions left a marker where it was: its nearest neighbour lies "
            "beyond falloff_radius, or where the marker itself does",
            stacklevel=3,
        )
    return filled


def _chained(recording: Trajectories, gaps: Gaps, rule: Rule) -> _Pass:
    chain = _Pass.over(recording)
    chain.run(gaps, rule, backward=False)
    chain.run(gaps.subset(gaps.at_start), rule, backward=True)
    return chain


def _blended(recording: Trajectories, gaps: Gaps, rule: Rule) -> _Pass:
    forward, backward = _Pass.over(recording), _Pass.over(recording)
    forward.run(gaps, rule, backward=False)
    backward.run(gaps, rule, backward=True)
    _, frame, marker, share = gaps.samples
    ahead, back = forward.positions[frame, marker], backward.positions[frame, marker]
    mixed = ahead + (back - ahead) * share[:, None]
    mixed = np.where(np.isnan(back), ahead, np.where(np.isnan(ahead), back, mixed))
    forward.positions[frame, marker] = mixed
    forward.still += backward.still
    return forward


def _ramp(chain: _Pass, gaps: Gaps, rule: Rule) -> None:
    """Spread each gap's mismatch over it, all from the positions before any is spread."""
    from nodegraph_fill import stepwise_kernel

    predicted = stepwise_kernel.predict_returns(
        chain.positions, chain.state, gaps.stop, gaps.marker, *rule.arguments(chain.state.shape[1])
    )
    _, returned = gaps.beside(chain.positions)
    mismatch = returned - predicted
    _, frame, marker, _ = gaps.samples
    chain.positions[frame, marker] = meet_ends(
        gaps, chain.positions[frame, marker], np.zeros_like(mismatch), mismatch
    )
