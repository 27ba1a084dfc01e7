"""Shared by the step-wise neighbour fills: passes over the take, and the closing of a gap.

A missing sample is the marker's last position plus a displacement made from its neighbours':
``P'[t, m] = P[t-1, m] + sum(w_i (P[t, i] - P[t-1, i]))``. Each method's file says the weights.

The neighbours are the nearest to ``P[t-1, m]`` among the markers that are usable at both t-1
and t, equally near ones in marker order. Measured (and repaired) samples are usable; with
`use_filled` so are samples filled earlier, by this fill or before it, but they come after all
measured ones. The pass runs forward over the whole take, so that a gap of many frames continues
from its own fills. Where there is no usable neighbour, or the last position is missing, the
sample stays missing, and so does the rest of the gap. Gaps at the start of the take are then
filled by the same rule backward in time, from the marker's first sample.
"""

from __future__ import annotations

import warnings
from collections import deque
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal, get_args

import numpy as np

from nodegraph import StateForm
from nodegraph_fill.gaps import LONG, NEVER, Gaps, to_limit, warn_left
from nodegraph_fill.meet_ends import Ends, are_met, check_ends, meet_ends
from nodegraph_fill.streams import Limit
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

CloseGap = Literal["none", "ramp", "blend"]
"""Ways in which a fill meets the sample that ends the gap.

``none``: it does not, and a jump stays. ``ramp``: the sample that ends the gap is predicted too;
its mismatch e is spread, ``e j / (L + 1)`` at the j-th of L frames, where both ends and that
prediction are there. ``blend``: a forward and a backward pass, each by itself, cross-faded
linearly; where one is missing, the other.
"""


def lookahead(settings: Mapping[str, Any]) -> int | None:
    """Return the look-ahead of a step-wise fill."""
    max_gap: int | None = settings["max_gap"]
    if settings["close_gap"] == "blend":
        # backward, a gap continues from gaps that end later, if filled samples are neighbours
        return None if settings["use_filled"] else max_gap
    if not meets_ends(settings):
        return to_limit(settings)
    # until a gap's end, the neighbours are filled, whose gaps may be too long
    return None if max_gap is None else 2 * max_gap


def meets_ends(settings: Mapping[str, object]) -> bool:
    """Return whether a step-wise fill meets both ends of a gap."""
    return settings["close_gap"] != "none" or are_met(settings)


@dataclass(frozen=True, kw_only=True)
class Rule:
    """The prediction rule of one method.

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

    def arguments(self, markers: int) -> tuple[int, int, float, float, NDArray[np.bool_], bool]:
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


_STATES = np.zeros(len(Origin), dtype=np.uint8)
_STATES[[Origin.MEASURED, Origin.REPAIRED]] = 1
_STATES[Origin.FILLED] = 2
"""The kernel's state of a sample, by its origin."""


