"""A study -> one HTML file that needs nothing else."""

from __future__ import annotations

from importlib.resources import files
from typing import TYPE_CHECKING

from nodegraph.report.study import Study

if TYPE_CHECKING:
    from jinja2 import Environment


def page(study: Study) -> str:
    """Return the report as HTML; texts of users are shown, never run."""
    from markupsafe import Markup

    template = _environment().get_template("page.html")
    trusted = {name: Markup(_text(name)) for name in ("page.css", "page.js")}
    return template.render(
        study=study,
        notes=Markup(_markdown(study.notes)),
        drawing=Markup(study.drawing),
        css=trusted["page.css"],
        js=trusted["page.js"],
    )


def _environment() -> Environment:
    from jinja2 import DictLoader, Environment, StrictUndefined

    environment = Environment(
        loader=DictLoader({"page.html": _text("page.html")}),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["duration"] = _duration
    return environment


def _text(name: str) -> str:
    return (files("nodegraph.report") / "templates" / name).read_text(encoding="utf-8")


def _markdown(text: str) -> str:
    from markdown_it import MarkdownIt

    made: str = MarkdownIt("commonmark", {"html": False}).enable("table").render(text)
    return made


def _duration(seconds: float) -> str:
    if seconds >= 60:
        return f"{seconds / 60:.1f} min"
    return f"{seconds:.1f} s" if seconds >= 1 else f"{seconds * 1000:.1f} ms"
