"""Long recordings piece by piece: what is worked out about a piece takes little memory."""

from __future__ import annotations

from collections.abc import Iterator

# A piece that has just been touched is still close to the processor when it is touched again.
_BYTES = 2**19


def pieces(frames: int, frame_bytes: int) -> Iterator[slice]:
    """Yield slices that together are all frames, in their order.

    Parameters
    ----------
    frames
        How many there are.
    frame_bytes
        Bytes of one frame; each slice has about half a megabyte, and one frame at least.
    """
    step = max(1, _BYTES // max(1, frame_bytes))
    for first in range(0, frames, step):
        yield slice(first, min(first + step, frames))
