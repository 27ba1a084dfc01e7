"""What a paper says of a study holds what ran, and nothing that LaTeX or Markdown obeys."""

from __future__ import annotations

from pathlib import Path

from nodegraph.plugin.hook_types import Rendered
from nodegraph.report.paper_texts import cited
from nodegraph.report.study import AxisRow, MethodRow, Section, SettingRow, Study
from tests.latex import compiled, needs_latex

LENGTH = SettingRow("length", "5, 15", "frames", meaning="of the gaps")
DEFAULT = SettingRow("close_gap", "none", default=True)
MET = SettingRow("ends", "met")
STUDY = Study(
    "Which?",
    methods=(
        MethodRow("gaps", "gaps.cut", settings=(LENGTH, DEFAULT), damages=True),
        MethodRow("marked", "markers.infer", citation="Combes", keys=("combes",)),
        MethodRow(
            "fill",
            "fill.muscle",
            label="muscle",
            settings=(MET,),
            citation="Zhang",
            keys=("zhang", "waters"),
            declared=("as published",),
        ),
        MethodRow(
            "fill",
            "fill.lin_ouhyoung",
            label="lin|2",
            settings=(LENGTH, MET),
            declared=("as published", "look-ahead 0 frames"),
        ),
        MethodRow(
            "fill",
            "fill.waters",
            label="waters",
            settings=(DEFAULT, MET),
            declared=("adapted from Waters 1987: at another distance",),
        ),
        MethodRow("table", "compare.table", citation="Tukey", keys=("tukey",)),
        MethodRow("more", "compare.table", citation="Tukey", keys=("tukey",)),
        MethodRow("picture", "plot.faces"),
    ),
    axes=(
        AxisRow("length", ("5", "15"), "frames"),
        AxisRow("fill", ("muscle", "lin|2", "waters")),
        AxisRow("trial", ("0",)),
    ),
    sections=(
        Section("Faces", Rendered(html="", text="x", kind="figure"), node="picture"),
        Section("Errors", Rendered(html="", text="x", kind="table"), node="table"),
        Section("More", Rendered(html="", text="x", kind="table"), node="more"),
    ),
    bibtex="@article{zhang,}",
    versions=(("python", "3.11"), ("nodegraph", "0.1"), ("numpy", "2.4"), ("numba", "1")),
)


def test_paragraphs_name_methods_sources_and_what_differs_from_the_defaults() -> None:
    assert cited(STUDY)["methods.md"] == (
        "The study ran over `length` 2 (5, 15 frames). "
        "The steps were `gaps.cut` (`length` 5, 15 frames, `close_gap` none) and "
        "`markers.infer` [@combes].\n\n"
        "Step `fill` compared 3 methods, each with `ends` met: `muscle` [@zhang; @waters], "
        "`lin|2` (`fill.lin_ouhyoung`) with `length` 5, 15 frames; "
        "adapted: `waters` from Waters 1987: at another distance.\n\n"
        "Results were compared by `compare.table` [@tukey] for `table` and `more`.\n\n"
        "All of it ran in nodegraph 0.1 (python 3.11, numpy 2.4); settings that are not named had "
        "their defaults.\n"
    )


def test_the_same_in_latex() -> None:
    text = cited(STUDY)["methods.tex"]
    assert r"\texttt{muscle}~\cite{zhang,waters}, \texttt{lin|2} (" in text
    assert r"\texttt{fill.lin\_ouhyoung}" in text


def test_the_tables_hold_every_setting_with_its_unit() -> None:
    lines = cited(STUDY)["settings.md"].splitlines()
    assert lines[2:] == [
        "| gaps | gaps.cut | length | 5, 15 | frames |",
        "| gaps | gaps.cut | close_gap | none |  |",
        "| fill | all 3 methods | ends | met |  |",
        r"| fill | fill.lin_ouhyoung (lin\|2) | look-ahead | 0 frames |  |",
        r"| fill | fill.lin_ouhyoung (lin\|2) | length | 5, 15 | frames |",
        "| fill | fill.waters (waters) | close_gap | none |  |",
    ]
    latex = cited(STUDY)["settings.tex"].replace(r"\allowbreak{}", "")
    assert r"fill & fill.lin\_ouhyoung (lin|2) & length & 5, 15 & frames \\" in latex
    assert latex.count(r"\\") == 7


def test_signs_of_latex_are_shown_and_none_is_obeyed() -> None:
    name = r"\input{x} 100% a_b ~ ^ # $ & [z] <"
    study = Study("t", methods=(MethodRow("n", "u", settings=(SettingRow("s", name),)),))
    shown = r"\textbackslash{}input\{x\} 100\% a\_b \textasciitilde{} \textasciicircum{} \# \$ \&"
    for file in ("methods.tex", "settings.tex"):
        assert shown in cited(study)[file].replace(r"\allowbreak{}", "")


@needs_latex
def test_the_settings_fit_the_page(tmp_path: Path) -> None:
    values = ", ".join(f"folder/of_many/recording_{number}.c3d" for number in range(9))
    settings = (SettingRow("generalization_of_the_gap", values, "frames"),)
    method = MethodRow("node_of_a_long_name", "plugin.a_method_of_a_long_name", settings=settings)
    settings_table = cited(Study("t", methods=(method,)))["settings.tex"]
    log = compiled(tmp_path, "array,booktabs,longtable", settings_table)
    assert "Overfull" not in log


def test_a_study_without_methods_still_says_what_it_ran_in() -> None:
    texts = cited(Study("t"))
    assert texts["methods.md"].startswith("All of it ran in nodegraph ")
    assert texts["references.bib"] == ""
