"""A figure that was drawn before: what a stored result gives back in place of a figure."""

from __future__ import annotations

from dataclasses import dataclass

from nodegraph import Value


@dataclass(frozen=True)
class StoredFigure(Value):
    """The drawing of a figure; it can be shown, and not be changed any more.

    Attributes
    ----------
    svg, pdf : bytes
        The whole files.

    Raises
    ------
    ValueError
        If either is no drawing.
    """

    svg: bytes
    pdf: bytes

    def __post_init__(self) -> None:
        if not (isinstance(self.svg, bytes) and "<svg" in self.svg.decode()):
            raise ValueError("svg: must be the bytes of an SVG file")
        if not isinstance(self.pdf, bytes):
            raise ValueError("pdf: must be the bytes of a PDF file")

    def _repr_html_(self) -> str:
        """Return the drawing for a notebook."""
        from nodegraph_tables.renderers import render_stored_figure

        return render_stored_figure(self, "figure").html
