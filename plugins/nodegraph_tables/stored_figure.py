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
    """

    svg: bytes
    pdf: bytes

    def _repr_html_(self) -> str:
        """Return the drawing for a notebook."""
        from nodegraph_tables.renderers import render_stored_figure

        return render_stored_figure(self, "figure").html
