"""Figures as drawings: how matplotlib's figures are drawn, shown in a report, and stored."""

from __future__ import annotations

import hashlib
import re
import warnings
from dataclasses import dataclass
from html import escape
from io import BytesIO
from threading import Lock
from typing import TYPE_CHECKING, Any

from nodegraph import Rendered, Value, listed
from nodegraph_tables.style import ROLES
from nodegraph_tables.types import Figure

if TYPE_CHECKING:
    from matplotlib.mathtext import MathTextParser, VectorParse
    from matplotlib.text import Text
    from matplotlib.transforms import Bbox

_DRAWING = Lock()
"""Held while matplotlib's settings, which all threads share, differ from the user's."""

_SETTINGS: dict[Any, object] = {
    "svg.hashsalt": "nodegraph",  # without, a drawing would have different ids each time
    "svg.fonttype": "none",
    "figure.autolayout": False,
    "figure.constrained_layout.use": False,
}
_TAG = re.compile(r"<[a-zA-Z][^>]*>")
_WIDTH = re.compile(r'<svg[^>]*\swidth="([\d.]+(?:pt|px))"')
_ID = re.compile(r"""(\sid="|href="#|url\(#)""")
_STYLE = re.compile(r'\sstyle="[^"]*"')
_COLOUR = re.compile(r"#[0-9a-f]{6}(?![0-9a-f])")
_FONTS = re.compile(r"'DejaVu Sans'(, [^;\"]*)?")
_SHEET = re.compile(r"<style[^>]*>\*\{([^}]*)\}</style>")
_PLACE = re.compile(r'\s(?:d|x|y|transform)="[^"]*"')
_LONG = re.compile(r"(\.\d\d)\d+")

_GREY = 6
"""The most by which the parts of a grey differ."""


