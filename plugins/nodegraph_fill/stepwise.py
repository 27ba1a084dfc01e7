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
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from nodegraph import StateForm, node
from nodegraph_fill.family import CALLER, make_fill
from nodegraph_fill.filling import Filling
from nodegraph_fill.gaps import Gaps, to_limit
from nodegraph_fill.meet_ends import Ends, are_met, meet_ends
from nodegraph_fill.streams import Limit
from nodegraph_fill.tuning import Tune, is_trying, unless_tuned
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

if TYPE_CHECKING:
    from numpy.typing import NDArray

CloseGap = Literal["none", "ramp", "blend"]
"""Ways in which a fill meets the sample that ends the gap.

``ramp``: the mismatch is spread where both ends and the prediction of the second are there.
"""


@dataclass(frozen=True, kw_only=True)
class Stepping(Filling):
    """A recording with gaps, and the settings of a step-wise fill.

    Attributes
    ----------
    use_filled
        Whether samples filled earlier serve as neighbours, after all measured ones.
    close_gap
        none: a jump stays where the marker reappears. ramp: that sample is predicted too and
        its mismatch e spread over the gap, ``e j / (L + 1)`` at the j-th of L frames. blend: a
        forward and a backward pass, cross-faded linearly; where one is missing, the other.
    ends
        met: the mismatch where the marker reappears is spread over the gap, a ramp, unless
        `close_gap` already sees to it. as_published: as `close_gap` has it.
    """  # a gap begins at its first end, so that its whole mismatch is at the other

    use_filled: bool = True
    close_gap: Annotated[CloseGap, Tune("none", "blend")] = "none"

    @property
    def ramps(self) -> bool:
        """Whether the mismatch is spread over the gap."""
        return self.close_gap == "ramp" or self.ends == "met"


_LEFT = """\
A gap at the start of the take is filled backward from the marker's first sample. What has
no usable neighbour stays missing, as does the rest of that gap, counted in a warning.
Samples that are present come out bit for bit; those an earlier fill made count as filled.

Looks ahead 0 frames, but for gaps at the start of the take; with a `max_gap` that many, to know
that a gap is no longer; twice as many with `close_gap` ramp or `ends` met, up to the gap's end
without a `max_gap`; with blend to the take's end. Frame by frame, gaps at the start of the
take stay missing."""


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
        Whether the second marker may be a neighbour of the first; None: any of any other.

    Raises
    ------
    ValueError
        If there is to be no neighbour.
    """

    weights: str
    neighbours: int
    use_filled: bool = True
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
        return _Pass(recording.positions.copy(), _STATES.take(recording.origin))

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


def stepwise(
    name: str,
    *,
    cite: str | tuple[str, ...],
    adapted: str = "",
    lookahead: Callable[[Mapping[str, Any]], int | None] = lookahead,
) -> Callable[[Callable[..., Rule]], Callable[..., Trajectories]]:
    """Make a rule by which a sample is predicted a fill.

    The method takes a recording, which has no frames on a stream, and its settings, which are
    keyword-only. It returns a `Rule`.

    Parameters
    ----------
    name, cite, adapted, lookahead
        As for `nodegraph.node`.
    """

    def decorate(method: Callable[..., Rule]) -> Callable[..., Trajectories]:
        def fill(filling: Stepping, gaps: Gaps, **settings: Any) -> Trajectories:
            recording = filling.recording
            rule = replace(method(recording, **settings), use_filled=filling.use_filled)
            if filling.close_gap == "blend":
                chain = _blended(recording, gaps, rule)
            else:
                chain = _chained(recording, gaps, rule, ramps=filling.ramps)
            if chain.still and not is_trying():
                warnings.warn(
                    f"{chain.still} predictions left a marker where it was: its nearest "
                    "neighbour lies beyond falloff_radius, or where the marker itself does",
                    stacklevel=CALLER,
                )
            return recording.with_samples(chain.positions, changed=gaps.mask, origin=Origin.FILLED)

        return node(
            name,
            cite=cite,
            adapted=adapted,
            lookahead=unless_tuned(lookahead),
            ends=meets_ends,
            live=_live_form(method, lookahead),
            shares=Stepping,
        )(make_fill(method, Stepping, fill, _LEFT, otherwise="no usable neighbour"))

    return decorate


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


def _live_form(
    method: Callable[..., Rule], lookahead: Callable[[Mapping[str, Any]], int | None]
) -> StateForm:
    def state(
        recording: Trajectories,
        *,
        use_filled: bool,
        close_gap: CloseGap,
        ends: Ends,
        max_gap: int | None,
        settings: object,
        **own: object,
    ) -> _Stream:
        rule = replace(method(recording, **own), use_filled=use_filled)
        ramps = close_gap == "ramp" or ends == "met"
        return _Stream(recording, rule, max_gap, ramps=ramps)

    def live_lookahead(settings: Mapping[str, Any]) -> int | None:
        return None if settings["close_gap"] == "blend" else lookahead(settings)

    leaves = "gaps at the start of the take"
    return StateForm(state, lookahead=unless_tuned(live_lookahead), leaves=leaves)


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