@dataclass
class _Pass:
    """Positions and states of samples while a pass writes them."""

    positions: NDArray[np.float64]
    state: NDArray[np.uint8]
    still: int = 0
    """Predictions that left a marker where it was."""

    @staticmethod
    def over(recording: Trajectories) -> _Pass:
        return _Pass(recording.positions.copy(), _STATES[recording.origin])

    def run(self, gaps: Gaps, rule: Rule, *, backward: bool) -> None:
        from nodegraph_fill import stepwise_kernel

        markers = self.state.shape[1]
        reach = gaps.stop.max(initial=0) + 1
        self.still += stepwise_kernel.run(
            self.positions[:reach],
            self.state[:reach],
            gaps.mask[:reach],
            backward,
            *rule.arguments(markers),
            min(rule.ring, markers),
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
        If `close_gap` or `ends` is not one of its choices.
    """
    check_ends(ends)
    if close_gap not in get_args(CloseGap):
        raise ValueError(f"close_gap must be none, ramp or blend, got {close_gap!r}")
    gaps = Gaps.of(recording)
    long = gaps.longer_than(max_gap) & ~gaps.never
    wanted = gaps.subset(~(long | gaps.never))
    if close_gap == "blend":
        chain = _blended(recording, wanted, rule)
    else:
        chain = _chained(recording, wanted, rule, ramps=close_gap == "ramp" or ends == "met")
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


def _chained(recording: Trajectories, gaps: Gaps, rule: Rule, *, ramps: bool) -> _Pass:
    chain, inner = _Pass.over(recording), gaps.subset(gaps.inner)
    chain.run(gaps, rule, backward=False)
    # a prediction forward in time knows nothing about what is filled backward
    mismatch = _mismatch(chain, inner, rule) if ramps else None
    chain.run(gaps.subset(gaps.at_start), rule, backward=True)
    if mismatch is not None:
        _, frame, marker, _ = inner.samples
        estimate = chain.positions[frame, marker]
        chain.positions[frame, marker] = meet_ends(
            inner, estimate, np.zeros_like(mismatch), mismatch
        )
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


def _mismatch(chain: _Pass, gaps: Gaps, rule: Rule) -> NDArray[np.float64]:
    """Return by how much the sample that ends each gap is off its prediction, (G, 3) mm."""
    from nodegraph_fill import stepwise_kernel

    predicted = stepwise_kernel.predict_returns(
        chain.positions, chain.state, gaps.stop, gaps.marker, *rule.arguments(chain.state.shape[1])
    )
    _, returned = gaps.beside(chain.positions)
    return np.asarray(returned - predicted)


def live_form(
    rule: Callable[..., Rule], lookahead: Callable[[Mapping[str, Any]], int | None] = lookahead
) -> StateForm:
    """Return how a step-wise fill computes frame by frame.

    Parameters
    ----------
    rule
        ``rule(recording, **settings)`` returns how a sample is predicted; the recording has no
        frames.
    lookahead
        That of the fill.
    """

    def state(
        recording: Trajectories,
        *,
        close_gap: CloseGap,
        ends: Ends,
        max_gap: int | None,
        **settings: object,
    ) -> _Stream:
        ramps = close_gap == "ramp" or ends == "met"
        return _Stream(recording, rule(recording, **settings), max_gap, ramps=ramps)

    return StateForm(
        state,
        lookahead=lambda settings: (
            None if settings["close_gap"] == "blend" else lookahead(settings)
        ),
        leaves="gaps at the start of the take",
    )


class _Stream:
    """A step-wise fill forward in time, frame by frame.

    Each frame is predicted as soon as it is known which of its gaps are too long, `max_gap`
    frames later. Where gaps are closed by a ramp, it is returned `max_gap` frames after that.
    """

    def __init__(
        self, recording: Trajectories, rule: Rule, max_gap: int | None, *, ramps: bool
    ) -> None:
        markers = len(recording.markers)
        self.header = recording
        self._arguments, self._ring = rule.arguments(markers), min(rule.ring, markers)
        self._limit = Limit(markers, max_gap)
        self._delay = (max_gap or 0) * ramps
        """Number of frames that a predicted frame waits for the ends of its gaps."""
        self._ramps = ramps
        self._gap = np.zeros(markers, dtype=np.intp)
        """Frames since each marker was last present, in gaps that are to be filled."""
        self._predicted: deque[MarkerFrame] = deque()
        # the newest predicted frame and the one before it, which the kernel takes
        self._positions = np.full((2, markers, 3), np.nan)
        self._state = np.zeros((2, markers), dtype=np.uint8)
        self._wanted = np.zeros((2, markers), dtype=np.bool_)
        self._frames = 0

    def push(self, frame: MarkerFrame) -> MarkerFrame | None:
        known = self._limit.push(frame)
        return None if known is None else self._predict(*known)

    def drain(self) -> Iterable[MarkerFrame]:
        for known in self._limit.drain():
            predicted = self._predict(*known)
            if predicted is not None:
                yield predicted
        yield from self._predicted

    def _predict(self, frame: MarkerFrame, wanted: NDArray[np.bool_]) -> MarkerFrame | None:
        """Predict a frame from the one before it; return the one whose gaps are closed."""
        from nodegraph_fill import stepwise_kernel

        positions, state = self._positions, self._state
        positions[0], state[0] = positions[1], state[1]
        positions[1], state[1], self._wanted[1] = frame.positions, _STATES[frame.origin], wanted
        stepwise_kernel.run(positions, state, self._wanted, False, *self._arguments, self._ring)
        filled = wanted & (state[1] != stepwise_kernel.MISSING)
        origin = frame.marked(filled, Origin.FILLED)
        self._predicted.append(MarkerFrame(positions[1].copy(), origin, frame.sigma))
        if self._ramps:
            self._close(wanted, np.flatnonzero((self._gap > 0) & ~wanted))
        self._frames += 1
        return self._predicted.popleft() if len(self._predicted) > self._delay else None

    def _close(self, wanted: NDArray[np.bool_], returned: NDArray[np.intp]) -> None:
        """Spread the mismatch of the gaps that end here, all from what was predicted."""
        from nodegraph_fill import stepwise_kernel

        lengths = self._gap[returned]
        self._gap = np.where(wanted, self._gap + 1, 0)
        # a gap that the stream begins with has one end
        inner = lengths < self._frames
        returned, lengths = returned[inner], lengths[inner]
        if not len(returned):
            return
        here = np.ones(len(returned), dtype=np.intp)
        predicted = stepwise_kernel.predict_returns(
            self._positions, self._state, here, returned, *self._arguments
        )
        mismatch = self._positions[1, returned] - predicted
        newest = len(self._predicted) - 1
        gaps = Gaps(returned, newest - lengths, here * newest, (newest + 1, len(self._gap)))
        _, step, marker, _ = gaps.samples
        places = list(zip(step, marker, strict=True))
        estimate = np.array([self._predicted[frame].positions[of] for frame, of in places])
        closed = meet_ends(gaps, estimate, np.zeros_like(mismatch), mismatch)
        for (frame, of), position in zip(places, closed, strict=True):
            self._predicted[frame].positions[of] = position
