"""Texts for a paper: paragraphs on the methods, a table of settings, the references."""

from __future__ import annotations

import re
from collections.abc import Container, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby

from markupsafe import Markup, escape

from nodegraph.report.study import AxisRow, MethodRow, SettingRow, Study

_WIDTHS = {"node": 0.13, "method": 0.24, "setting": 0.17, "value": 0.27, "unit": 0.09}
"""Heads of the settings, and what each takes of a page's width; the rest is between them."""

_LATEX = str.maketrans(
    {
        **{sign: f"\\{sign}" for sign in "&%$#_{}"},
        "\\": r"\textbackslash{}",
        "~": r"\textasciitilde{}",
        "^": r"\textasciicircum{}",
        "<": r"\textless{}",
        ">": r"\textgreater{}",
        "[": "{[}",
        "]": "{]}",
    }
)
_MACHINE = ("python", "numpy", "scipy")
_MOST_LABELS = 6


def cited(study: Study) -> Mapping[str, str]:
    """Return the texts of a study for a paper, by file name.

    Parameters
    ----------
    study

    Returns
    -------
    mapping of str to str
        ``methods.md`` and ``methods.tex``, paragraphs on what the study ran over, on every method
        that gave a result with what differs from its defaults, and on the software;
        ``settings.md`` and ``settings.tex``, a table of all settings with units and of how far each
        method looks ahead; ``references.bib``, the BibTeX of the methods.
    """
    return {
        "methods.md": _text(study, _Markdown()),
        "settings.md": _markdown_table(study),
        "references.bib": study.bibtex,
        "methods.tex": _text(study, _Latex()),
        "settings.tex": _latex_table(study),
    }


class _Markdown:
    """Pandoc's Markdown."""

    def code(self, text: str) -> str:
        return f"`{text}`"

    def plain(self, text: str) -> str:
        return text

    def cite(self, keys: Iterable[str]) -> str:
        return f" [{'; '.join(f'@{key}' for key in keys)}]"


class _Latex:
    """LaTeX, for any bibliography package."""

    def code(self, text: str) -> str:
        return rf"\texttt{{{self.plain(text)}}}"

    def plain(self, text: str) -> str:
        return text.translate(_LATEX)

    def cite(self, keys: Iterable[str]) -> str:
        return rf"~\cite{{{','.join(keys)}}}"


class _Html:
    """HTML, in which sources are numbered as they come.

    Attributes
    ----------
    numbers : dict of str to int
        The number of each BibTeX key.
    """

    def __init__(self) -> None:
        self.numbers: dict[str, int] = {}

    def code(self, text: str) -> str:
        return Markup("<code>{}</code>").format(text)

    def plain(self, text: str) -> str:
        return escape(text)

    def cite(self, keys: Iterable[str]) -> str:
        numbers = [self.numbers.setdefault(key, len(self.numbers) + 1) for key in keys]
        return f" [{', '.join(map(str, numbers))}]"


_Form = _Markdown | _Latex | _Html


@dataclass(frozen=True)
class Printed:
    """The methods of a study as they are printed: paragraphs of HTML, and the numbered sources."""

    paragraphs: tuple[Markup, ...]
    references: tuple[str, ...]


def printed(study: Study) -> Printed:
    """Return what a print of the report says of the methods."""
    form = _Html()
    paragraphs = tuple(map(Markup, _text(study, form).strip().split("\n\n")))
    texts = {
        key: text
        for row in study.methods
        for key, text in zip(row.keys, row.citation.splitlines(), strict=False)
    }
    return Printed(paragraphs, tuple(texts.get(key, key) for key in form.numbers))


def _text(study: Study, form: _Form) -> str:
    if study.without_result and not study.methods:
        return "No step gave a result.\n"
    nodes = [list(rows) for _, rows in groupby(study.methods, key=lambda method: method.node)]
    shown = {part.node for part in study.sections if part.rendered.kind}
    single = [rows[0] for rows in nodes if len(rows) == 1]
    results = [row for row in single if row.node in shown and not row.declared]
    steps = [row for row in single if row not in results]
    paragraphs = [
        _design(study, steps, form),
        *(_compared(rows, form) for rows in nodes if len(rows) > 1),
        _comparisons([row for row in results if row.keys], form),
        _software(study, form),
    ]
    return "\n\n".join(filter(None, paragraphs)) + "\n"


def _design(study: Study, steps: Sequence[MethodRow], form: _Form) -> str:
    """Return what the study ran over, and the steps that neither are shown nor compare."""
    compared = {row.node for row in study.methods if row.label}
    axes = [
        f"{form.code(axis.name)} {form.plain(_labels(axis))}"
        for axis in study.axes
        if len(axis.labels) > 1 and axis.name not in compared
    ]
    texts = [_step(row, form) for row in steps]
    ran = f"The study ran over {_listed(axes)}." if axes else ""
    used = f"The steps were {_listed(list(dict.fromkeys(texts)))}." if texts else ""
    return " ".join(filter(None, [ran, used]))


def _compared(rows: Sequence[MethodRow], form: _Form) -> str:
    """Return the methods of one step: those as published, then those that differ, and how."""
    shared = _shared(rows)
    common = [setting for setting in rows[0].settings if setting.name in shared]
    at = _settings([setting for setting in common if not setting.default], form)
    each = f", each with {at}" if at else ""
    head = f"Step {form.code(rows[0].node)} compared {len(rows)} methods{each}"
    texts = {row: _method(row, shared, form) for row in rows}
    as_published = [texts[row] for row in rows if not _departure(row)]
    adapted = [f"{texts[row]} {form.plain(_departure(row))}" for row in rows if _departure(row)]
    parts = [", ".join(as_published), f"adapted: {'; '.join(adapted)}" if adapted else ""]
    return f"{head}: {'; '.join(filter(None, parts))}."


