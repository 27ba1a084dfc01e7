"""The setting that the fills share: whether a filled gap meets the samples at its ends."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Literal

import numpy as np

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from nodegraph_fill.gaps import Gaps

Ends = Literal["as_published", "met"]
"""The setting ``ends``. ``as_published``: the method's own estimate. ``met``: the mismatch at each
end of a gap is spread linearly over the gap; see `meet_ends`.
"""


def are_met(settings: Mapping[str, object]) -> bool:
    """Return whether a fill that does not meet the ends by itself meets them."""
    return bool(settings["ends"] == "met")


def meet_ends(
    gaps: Gaps,
    estimate: NDArray[np.float64],
    before: NDArray[np.float64],
    after: NDArray[np.float64],
) -> NDArray[np.float64]:
    """Return the estimate of the gaps' samples, moved to meet each gap's ends.

    At the j-th of a gap's L frames it is moved by ``b (1 - s) + a s``, with s = j / (L + 1) and b
    and a the mismatches, present minus estimated, before and after the gap: each is taken whole
    at its own end and fades to nothing at the other. An end that lies beyond the take, or has no
    estimate, has no mismatch.

    Parameters
    ----------
    gaps
        The gaps that were filled.
    estimate : (S, 3) array of float64
        Millimetres, in the order of `Gaps.samples`.
    before, after : (G, 3) arrays of float64
        The mismatches, mm; NaN where there is none.
    """
    gap, _, _, share = gaps.samples
    shift = np.nan_to_num(before)[gap] * (1.0 - share)[:, None]
    shift += np.nan_to_num(after)[gap] * share[:, None]
    return np.asarray(estimate + shift)
