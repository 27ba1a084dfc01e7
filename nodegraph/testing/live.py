"""Check that a node's live form gives on a stream what its function gives of the whole take."""

from __future__ import annotations

import copy
import warnings
from collections.abc import Mapping, Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from nodegraph.equality import difference
from nodegraph.errors import Refusal
from nodegraph.live.forms import header_of, live_state, rows_of, streamable_of
from nodegraph.node.live_form import FrameForm, LiveForm, LiveState, RunningForm, StateForm
from nodegraph.testing.trial import Trial, with_line

if TYPE_CHECKING:
    from numpy.typing import NDArray

Row = tuple[Any, ...]

_DIFFERS = (
    "gives on a stream another result than of the whole take: let the function be "
    "nodegraph.fold(form, ...), or compute each frame in the same order of operations"
)
_FAILS = (
    "its live form fails: it must accept every stream whose whole take the function accepts, "
    "with missing frames anywhere, and must not write to the arrays that it is given"
)
_LATE = (
    "its live form does not give a frame at every push from the look-ahead on, and at the end "
    "exactly the rest: declare the look-ahead that it has, return None only before it, and give "
    "the rest in drain()"
)
_CHANGES = (
    "its live form changes what it has already returned: return arrays of its own, neither its "
    "buffers nor views of a window"
)
_SHARES = (
    "two streams at a time disturb each other: keep the state in the instance, not in the class "
    "or the module"
)
_NOT_BY_FRAME = (
    "is declared to compute frame by frame, but looks ahead: omit live='frame' or declare a window"
)


_LONG = 400
"""Frames of a long take."""
_LONG_GAP = range(205, 295)
"""Its longest gap."""


def check_live_form(trial: Trial, outputs: Mapping[str, object], *, long: bool) -> None:
    """Note the faults of a node's live form that a specimen shows.

    Parameters
    ----------
    trial
    outputs
        The outputs of the function for the whole take.
    long
        Whether to draw a long take from the specimen's frames as well.
    """
    node = trial.node
    settings = {**node.defaults, **trial.settings}
    lookahead = node.live_lookahead(settings)
    if lookahead is None:
        return
    if isinstance(node.live, FrameForm) and lookahead:
        trial.add_fault(_NOT_BY_FRAME, f"look-ahead {lookahead}")
        return
    stream = _Stream(trial, settings, lookahead)
    stream.check(outputs)
    if long:
        stream.check_long()


