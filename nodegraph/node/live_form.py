"""The live form of a node: its own function per frame, a window, or a state.

A node that computes one value of a whole take, such as a score, keeps numbers of it current.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any, Generic, Protocol, TypeVar

from nodegraph.node.declaration import UNDECLARED, LookAhead

H = TypeVar("H")
P = TypeVar("P")

FrameCount = int | Callable[[Mapping[str, Any]], int | None]
"""A number of frames, or what returns it for settings; None if nothing bounds it."""


@dataclass(slots=True)
class Window(Generic[P, H]):
    """Consecutive frames around the one that a window function computes.

    It and its arrays are used again for the next frame: what is returned must not share memory
    with them.

    Attributes
    ----------
    frames : payload
        As the payload of a frame, each array with one more axis in front, of ``before + 1 +
        after`` frames. Outside the stream, frames are missing.
    now : int
        The place of the frame that is computed: ``before``.
    header : value
        The stream's value, without frames: what does not change from frame to frame.
    """

    frames: P
    now: int
    header: H


class LiveState(Protocol):
    """Computes a node frame by frame; created for one stream.

    It is made with the arguments of the node's function, in which each port of `streams` is given
    the header of its stream (the value, without frames), other ports their whole value.

    Attributes
    ----------
    header : value, or tuple of values
        The header of the output; of a node with several outputs, one of each, None for one that is
        not given.
    """

    header: Any

    def push(self, *args: Any, **kwargs: Any) -> Any:
        """Take the next frame and return the one `lookahead` frames before it.

        Parameters
        ----------
        *args
            The payload at each port of `streams`, None for an open one. They are read-only.

        Returns
        -------
        payload, tuple of payloads, or None
            One for each output, None for one that is not given; None alone for each of the first
            `lookahead` frames.
        """

    def drain(self) -> Iterable[object]:
        """Return the results of the last `lookahead` frames, after the end of the stream."""


@dataclass(frozen=True)
class FrameForm:
    """The node's function itself, called with values of one frame.

    Attributes
    ----------
    streams : tuple of str
        Ports that take frames; by default the first. All others take whole values.
    """

    streams: tuple[str, ...] = ()


@dataclass(frozen=True)
class WindowForm:
    """A pure function of the frames around one, at the first port; its output has its header.

    Attributes
    ----------
    function : callable
        ``function(window, **ports_and_settings)`` returns the payload of the frame
        ``window.now``; the other ports are whole values.
    before, after : int or callable
        How many frames before and after it the window has; ``after`` is the look-ahead.

    Examples
    --------
    >>> def mean_at(window, *, order):
    ...     return Sample(window.frames.positions.mean(axis=0), ...)
    >>> half = lambda settings: settings["order"] // 2
    >>> MEAN = WindowForm(mean_at, before=half, after=half)
    >>> @node("smooth.mean", lookahead=half, live=MEAN)
    ... def mean(recording: Trajectories, *, order: int = 3) -> Trajectories:
    ...     return fold(MEAN, recording, order=order)
    """

    function: Callable[..., object]
    before: FrameCount
    after: FrameCount

    @property
    def streams(self) -> tuple[str, ...]:
        """The first port, as for the other forms."""
        return ()


@dataclass(frozen=True)
class StateForm:
    """A class whose instances take frame after frame: see `LiveState`.

    Attributes
    ----------
    state : callable
        The class.
    streams : tuple of str
        Ports that take frames; by default the first. All others take whole values.
    lookahead : LookAhead
        How many frames later the class gives a frame; by default what the node declares, or 0.
    leaves : str
        The part that it leaves missing at the start of a stream, before it has given anything
        there, though the function, which has the whole take, does not: ``"gaps at the start of the
        take"``.
    outputs : tuple of str
        Outputs that it gives; by default all. Others need the whole take: a table, say.
    tolerance : float
        By how much a number may differ from the function's, which computes many frames at once
        in another order of operations: relative to its size, or to 1 where it is smaller.
    """

    state: Callable[..., LiveState]
    streams: tuple[str, ...] = ()
    lookahead: LookAhead = UNDECLARED
    outputs: tuple[str, ...] = ()
    leaves: str = ""
    tolerance: float = 0.0


class RunningState(Protocol):
    """Keeps the numbers of a `RunningForm` current; created for one stream, as a `LiveState` is."""

    def push(self, *args: Any, **kwargs: Any) -> object:
        """Take the next frame and return the numbers of all frames so far.

        Parameters
        ----------
        *args
            The payload at each port of `streams`, None for an open one. They are read-only.

        Returns
        -------
        (K,) array of float64
            In the order of `RunningForm.numbers`, NaN for one that nothing is known of yet.
        """


@dataclass(frozen=True)
class RunningForm:
    """A class that keeps numbers current, for a node that computes one value of a whole take.

    A score of a take has no frames, but its mean error is known after each. On a stream the node
    gives these numbers in place of its output: after every frame they are what the function would
    give of a take that ended there.

    Attributes
    ----------
    state : callable
        The class, see `RunningState`.
    numbers : mapping of name to unit
        The numbers that it gives: ``{"gaps": "", "rmse": "mm"}``.
    summary : callable
        ``summary(value)`` returns the same numbers of what the function gives of a whole take.
    streams : tuple of str
        Ports that take frames; by default the first. All others take whole values.
    tolerance : float
        By how much a number may differ from the function's, relative to its size.

    Examples
    --------
    >>> class MeanError:
    ...     def __init__(self, estimate, truth):
    ...         self.sum, self.count = 0.0, 0
    ...     def push(self, estimate, truth):
    ...         self.sum += np.abs(estimate.positions - truth.positions).mean()
    ...         self.count += 1
    ...         return np.array([self.sum / self.count])
    >>> form = RunningForm(
    ...     MeanError, numbers={"mean": "mm"}, summary=lambda table: table["mean"],
    ...     streams=("estimate", "truth"), tolerance=1e-12,
    ... )
    """

    state: Callable[..., RunningState]
    numbers: Mapping[str, str] = field(hash=False)
    summary: Callable[[Any], Iterable[float]]
    streams: tuple[str, ...] = ()
    tolerance: float = 0.0


LiveForm = FrameForm | WindowForm | StateForm | RunningForm
