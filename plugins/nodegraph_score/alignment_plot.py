"""What PCA finds in recordings, drawn."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from nodegraph import Across, Truth, node
from nodegraph_mocap import Figure, HeadMotion, Trajectories
from nodegraph_score.alignment import alignment


@node("plot.alignment", cite="krzanowski2000")
def alignment_plot(
    recordings: Across[Trajectories],
    head_motion: Truth[HeadMotion],
    removed: Across[HeadMotion] | None = None,
    *,
    components: Annotated[int, Field(ge=1)] = 5,
) -> Figure:
    """Draw the variances of principal components, and what head motion makes of each.

    They are those that ``score.alignment`` finds.

    Parameters
    ----------
    recordings, head_motion, removed
        As for ``score.alignment``.
    components
        Upper limit for each recording; fewer where fewer have variance.

    Returns
    -------
    Figure
        A panel per recording, in it a bar per component, as high as its share of the variance;
        what head motion makes of it is filled.

    Raises
    ------
    Refusal, ValueError
        As ``score.alignment`` does.
    """
    from nodegraph_score.alignment_figure import draw

    found = alignment(recordings, head_motion, removed, components=components)
    return draw(found, recordings.axes)
