"""What a paper says of a study holds what ran, and nothing that LaTeX or Markdown obeys."""

from __future__ import annotations

from nodegraph.report import MethodRow, SettingRow, Study
from nodegraph.report.citing import cited

LENGTH = SettingRow("length", "5, 15", "frames", meaning="of the gaps")
DEFAULT = SettingRow("close_gap", "none", default=True)
STUDY = Study(
    "Which?",
    methods=(
        MethodRow("gaps", "gaps.cut", settings=(LENGTH, DEFAULT)),
        MethodRow(
            "fill", "fill.muscle", label="muscle", citation="Zhang", keys=("zhang", "waters")
        ),
        MethodRow(
            "fill",
            "fill.lin_ouhyoung",
            label="lin|2",
            settings=(LENGTH, DEFAULT),
            declared=("as published", "look-ahead 0 frames"),
        ),
    ),
    bibtex="@article{zhang,}",
    versions=(("python", "3.11"), ("nodegraph", "0.1"), ("numpy", "2.4"), ("numba", "1")),
)


def test_the_paragraph_names_methods_sources_and_what_differs_from_the_defaults() -> None:
    assert cited(STUDY)["methods.md"] == (
        "Step `gaps` used `gaps.cut` (`length` 5, 15 frames). "
        "Step `fill` compared 2 methods: `muscle`: `fill.muscle` [@zhang; @waters]; "
        "`lin|2`: `fill.lin_ouhyoung` (as published, look-ahead 0 frames, "
        "`length` 5, 15 frames). "
        "All of it ran in nodegraph 0.1 (python 3.11, numpy 2.4); settings that are not named had "
        "their defaults.\n"
    )


def test_the_same_in_latex() -> None:
    text = cited(STUDY)["methods.tex"]
    assert r"\texttt{fill.muscle}~\cite{zhang,waters}; \texttt{lin|2}: " in text
    assert r"\texttt{fill.lin\_ouhyoung}" in text


def test_the_tables_hold_every_setting_with_its_unit() -> None:
    lines = cited(STUDY)["settings.md"].splitlines()
    assert lines[2:] == [
        "| gaps | gaps.cut | length | 5, 15 | frames |",
        "| gaps | gaps.cut | close_gap | none |  |",
        r"| fill | fill.lin_ouhyoung (lin\|2) | length | 5, 15 | frames |",
        r"| fill | fill.lin_ouhyoung (lin\|2) | close_gap | none |  |",
    ]
    latex = cited(STUDY)["settings.tex"]
    assert r"fill & fill.lin\_ouhyoung (lin|2) & close\_gap & none &  \\" in latex
    assert latex.count(r"\\") == 5


def test_signs_of_latex_are_shown_and_none_is_obeyed() -> None:
    name = r"\input{x} 100% a_b ~ ^ # $ & [z] <"
    study = Study("t", methods=(MethodRow("n", "u", settings=(SettingRow("s", name),)),))
    shown = r"\textbackslash{}input\{x\} 100\% a\_b \textasciitilde{} \textasciicircum{} \# \$ \&"
    for file in ("methods.tex", "settings.tex"):
        assert shown in cited(study)[file]


def test_a_study_without_methods_still_says_what_it_ran_in() -> None:
    texts = cited(Study("t"))
    assert texts["methods.md"].startswith("All of it ran in nodegraph ")
    assert texts["references.bib"] == ""
