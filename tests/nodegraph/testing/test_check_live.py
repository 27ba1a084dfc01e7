"""Live forms of good nodes pass; one that cheats is told how, and a whole take is its fold."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from nodegraph import (
    FrameForm,
    Refusal,
    RunningForm,
    StateForm,
    Truth,
    Window,
    WindowForm,
    fold,
    node,
)
from nodegraph.testing import check_node
from nodegraph_mocap import MarkerFrame, Origin, Trajectories

Function = Callable[..., Any]
Frame = MarkerFrame


def half(settings: Mapping[str, Any]) -> int:
    width: int = settings["width"]
    return width // 2


def frame_of(positions: NDArray[np.float64], frame: Frame) -> Frame:
    missing = np.isnan(positions[:, 0])
    origin = np.where(frame.origin == Origin.MISSING, np.uint8(Origin.FILLED), frame.origin)
    return Frame(positions, np.where(missing, np.uint8(Origin.MISSING), origin), frame.sigma)


def mean_at(window: Window[Frame, Trajectories], *, width: int) -> Frame:
    frames, now = window.frames, window.now
    total = np.zeros_like(frames.positions[now])
    for positions in frames.positions:
        total = total + positions
    sigma = None if frames.sigma is None else frames.sigma[now].copy()
    return frame_of(total / width, Frame(total, frames.origin[now], sigma))


MEAN = WindowForm(mean_at, before=half, after=half)


@node("live.mean", lookahead=half, live=MEAN)
def mean(recording: Trajectories, *, width: int = 3) -> Trajectories:
    """Average the frames around each.

    Parameters
    ----------
    recording
        Any.
    width
        Of the window, odd.
    """
    return fold(MEAN, recording, width=width)  # type: ignore[no-any-return]


class Delayed:
    """Gives frames again, some later, with the last known position of a missing sample."""

    def __init__(self, recording: Trajectories, *, frames: int) -> None:
        self.header = recording
        self.last = np.full((len(recording.markers), 3), np.nan)
        self.waiting: list[Frame] = []
        self.frames = frames

    def push(self, frame: Frame) -> Frame | None:
        self.last = np.where(np.isnan(frame.positions), self.last, frame.positions)
        self.waiting.append(frame_of(self.last, frame))
        return self.waiting.pop(0) if len(self.waiting) > self.frames else None

    def drain(self) -> Iterable[Frame]:
        return self.waiting


def hold_with(state: Function, lookahead: int | None = None, **departs: Any) -> Function:
    later = lookahead or 0
    form = StateForm(state, lookahead=lambda settings: settings["frames"] + later, **departs)

    @node("live.hold", lookahead=0, live=form)
    def hold(recording: Trajectories, *, frames: int = 2) -> Trajectories:
        """Hold the last known position.

        Parameters
        ----------
        recording
            Any.
        frames
            How many frames later its live form gives each.
        """
        return fold(StateForm(Delayed), recording, frames=frames)  # type: ignore[no-any-return]

    return hold


@node("live.shift", live=FrameForm(streams=("recording", "truth")))
def shift(recording: Trajectories, truth: Truth[Trajectories]) -> Trajectories:
    """Put each marker that is missing where it is in truth."""
    missing = ~recording.present & truth.present
    positions = np.where(missing[..., None], truth.positions, recording.positions)
    return recording.with_samples(positions, changed=missing, origin=Origin.FILLED)


class Missing:
    """The share of samples missing so far."""

    def __init__(self, recording: Trajectories) -> None:
        self.missing = self.samples = 0

    def push(self, frame: Frame) -> NDArray[np.float64]:
        self.missing += int(np.count_nonzero(frame.origin == Origin.MISSING))
        self.samples += len(frame.origin)
        return np.array([self.missing / self.samples])


class SkipsFrames(Missing):
    def push(self, frame: Frame) -> NDArray[np.float64]:
        if (frame.origin == Origin.MISSING).all():
            return np.array([self.missing / max(self.samples, 1)])
        return super().push(frame)


def missing_with(state: Function) -> Function:
    form = RunningForm(state, numbers={"missing": "share"}, summary=lambda whole: [whole])

    @node("live.missing", live=form)
    def missing(recording: Trajectories) -> float:
        """Return the share of missing samples."""
        if not recording.present.size:
            raise Refusal("there is no sample")
        return float(np.mean(~recording.present))

    return missing


@pytest.mark.parametrize("function", [mean, hold_with(Delayed), shift, missing_with(Missing)])
def test_good_live_forms_pass(function: Function) -> None:
    check_node(function)


class TooEarly(Delayed):
    def drain(self) -> Iterable[Frame]:
        return self.waiting[1:]


class Reuses(Delayed):
    def push(self, frame: Frame) -> Frame | None:
        result = super().push(frame)
        if result is None:
            return None
        self.result = getattr(self, "result", result)
        self.result.positions[:] = result.positions
        return self.result


class Shares(Delayed):
    shared: NDArray[np.float64] | None = None

    def push(self, frame: Frame) -> Frame | None:
        if Shares.shared is None or Shares.shared.shape != frame.positions.shape:
            Shares.shared = self.last
        self.last = Shares.shared
        result = super().push(frame)
        Shares.shared = self.last
        return result


class Writes(Delayed):
    def push(self, frame: Frame) -> Frame | None:
        frame.positions[:] = 0.0
        return super().push(frame)


class Forgets(Delayed):
    def push(self, frame: Frame) -> Frame | None:
        if np.isnan(frame.positions).all():
            self.last = np.full_like(self.last, np.nan)
        return super().push(frame)


@pytest.mark.parametrize(
    ("cheat", "lookahead", "complaint"),
    [
        (Delayed, 1, "push 2 gives a frame, look-ahead 3"),
        (TooEarly, 0, "drain gives 1 frames, look-ahead 2"),
        (Reuses, 0, "changes what it has already returned"),
        (Shares, 0, "two streams at a time disturb each other"),
        (Writes, 0, "must not write to the arrays"),
        (Forgets, 0, "another result than of the whole take"),
    ],
)
def test_a_live_form_that_differs_from_the_whole_take_fails_with_the_reason(
    cheat: Function, lookahead: int, complaint: str
) -> None:
    with pytest.raises(AssertionError, match=complaint):
        check_node(hold_with(cheat, lookahead))


class LeaksLate(Delayed):
    """Is off after 64 frames."""

    pushed = 0

    def push(self, frame: Frame) -> Frame | None:
        self.pushed += 1
        result = super().push(frame)
        return _moved(result) if result and self.pushed > 64 else result


class RewritesLate(Delayed):
    """Writes each frame into the array of the one 50 frames before."""

    def __init__(self, recording: Trajectories, *, frames: int) -> None:
        super().__init__(recording, frames=frames)
        self.ring: list[NDArray[np.float64]] = []

    def push(self, frame: Frame) -> Frame | None:
        result = super().push(frame)
        if result is None:
            return None
        if len(self.ring) < 50:
            self.ring.append(result.positions.copy())
        else:
            self.ring.append(self.ring.pop(0))
            self.ring[-1][:] = result.positions
        return result._replace(positions=self.ring[-1])


class GivesUp(Delayed):
    """Holds no longer than the 40 frames for which it waits for a sample."""

    def push(self, frame: Frame) -> Frame | None:
        missing = np.isnan(frame.positions)
        self.missing = np.where(missing, getattr(self, "missing", 0) + 1, 0)
        self.last = np.where(self.missing > 40, np.nan, self.last)
        return super().push(frame)


@pytest.mark.parametrize(
    ("cheat", "complaint"),
    [
        (LeaksLate, "another result than of the whole take"),
        (RewritesLate, "changes what it has already returned"),
        (GivesUp, "another result than of the whole take"),
    ],
)
def test_what_shows_only_in_a_long_take_is_a_fault(cheat: Function, complaint: str) -> None:
    with pytest.raises(AssertionError, match=f"{complaint}(.|\n)*a drawn take of 400 frames"):
        check_node(hold_with(cheat))


def test_running_numbers_are_those_of_a_take_that_ends_here() -> None:
    with pytest.raises(AssertionError, match="another result than of the whole take"):
        check_node(missing_with(SkipsFrames))


class Begins(Delayed):
    """Gives nothing of a marker before its second sample."""

    def push(self, frame: Frame) -> Frame | None:
        present = ~np.isnan(frame.positions[:, 0])
        known = getattr(self, "known", np.zeros(len(present), dtype=np.bool_))
        self.known = known | present
        positions = np.where(known[:, None], frame.positions, np.nan)
        origin = np.where(known, frame.origin, np.uint8(Origin.MISSING))
        sigma = None if frame.sigma is None else np.where(known, frame.sigma, np.nan)
        return super().push(Frame(positions, origin, sigma))


class Leaves(Delayed):
    """Does not hold what is missing twice in a row."""

    def push(self, frame: Frame) -> Frame | None:
        missing = np.isnan(frame.positions)
        before = getattr(self, "missing", missing)
        self.missing = missing
        self.last = np.where(missing & before, np.nan, self.last)
        return super().push(frame)


class Moves(Delayed):
    """Is a little off."""

    def push(self, frame: Frame) -> Frame | None:
        result = super().push(frame)
        return result and _moved(result)

    def drain(self) -> Iterable[Frame]:
        return map(_moved, self.waiting)


def _moved(frame: Frame) -> Frame:
    return frame._replace(positions=frame.positions + 1e-9)


@pytest.mark.parametrize(
    ("departing", "declared", "other"),
    [
        (Begins, {"leaves": "first samples"}, {"tolerance": 1e-6}),
        (Moves, {"tolerance": 1e-8}, {"leaves": "first samples"}),
    ],
)
def test_a_live_form_may_depart_as_it_declares(
    departing: Function, declared: Mapping[str, Any], other: Mapping[str, Any]
) -> None:
    check_node(hold_with(departing, **declared))
    with pytest.raises(AssertionError, match="another result than of the whole take"):
        check_node(hold_with(departing, **other))


def test_what_is_left_later_than_at_the_start_is_a_fault() -> None:
    with pytest.raises(AssertionError, match="another result than of the whole take"):
        check_node(hold_with(Leaves, leaves="samples missing twice"))


def test_a_whole_take_rule_is_no_frame_form() -> None:
    @node("live.centre", live="frame")
    def centre(recording: Trajectories) -> Trajectories:
        """Fill with the mean over the take."""
        positions = recording.positions.copy()
        mean = np.nanmean(positions, axis=0) if recording.present.any() else positions[0]
        missing = ~recording.present
        positions[missing] = np.broadcast_to(mean, positions.shape)[missing]
        return recording.with_samples(positions, changed=missing, origin=Origin.FILLED)

    with pytest.raises(AssertionError, match="another result than of the whole take"):
        check_node(centre)


def test_a_live_form_streams_its_own_ports() -> None:
    @node("live.other", live=FrameForm(streams=("markers",)))
    def other(recording: Trajectories) -> Trajectories:
        """Do nothing."""
        return recording

    with pytest.raises(AssertionError, match="streams markers; its ports are recording"):
        check_node(other)