@dataclass(frozen=True)
class StoredFigure(Value):
    """The drawing of a figure: it can be shown, but not changed any more.

    Attributes
    ----------
    svg, pdf : bytes
        The whole files.

    Raises
    ------
    ValueError
        If either is not a drawing.
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
        return render_stored_figure(self, "figure").html


def store_figure(figure: Figure) -> StoredFigure:
    """Return the drawing of a figure; equal bytes for equal figures, in any thread.

    Both files have the layout that the figure has on a screen: to find it takes as long as to
    draw it, and each format would ask for its own.
    """
    import matplotlib as mpl

    with _DRAWING, mpl.rc_context(_SETTINGS):
        show_broken_formulas_as_text(figure)
        engine = figure.get_layout_engine()
        if engine is not None:
            engine.execute(figure)
        box = figure.get_tightbbox().padded(mpl.rcParams["savefig.pad_inches"])
        figure.set_layout_engine(None)
        try:
            svg, pdf = (_saved(figure, format, box) for format in ("svg", "pdf"))
        finally:
            figure.set_layout_engine(engine)
    return StoredFigure(_rounded(svg), pdf)


def figure_files(figure: Figure) -> tuple[bytes, bytes]:
    """Return the drawing of a figure, as SVG and as PDF."""
    drawing = store_figure(figure)
    return drawing.svg, drawing.pdf


def _saved(figure: Figure, format: str, box: Bbox) -> bytes:
    file = BytesIO()
    undated = {"Date": None} if format == "svg" else {"CreationDate": None}
    figure.savefig(file, format=format, metadata=undated, bbox_inches=box)
    return file.getvalue()


def _rounded(svg: bytes) -> bytes:
    """Return a drawing with places to a hundredth of a point, finer than any screen or print."""

    def rounded(tag: re.Match[str]) -> str:
        return _PLACE.sub(lambda place: _LONG.sub(r"\1", place[0]), tag[0])

    return _TAG.sub(rounded, svg.decode()).encode()


def render_figure(figure: Figure, title: str) -> Rendered:
    """Return a figure as SVG in the page, and as SVG and PDF files beside it."""
    return render_stored_figure(store_figure(figure), title)


def render_stored_figure(figure: StoredFigure, title: str) -> Rendered:
    """Return a stored drawing, exactly as if the figure were drawn now."""
    drawing = _themed(_with_unique_ids(figure.svg.decode()))
    label = f'<svg role="img" aria-label="{escape(title, quote=True)}"'
    width = _WIDTH.search(drawing)
    size = f' style="--wide: {width[1]}"' if width else ""
    html = f'<figure class="figure"{size}>{drawing.replace("<svg", label, 1)}</figure>'
    return Rendered(html=html, files={".svg": figure.svg, ".pdf": figure.pdf}, kind="figure")


def show_broken_formulas_as_text(figure: Figure) -> None:
    r"""Have matplotlib draw texts literally whose ``$`` signs enclose no valid formula.

    Nodes should pass names through `figure_text`. Where a node does not, a name such as
    ``$\frac$`` would make the whole figure fail. Valid formulas stay formulas: the author of the
    node may have meant them.

    Warns
    -----
    UserWarning
        With the texts.
    """
    from matplotlib.mathtext import MathTextParser
    from matplotlib.text import Text

    parser = MathTextParser("path")
    texts = [text for text in figure.findobj(Text) if isinstance(text, Text)]
    broken = [text for text in texts if text.get_parse_math() and _is_broken(text, parser)]
    for text in broken:
        text.set_parse_math(False)
    if broken:
        shown = listed(dict.fromkeys(" ".join(text.get_text().split()) for text in broken))
        warnings.warn(f"drawn as text, as no formula: {shown}", stacklevel=2)


def _is_broken(text: Text, parser: MathTextParser[VectorParse]) -> bool:
    """Return whether matplotlib takes a line of a text for a formula that it cannot draw."""
    from matplotlib.cbook import is_math_text

    if text.get_usetex():
        return False
    for line in filter(is_math_text, text.get_text().split("\n")):
        try:
            parser.parse(line)
        except ValueError:
            return True
    return False


def _with_unique_ids(svg: str) -> str:
    """Return a drawing whose ids occur in no other drawing of a page, unless the two are equal."""
    drawing = svg[svg.index("<svg") :]
    prefix = "f" + hashlib.sha256(drawing.encode()).hexdigest()[:12]
    return _TAG.sub(lambda tag: _ID.sub(rf"\g<1>{prefix}-", tag[0]), drawing)


def _themed(svg: str) -> str:
    """Return a drawing whose colours follow the page's style sheet, light or dark.

    Colours with a role become its custom property, greys a mixture of ink and paper; others are
    of middle lightness and stay, but for texts, which need more contrast and are mixed with ink.
    Without such a style sheet, all stay as they were drawn.
    """
    shared = _SHEET.search(svg)
    begin = f'<svg style="fill: var(--ink, #000); {shared[1] if shared else ""}"'
    # the rule would hold for the whole page
    svg = _SHEET.sub("", svg).replace("<svg", begin, 1)
    return _TAG.sub(_themed_tag, svg)


def _themed_tag(tag: re.Match[str]) -> str:
    is_text = tag[0].startswith("<text")

    def style(attribute: re.Match[str]) -> str:
        fonts = _FONTS.sub("system-ui, 'Liberation Sans', Arial, sans-serif", attribute[0])
        return _COLOUR.sub(lambda colour: _page_colour(colour[0], is_text=is_text), fonts)

    return _STYLE.sub(style, tag[0])


def _page_colour(colour: str, *, is_text: bool) -> str:
    if colour in ROLES:
        return f"var({ROLES[colour]}, {colour})"
    parts = [int(colour[place : place + 2], 16) for place in (1, 3, 5)]
    if max(parts) - min(parts) > _GREY:
        return f"color-mix(in srgb, {colour} 65%, var(--ink, {colour}))" if is_text else colour
    share = round(100 * (1 - sum(parts) / 765))
    if share in (0, 100):
        return f"var(--ink, {colour})" if share else f"var(--paper, {colour})"
    return f"color-mix(in srgb, var(--ink, #000) {share}%, var(--paper, #fff))"