def _comparisons(steps: Sequence[MethodRow], form: _Form) -> str:
    """Return the sources of the steps that judge the results."""
    nodes: dict[MethodRow, list[str]] = {}
    for row in steps:
        first = next((known for known in nodes if known.use == row.use), row)
        nodes.setdefault(first, []).append(form.code(row.node))
    texts = [
        f"{form.code(row.use)}{form.cite(row.keys)} for {_listed(of)}" for row, of in nodes.items()
    ]
    return f"Results were compared by {_listed(texts)}." if texts else ""


def _software(study: Study, form: _Form) -> str:
    versions = dict(study.versions)
    libraries = ", ".join(f"{name} {versions[name]}" for name in _MACHINE if versions.get(name))
    end = f"All of it ran in nodegraph {versions.get('nodegraph', '')}".rstrip()
    rest = "settings that are not named had their defaults"
    return form.plain(f"{end} ({libraries}); {rest}.")


def _step(row: MethodRow, form: _Form) -> str:
    settings = row.settings if row.damages else _changed(row)
    details = _settings([setting for setting in settings if setting.name != "seed"], form)
    return f"{form.code(row.use)}{_source(row, form)}" + (f" ({details})" if details else "")


def _method(row: MethodRow, shared: Container[str], form: _Form) -> str:
    name = form.code(row.label)
    if row.label != row.use.rpartition(".")[2]:
        name = f"{name} ({form.code(row.use)})"
    own = _settings([setting for setting in _changed(row) if setting.name not in shared], form)
    return f"{name}{_source(row, form)}" + (f" with {own}" if own else "")


def _source(row: MethodRow, form: _Form) -> str:
    return form.cite(row.keys) if row.keys and row.citation else ""


def _settings(settings: Iterable[SettingRow], form: _Form) -> str:
    return ", ".join(
        f"{form.code(setting.name)} {form.plain(_with_unit(setting))}" for setting in settings
    )


def _with_unit(setting: SettingRow) -> str:
    value, unit = _printed(setting), setting.unit
    if value == "null":
        return "none"
    if value == "1" and len(unit) > 1:
        unit = unit.removesuffix("s")
    return f"{value} {unit}".rstrip()


def _changed(row: MethodRow) -> list[SettingRow]:
    return [setting for setting in row.settings if not setting.default]


def _departure(row: MethodRow) -> str:
    """Return what a method is adapted from, and what differs."""
    return next((text[8:] for text in row.declared if text.startswith("adapted ")), "")


def _shared(rows: Sequence[MethodRow]) -> frozenset[str]:
    """Return the names of the settings that all methods have with one value."""
    values = [{(setting.name, setting.value) for setting in row.settings} for row in rows]
    return frozenset(name for name, _ in frozenset.intersection(*map(frozenset, values)))


def _labels(axis: AxisRow) -> str:
    labels = axis.labels
    if len(labels) > _MOST_LABELS:
        labels = (*labels[:2], "...", labels[-1])
    shown = f"{', '.join(labels)} {axis.unit}".rstrip()
    return f"{len(axis.labels)} ({shown})"


def _listed(texts: Sequence[str]) -> str:
    return " and ".join(filter(None, [", ".join(texts[:-1]), *texts[-1:]]))


def _printed(setting: SettingRow) -> str:
    return setting.in_print or setting.value


def _rows(study: Study) -> Iterator[tuple[str, ...]]:
    for node, methods in groupby(study.methods, key=lambda method: method.node):
        rows = list(methods)
        shared = _shared(rows) if len(rows) > 1 else frozenset()
        for setting in rows[0].settings:
            if setting.name in shared:
                all_of_them = f"all {len(rows)} methods"
                yield node, all_of_them, setting.name, _printed(setting), setting.unit
        for row in rows:
            name = f"{row.use} ({row.label})" if row.label else row.use
            for text in row.declared:
                what, _, value = text.partition(" ")
                if what == "look-ahead":
                    yield node, name, what, value, ""
            for setting in row.settings:
                if setting.name not in shared:
                    yield node, name, setting.name, _printed(setting), setting.unit


def _markdown_table(study: Study) -> str:
    rows = (tuple(_WIDTHS), tuple("---" for _ in _WIDTHS), *_rows(study))
    lines = (" | ".join(text.replace("|", r"\|") for text in row) for row in rows)
    return "".join(f"| {line} |\n" for line in lines)


def _latex_table(study: Study) -> str:
    rows = [" & ".join(map(_latex_cell, row)) + r" \\" for row in _rows(study)]
    head = " & ".join(_WIDTHS) + r" \\"
    columns = "".join(
        rf">{{\raggedright\arraybackslash}}p{{{width}\linewidth}}" for width in _WIDTHS.values()
    )
    return "\n".join(
        [
            r"% needs \usepackage{array,booktabs,longtable}",
            r"{\footnotesize\setlength{\tabcolsep}{3pt}",
            rf"\begin{{longtable}}{{{columns}}}",
            rf"\toprule {head} \midrule",
            r"\endhead",
            *rows,
            r"\bottomrule",
            r"\end{longtable}}",
            "",
        ]
    )


def _latex_cell(text: str) -> str:
    """Return a text that may be broken within names and paths, too."""
    return re.sub(r"(\\_|/|\.(?=[a-z]))", r"\1\\allowbreak{}", text.translate(_LATEX))
