"""Texts for a paper: a paragraph on the methods, a table of settings, the references."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby

from nodegraph.report.study import MethodRow, SettingRow, Study

_HEADS = ("node", "method", "setting", "value", "unit")
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


def cited(study: Study) -> Mapping[str, str]:
    """Return the texts of a study for a paper, by file name.

    Parameters
    ----------
    study

    Returns
    -------
    mapping of str to str
        ``methods.md`` and ``methods.tex``, a paragraph that names every method that gave a result,
        with what differs from its defaults; ``settings.md`` and ``settings.tex``, a table of all
        settings with units; ``references.bib``, the BibTeX of the methods.
    """
    return {
        "methods.md": _paragraph(study, _Markdown()),
        "settings.md": _markdown_table(study),
        "references.bib": study.bibtex,
        "methods.tex": _paragraph(study, _Latex()),
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


_Form = _Markdown | _Latex


def _paragraph(study: Study, form: _Form) -> str:
    if study.without_result and not study.methods:
        return "No step gave a result.\n"
    steps = (
        _step(node, list(methods), form)
        for node, methods in groupby(study.methods, key=lambda method: method.node)
    )
    versions = dict(study.versions)
    libraries = ", ".join(f"{name} {versions[name]}" for name in _MACHINE if versions.get(name))
    end = f"All of it ran in nodegraph {versions.get('nodegraph', '')}".rstrip()
    rest = "settings that are not named had their defaults"
    return " ".join([*steps, form.plain(f"{end} ({libraries}); {rest}.")]) + "\n"


def _step(node: str, methods: list[MethodRow], form: _Form) -> str:
    if len(methods) == 1:
        return f"Step {form.code(node)} used {_method(methods[0], form)}."
    several = "; ".join(_method(method, form) for method in methods)
    return f"Step {form.code(node)} compared {len(methods)} methods: {several}."


def _method(method: MethodRow, form: _Form) -> str:
    label = f"{form.code(method.label)}: " if method.label else ""
    settings = ", ".join(
        f"{form.code(setting.name)} {form.plain(f'{_printed(setting)} {setting.unit}'.rstrip())}"
        for setting in method.settings
        if not setting.default
    )
    source = form.cite(method.keys) if method.keys and method.citation else ""
    details = ", ".join([*map(form.plain, method.declared), *filter(None, [settings])])
    return f"{label}{form.code(method.use)}{source}" + (f" ({details})" if details else "")


def _printed(setting: SettingRow) -> str:
    return setting.in_print or setting.value


def _rows(study: Study) -> Iterator[tuple[str, ...]]:
    for method in study.methods:
        name = f"{method.use} ({method.label})" if method.label else method.use
        for setting in method.settings:
            yield method.node, name, setting.name, _printed(setting), setting.unit


def _markdown_table(study: Study) -> str:
    rows = (_HEADS, tuple("---" for _ in _HEADS), *_rows(study))
    lines = (" | ".join(text.replace("|", r"\|") for text in row) for row in rows)
    return "".join(f"| {line} |\n" for line in lines)


def _latex_table(study: Study) -> str:
    rows = [" & ".join(text.translate(_LATEX) for text in row) + r" \\" for row in _rows(study)]
    head = " & ".join(_HEADS) + r" \\"
    return "\n".join(
        [
            r"% needs \usepackage{booktabs} and \usepackage{longtable}",
            rf"\begin{{longtable}}{{{'l' * len(_HEADS)}}}",
            rf"\toprule {head} \midrule",
            r"\endhead",
            *rows,
            r"\bottomrule",
            r"\end{longtable}",
            "",
        ]
    )
