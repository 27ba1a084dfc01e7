"""Shapes beside what they are to match, such as the steps of an alignment."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated

from pydantic import Field

from nodegraph import Across, node
from nodegraph_mocap import Figure, Trajectories
from nodegraph_plot.recordings import agreeing, check_frames, named

if TYPE_CHECKING:
    from collections.abc import Mapping

    from nodegraph import Label


@node("plot.shapes")
def shapes(
    shapes: Across[Trajectories],
    references: Across[Trajectories],
    *,
    frame: Annotated[int, Field(ge=0)] = 0,
    view: Annotated[str, Field(pattern=r"^(auto|[+-][xyz][+-][xyz])$")] = "auto",
) -> Figure:
    """Draw one frame of shapes, each over its reference, a panel per shape.

    A shape is blue and its reference orange; grey lines join the points of one name. D in a
    panel's title is the sum of their squared lengths, as in figure 1 and equation 1 of the text
    on Procrustes analysis that aligns facial meshes. Points are joined up by the marker set's
    edges, without a marker set in the order of the markers and back to the first. Each panel has
    its own scale, the same along both of its axes; thin lines cross at the origin.

    Parameters
    ----------
    shapes
        Drawn in their order.
    references
        One for each shape, with the same labels, or one for all; points are matched by name. A
        reference of one frame is drawn in every frame.
    frame
        The frame that is drawn.
    view
        ``auto``, or the axes that point right and up in the picture, such as ``+x+y``. ``auto``
        sees each reference from the front, fewer than four points with x to the right and y up.

    Raises
    ------
    ValueError
        If a shape has no markers, it or its reference lacks the frame, it has no reference,
        several, or one without a marker in common, or `view` is not of that form.
    """
    from nodegraph_plot.shape_figure import draw

    by_name = named(shapes)
    labels = [label for label, _ in shapes]
    pairs = {
        name: (shape, _reference(name, at, references))
        for at, (name, shape) in zip(labels, by_name.items(), strict=True)
    }
    check_frames(by_name, (frame,))
    longer = {name: reference for name, (_, reference) in pairs.items() if reference.frames != 1}
    check_frames(
        {f"the reference {name}".rstrip(): reference for name, reference in longer.items()},
        (frame,),
    )
    return draw(pairs, frame, view)


def _reference(
    name: str, labels: Mapping[str, Label], references: Across[Trajectories]
) -> Trajectories:
    """Return the reference whose labels are those of the shape."""
    matches = agreeing(references, labels)
    if len(matches) != 1:
        of = f"the shape {name}" if name else "the shape"
        raise ValueError(f"{of} has {len(matches)} references, not one")
    return matches[0]
