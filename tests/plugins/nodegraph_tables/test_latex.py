"""Tables for a paper: methods by groups, marked as the comparison marks them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from nodegraph_tables import TableInfo, info_of, with_info
from nodegraph_tables.latex import latex_of
from nodegraph_tables.write_tex import write_tex
from tests.latex import compiled, needs_latex

UGLY = '<b>&amp; "it\'s" 100 % #1_$x^2 {~} \\ [mm] *12 \N{MINUS SIGN}1'
LENGTHS = (5, 15, 45)


def comparison(
    ends: Sequence[str] = ("as_published", "met"),
    lengths: Sequence[int] = LENGTHS,
    fills: Sequence[str] = ("ridge", "linear", "waters"),
    *,
    times: float = 1.0,
    marked: bool = True,
) -> pd.DataFrame:
    """Return a table with a row per group and method, the best of each group first."""
    rows = [
        (end, length, fill, times * length * (place + 1.0) / 10.0)
        for end in ends
        for length in lengths
        for place, fill in enumerate(fills)
    ]
    table = pd.DataFrame(rows, columns=["ends", "length", "fill", "mean"])
    table["low"], table["high"] = 0.9 * table["mean"], 1.2 * table["mean"]
    table["blocks"] = 8
    first, count = range(0, len(rows), len(fills)), len(rows)
    info = TableInfo(
        title="Mean rmse over faces",
        labels=("ends", "length", "fill"),
        compared="fill",
        units={"mean": "mm"},
        best={"mean": tuple(first) if marked else ()},
        tied={"mean": tuple(at + 1 for at in first if at + 1 < count) if marked else ()},
        cells={"mean": {"low": "low", "high": "high"}},
    )
    return with_info(table, info)


def wide(rows: int) -> pd.DataFrame:
    """Return a table of twelve columns that are wider than a page together."""
    return pd.DataFrame({f"measurement_{at}": [0.5 + at] * rows for at in range(11)} | {"x": "y"})


def body(latex: str) -> list[list[str]]:
    """Return the cells of a table, its head first."""
    inside = latex.partition(r"\toprule")[2].partition(r"\bottomrule")[0]
    rules = r"\midrule", r"\cmidrule", r"\addlinespace"
    lines = [line for line in inside.strip().splitlines() if not line.startswith(rules)]
    rows = [line.removesuffix("[2pt]").removesuffix(r"\\") for line in lines]
    return [[cell.strip() for cell in row.split("&")] for row in rows]


def caption(latex: str) -> str:
    return latex.partition(r"\caption{")[2].partition("}\n")[0]


def test_methods_stand_down_the_side_and_groups_along_the_top() -> None:
    latex = latex_of(comparison(), "Errors")
    assert body(latex)[:4] == [
        ["", r"\multicolumn{3}{c}{as\_published}", r"\multicolumn{3}{c}{met}"],
        ["fill", *[f"length {length}" for length in LENGTHS] * 2],
        ["ridge", *[rf"\textbf{{{mean}}}" for mean in ("0.50", "1.50", "4.50")] * 2],
        ["", *[rf"\scriptsize {{[}}{both}]" for both in ("0.45, 0.60", "1.35, 1.80", "4.05, 5.40")]
         * 2],
    ]  # fmt: skip
    assert body(latex)[4][:2] == ["linear", r"\textit{1.00}"]
    assert body(latex)[6][:2] == ["waters", "1.50"]
    assert r"\cmidrule(lr){2-4} \cmidrule(lr){5-7}" in latex
    assert caption(latex) == (
        r"Errors. Mean rmse over faces {[}mm]. In brackets: 95 \% intervals; bold: the best; "
        "italic: may be the best."
    )


def test_without_a_verdict_nothing_is_marked() -> None:
    latex = latex_of(comparison(marked=False), "Errors")
    assert r"\textbf" not in latex
    assert r"\textit" not in latex
    assert caption(latex).endswith(r"In brackets: 95 \% intervals.")


def test_intervals_stand_beside_the_means_where_there_is_room() -> None:
    latex = latex_of(comparison(ends=["met"], lengths=[5, 15]), "Errors")
    assert r"\begin{tabular}{lr@{\ }lr@{\ }l}" in latex
    assert body(latex)[:2] == [
        ["fill", r"\multicolumn{2}{c}{length 5}", r"\multicolumn{2}{c}{length 15}"],
        ["ridge", r"\textbf{0.50}", "{[}0.45, 0.60]", r"\textbf{1.50}", "{[}1.35, 1.80]"],
    ]
    assert "ends is met throughout." in caption(latex)


def test_outer_groups_stand_down_the_side_where_there_are_too_many_columns() -> None:
    latex = latex_of(comparison(lengths=[5, 15, 30, 45]), "Errors")
    head, *rows = body(latex)
    assert head == ["ends", "fill", "length 5", "length 15", "length 30", "length 45"]
    assert [row[:2] for row in rows[::2]] == [
        [r"as\_published", "ridge"], ["", "linear"], ["", "waters"],
        ["met", "ridge"], ["", "linear"], ["", "waters"],
    ]  # fmt: skip
    assert latex.count(r"\addlinespace") == 1


@pytest.mark.parametrize(
    ("rows", "columns", "head"),
    [
        (["fill"], ["length"], ["fill", "ends", *(f"length {length}" for length in LENGTHS)]),
        (["length"], ["fill"], ["length", "ends", "ridge", "linear", "waters"]),
        ([], ["ends"], ["length", "fill", r"as\_published", "met"]),
    ],
)
def test_rows_and_columns_are_chosen(rows: list[str], columns: list[str], head: list[str]) -> None:
    latex = latex_of(comparison(), "Errors", rows, columns)
    cells = [cell.removeprefix(r"\multicolumn{2}{c}{").rstrip("}") for cell in body(latex)[0]]
    assert cells == head
    assert write_tex(comparison(), rows=tuple(rows), columns=tuple(columns), name="t").content == {
        "t.tex": latex_of(comparison(), "Mean rmse over faces", rows, columns).encode()
    }


@pytest.mark.parametrize(
    ("table", "rows", "reason"),
    [
        (comparison(), ["lengh"], "no label 'lengh'; there is: ends, length, fill"),
        (comparison(), ["fill", "fill"], "'fill' is named twice"),
        (pd.DataFrame({"a": [1.0]}), ["a"], "a row for each group and method"),
    ],
)
def test_a_layout_that_is_not_possible_is_an_error(
    table: pd.DataFrame, rows: list[str], reason: str
) -> None:
    with pytest.raises(ValueError, match=reason):
        latex_of(table, "Errors", rows)


def test_the_numbers_of_a_table_have_the_same_decimals_and_small_ones_a_power_in_the_caption() -> (
    None
):
    latex = latex_of(comparison(times=1e-4), "Errors")
    assert r"{[}10\textsuperscript{$-$}\textsuperscript{3} mm]" in caption(latex)
    assert [row[1] for row in body(latex)[2::2]] == [r"\textbf{0.050}", r"\textit{0.100}", "0.150"]
    table = with_info(
        pd.DataFrame({"step": ["a", "b", "c"], "mean": [213.0, 12.5, -2e-31]}),
        TableInfo(labels=("step",), best={"mean": ()}),
    )
    assert body(latex_of(table, "t")) == [
        ["step", "mean"],
        ["a", "213.0"],
        ["b", "12.5"],
        ["c", "0.0"],
    ]


def test_over_all_groups_stands_last_and_a_method_that_a_group_lacks_has_an_empty_cell() -> None:
    table = pd.DataFrame(
        {
            "length": pd.array([5, 5, 15, None, None], dtype="Int64"),
            "fill": ["a", "b", "a", "a", "b"],
            "mean": [0.5, 0.75, 1.25, 0.9, 1.1],
        }
    )
    info = TableInfo(labels=("length", "fill"), best={"mean": (0,)}, overall=(3, 4))
    assert body(latex_of(with_info(table, info), "t")) == [
        ["fill", "length 5", "length 15", "all"],
        ["a", r"\textbf{0.500}", "1.250", "0.900"],
        ["b", "0.750", "", "1.100"],
    ]


def test_over_all_groups_is_left_out_where_groups_are_down_the_side_and_along_the_top() -> None:
    table = comparison()
    rows = table.iloc[:3].assign(ends=None, length=np.nan, mean=[0.7, 0.8, 0.9])
    whole = pd.concat([pd.DataFrame(table), pd.DataFrame(rows)], ignore_index=True)
    info = replace(info_of(table), overall=(18, 19, 20))
    whole = with_info(whole.astype({"length": "Int64"}), info)
    assert [row[-1] for row in body(latex_of(whole, "t"))[:3]] == ["", "all", "0.70"]
    chosen = latex_of(whole, "t", ["ends", "fill"], ["length"])
    assert body(chosen)[0] == ["ends", "fill", *(f"length {length}" for length in LENGTHS)]
    assert "0.70" not in chosen


def test_a_column_of_text_that_is_the_same_throughout_stands_in_the_caption() -> None:
    table = pd.DataFrame({"marker": ["lip", "jaw"], "rmse": [0.5, -1.5], "rule": ["mid", "mid"]})
    latex = latex_of(table, "Errors of markers")
    assert body(latex) == [["marker", "rmse"], ["lip", "0.500"], ["jaw", "$-$1.500"]]
    assert caption(latex) == "Errors of markers. rule is mid throughout."


def test_long_heads_stand_in_lines_no_longer_than_the_cells() -> None:
    table = pd.DataFrame({"marker": ["left lip", "jaw"], "largest error of any": [0.5, 1.25]})
    latex = latex_of(with_info(table, TableInfo(units={"largest error of any": "mm^2"})), "t")
    head = r"\shortstack[r]{largest\\error\\of any\\{[}mm\textsuperscript{2}]}"
    assert body(latex)[0] == ["marker", head]


@pytest.mark.parametrize(
    ("rows", "environment"), [(4, "sidewaystable"), (60, "table")], ids=["few", "many"]
)
def test_a_table_far_wider_than_the_page_stands_sideways_where_its_rows_fit(
    rows: int, environment: str
) -> None:
    latex = latex_of(wide(rows), "Errors")
    assert latex.splitlines()[1] == rf"\begin{{{environment}}}"
    assert latex.splitlines()[-1] == rf"\end{{{environment}}}"
    assert ("rotating" in latex.splitlines()[0]) == (environment == "sidewaystable")


@needs_latex
def test_tables_compile(tmp_path: Path) -> None:
    ugly = comparison(ends=[UGLY, "*", "[x]"], fills=[UGLY, "[a]", "*b"])
    with_p = pd.DataFrame({"fill": ["a", "b"], "x": [0.5, 2e7], "p": [0.01, np.nan]})
    tables = [
        comparison(),
        comparison(marked=False),
        comparison(lengths=[5, 15, 30, 45], times=1e-9),
        comparison(ends=["met"], lengths=[5]),
        ugly,
        with_info(ugly, replace(info_of(ugly), best={})),
        with_info(with_p, TableInfo(best={"x": (0,)}, cells={"x": {"p": "p"}})),
        with_info(with_p, TableInfo(units={"p": "chance", "x": "mm^2"})),
        pd.DataFrame({"name": pd.Series(dtype=str), "x": pd.Series(dtype=float)}),
        wide(4),
        wide(40),
        wide(90),
    ]
    text = "\n".join(latex_of(table, f"{UGLY}\n\nagain") for table in tables)
    log = compiled(tmp_path, "booktabs,graphicx,rotating", text)
    assert "Overfull" not in log
    assert "Float too large" not in log
    assert (tmp_path / "paper.pdf").stat().st_size > 10_000