class _Stream:
    """The specimens at the ports that take frames, as a stream."""

    def __init__(self, trial: Trial, settings: Mapping[str, object], lookahead: int) -> None:
        inputs = trial.inputs
        self._trial = trial
        self._lookahead = lookahead
        self._settings = settings
        self._streams = {name: inputs[name] for name in trial.node.streams if name in inputs}
        self._rest = {name: value for name, value in inputs.items() if name not in self._streams}
        self._headers = {name: header_of(value) for name, value in self._streams.items()}
        self._rows = list(rows_of(map(self._streams.get, self._trial.node.streams)))
        self._missing = tuple(
            streamable_of(type(header)).missing(header) if header is not None else None
            for header in map(self._headers.get, self._trial.node.streams)
        )

    def check(self, outputs: Mapping[str, object]) -> None:
        """Compare stream and whole take: of all frames, of the first, and with frames missing."""
        rows = self._rows
        if not self._agrees(rows, outputs, "all frames", beside_another=True):
            return
        count = len(rows)
        for frames in sorted({1, self._lookahead, self._lookahead + 1, count // 2} - {0, count}):
            if frames < count and not self._agrees(rows[:frames], None, f"the first {frames}"):
                return
        for gone in ({0}, {count - 1}, {count // 2, count // 2 + 1}, set(range(count // 3))):
            damaged = [self._missing if frame in gone else row for frame, row in enumerate(rows)]
            if not self._agrees(damaged, None, f"frames {sorted(gone)} missing"):
                return

    def check_long(self) -> None:
        """Compare them over a long take, in which much is missing at the first port.

        It is drawn from the specimen's frames: pieces in their order, and between them one frame
        that stays for a while. Gaps begin and end anywhere, some at the ends of the take; all is
        missing in a few frames in a row; the longest gap lasts 90 frames.
        """
        draw = np.random.default_rng(len(self._rows))
        order: list[int] = []
        while len(order) < _LONG:
            start = int(draw.integers(len(self._rows)))
            order += [*range(start, len(self._rows)), *([start] * int(draw.integers(40)))]
        missing: Any = self._missing[0]
        part = missing[0] if isinstance(missing, tuple) else missing
        gone = np.zeros((_LONG, max(len(part), 1)), dtype=np.bool_)
        for column in gone.T:
            for start in draw.integers(-10, _LONG, 8):
                column[max(start, 0) : max(start + int(draw.integers(1, 25)), 0)] = True
        gone[150:154] = True
        around = slice(_LONG_GAP.start - 5, _LONG_GAP.stop + 5)
        gone[around] = False
        gone[_LONG_GAP.start : _LONG_GAP.stop, 0] = True
        rows = [
            (_without(self._rows[number][0], missing, where), *self._rows[number][1:])
            for number, where in zip(order, gone, strict=False)
        ]
        self._agrees(rows, None, f"a drawn take of {_LONG} frames", beside_another=True)

    def _agrees(
        self,
        rows: Sequence[Row],
        outputs: Mapping[str, object] | None,
        what: str,
        *,
        beside_another: bool = False,
    ) -> bool:
        """Return whether the live form gives what the function gives, without other faults.

        Parameters
        ----------
        rows
        outputs
            The outputs of the function for these frames; None: they are computed.
        what
            What is special about these frames.
        beside_another
            Whether to stream them again beside another stream, which takes twice as long.
        """
        node = self._trial.node
        if outputs is None:
            columns = dict(zip(node.streams, zip(*rows, strict=True), strict=True))
            whole = {
                name: streamable_of(type(header)).join(header, columns[name])
                for name, header in self._headers.items()
            }
            outputs = self._trial.again(self._settings, **whole)
            if outputs is None:  # the function declines the whole take
                return True
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                streamed = self._outputs(rows, what, beside_another=beside_another)
        except Refusal:  # as a function may decline, so may a live form
            return True
        except Exception as error:
            self._trial.add_fault(_FAILS, f"{what}: {with_line(error)}")
            return False
        if streamed is None:
            return False
        for port, value in zip(node.outputs, streamed, strict=True):
            if value is None:
                continue
            if changed := _difference(node.live, value, outputs[port.name], port.name):
                self._trial.add_fault(_DIFFERS, f"{what}: {changed}")
                return False
        return True

    def _outputs(
        self, rows: Sequence[Row], what: str, *, beside_another: bool
    ) -> Sequence[object] | None:
        """Return what the live form gives for some frames, or None after a fault."""
        state = self._state()
        results: list[object] = []
        for number, row in enumerate(rows):
            result = state.push(*row)
            if (result is None) != (number < self._lookahead):
                gives = "nothing" if result is None else "a frame"
                self._trial.add_fault(
                    _LATE, f"{what}: push {number} gives {gives}, look-ahead {self._lookahead}"
                )
                return None
            if result is not None:
                results.append(result)
        rest = list(state.drain())
        if len(rest) != min(self._lookahead, len(rows)):
            self._trial.add_fault(
                _LATE, f"{what}: drain gives {len(rest)} frames, look-ahead {self._lookahead}"
            )
            return None
        results += rest
        if beside_another and not self._are_given_beside_another(results, rows, what):
            return None
        return self._joined(state.header, results)

    def _are_given_beside_another(
        self, alone: Sequence[object], rows: Sequence[Row], what: str
    ) -> bool:
        """Return whether results are the same while another instance takes the frames backward."""
        state, other = self._state(), self._state()
        results: list[object] = []
        copies: list[object] = []
        for row, backward in zip(rows, rows[::-1], strict=True):
            result = state.push(*row)
            other.push(*backward)
            if result is not None:
                results.append(result)
                copies.append(copy.deepcopy(result))
        rest = list(state.drain())
        if changed := self._changed(state.header, copies, results):
            self._trial.add_fault(_CHANGES, f"{what}: {changed}")
            return False
        if changed := self._changed(state.header, alone, [*results, *rest]):
            self._trial.add_fault(_SHARES, f"{what}: {changed}")
            return False
        return True

    def _changed(self, header: Any, first: Sequence[object], second: Sequence[object]) -> str:
        """Return where two streams of one header first differ, or an empty text.

        Joined, they have one array where each frame has one.
        """
        if not first:
            return ""
        return difference(self._joined(header, first), self._joined(header, second), name="stream")

    def _joined(self, header: Any, results: Sequence[Any]) -> Sequence[object]:
        """Return the value of each output; None for one that has no header."""
        if not self._trial.node.splits:
            return [streamable_of(type(header)).join(header, results)]
        columns = zip_longest(header, zip(*results, strict=True), fillvalue=())
        return [
            None if each is None else streamable_of(type(each)).join(each, column)
            for each, column in columns
        ]

    def _state(self) -> LiveState:
        return live_state(self._trial.node, self._headers, self._rest, self._settings)


def _without(payload: Any, missing: Any, where: NDArray[np.bool_]) -> Any:
    """Return a payload without some of its markers, weights or whatever its arrays are of.

    Parameters
    ----------
    payload
    missing
        The payload of a frame that never arrived.
    where
        Whether each is missing. Of a payload with another number of them, all are if any is.
    """
    if not where.any():
        return payload
    if not isinstance(missing, tuple):
        if np.shape(payload) != np.shape(missing) or len(payload) != len(where):
            return missing
        return np.where(where.reshape(-1, *[1] * (missing.ndim - 1)), missing, payload)
    kind: Any = type(missing)
    parts = zip(payload, missing, strict=True)
    return kind(*(part if part is None else _without(part, other, where) for part, other in parts))


def _difference(form: LiveForm | None, streamed: Any, whole: object, name: str) -> str:
    """Return where a stream's result is not that of the whole take, beyond what a form declares."""
    if isinstance(form, RunningForm):
        streamed = streamed.values[-1:]  # nothing of a stream without frames
        numbers = np.array([list(form.summary(whole))], dtype=np.float64)[: len(streamed)]
        if streamed.shape == numbers.shape:
            near = np.abs(streamed - numbers) <= form.tolerance * np.abs(numbers)
            streamed = np.where(near, numbers, streamed)
        return difference(streamed, numbers, name=name)
    differs = difference(streamed, whole, name=name)
    if differs and isinstance(form, StateForm) and (form.leaves or form.tolerance):
        return difference(streamed, _departing(streamed, whole, form), name=name)
    return differs


def _departing(streamed: object, whole: object, form: StateForm) -> object:
    """Return the whole take's result with the stream's numbers where the form lets them differ."""
    kind = streamable_of(type(whole))
    header = kind.header(whole)
    missing = kind.missing(header)
    left: dict[int, object] = {}
    payloads = [
        _departing_payload(*both, missing, form, left)
        for both in zip_longest(kind.split(streamed), kind.split(whole), fillvalue=missing)
    ]
    return kind.join(header, payloads)


def _departing_payload(
    streamed: Any, whole: Any, missing: Any, form: StateForm, left: dict[int, object], at: int = 0
) -> Any:
    """Return one frame of it; `left` says per part where the stream has given nothing so far."""
    if isinstance(missing, tuple):
        parts = enumerate(zip(streamed, whole, missing, strict=True))
        return type(missing)(*(_departing_payload(*part, form, left, i) for i, part in parts))
    if streamed is None or whole is None:
        return whole
    free = np.zeros(np.shape(whole), dtype=np.bool_)
    if form.leaves:
        is_missing = (streamed == missing) | (np.isnan(streamed) & np.isnan(missing))
        left[at] = left.get(at, True) & is_missing
        free |= left[at]
    if whole.dtype.kind == "f":
        free |= np.abs(streamed - whole) <= form.tolerance * np.maximum(np.abs(whole), 1.0)
    return np.where(free, streamed, whole)
