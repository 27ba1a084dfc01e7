"""What is said of a method holds of the combinations at which it gave a result."""

from __future__ import annotations

from collections.abc import Callable

from nodegraph import node
from nodegraph.execute.results import Run
from nodegraph.report.from_run import compose
from nodegraph.report.merge import merged
from nodegraph.report.methods import Methods
from nodegraph.report.study import WithoutResult

TEXT = """
    inputs: {start: 3}
    axes: {length: [1, 15], trial: {count: 2}}
    nodes:
      capture: {use: read.number, with: {start: $start}}
      gaps: {use: gaps.cut, in: capture, with: {length: $length, seed: $trial}}
      held: {use: fill.hold, in: gaps.gappy, with: {max_gap: $length}}
      fill: {in: gaps.gappy, alternatives: [fill.hold, strict.positive, strict.fails]}
      low: {use: strict.fails, in: {from: gaps.gappy, at: {length: 15}}}
      after: {use: fill.hold, in: low}
    skip: [{fill: hold}]
"""


@node("read.files")
def read_files(
    *, paths: tuple[str, ...] = (), by_name: dict[str, str] | None = None, folder: str = ""
) -> float:
    return float(len(paths) + len(by_name or {}) + len(folder))


def test_methods_are_those_with_a_result_and_the_others_are_counted(
    run_of: Callable[..., Run],
) -> None:
    methods = Methods(run_of(TEXT))
    assert [(method.node, method.label) for method in methods.rows()] == [
        ("capture", ""),
        ("gaps", ""),
        ("held", ""),
        ("fill", "positive"),
        ("fill", "fails"),
    ]
    assert methods.without_result() == (
        WithoutResult("fill", "fill.hold", "hold", "4 left out"),
        WithoutResult("low", "strict.fails", "", "2 failed"),
        WithoutResult("after", "fill.hold", "", "2 left out"),
    )
    assert str(methods.without_result()[0]) == "fill=hold (fill.hold): 4 left out"


def test_settings_and_seeds_are_those_with_a_result(run_of: Callable[..., Run]) -> None:
    text = TEXT.replace("gaps.gappy, with: {max_gap: $length}", "strict, with: {max_gap: $length}")
    strict = "      strict: {use: strict.positive, in: gaps.gappy}\n"
    methods = Methods(run_of(text.replace("      held:", f"{strict}      held:")))
    (held,) = [method for method in methods.rows() if method.node == "held"]
    assert [(setting.name, setting.value) for setting in held.settings] == [("max_gap", "1")]
    assert methods.seeds() == (("gaps", "0, 1"),)


def test_a_combination_that_another_step_stands_for_has_its_result(
    run_of: Callable[..., Run],
) -> None:
    run = run_of("nodes: {a: {use: read.number}, b: {use: read.number}}")
    assert len(run.plan.steps) == 1
    assert [method.node for method in Methods(run).rows()] == ["a", "b"]


def test_in_print_files_have_their_names_alone(run_of: Callable[..., Run]) -> None:
    paths = "[/some/where/one.c3d, 'C:\\far away\\two.c3d', near/three.c3d, '1/s']"
    more = "by_name: {one: /some/where/one.c3d}, folder: /"
    text = f"nodes: {{a: {{use: read.files, with: {{paths: {paths}, {more}}}}}}}"
    (row,) = Methods(run_of(text, more=[read_files])).rows()
    files, named, folder = row.settings
    assert named.in_print == "{'one': 'one.c3d'}"
    assert files.value.startswith("[/some/where/one.c3d, ")
    assert files.in_print == "[one.c3d, two.c3d, near/three.c3d, 1/s]"
    assert folder.in_print == ""


def test_of_several_runs_each_says_what_gave_no_result(run_of: Callable[..., Run]) -> None:
    runs = {"one": run_of(TEXT), "two": run_of(TEXT, inputs={"start": 99})}
    both = merged({name: compose(run)[0] for name, run in runs.items()})
    assert [str(value) for value in both.without_result] == [
        "fill=hold (fill.hold): 4 left out (one)",
        "low (strict.fails): 2 failed (one)",
        "after (fill.hold): 2 left out (one)",
        "fill=hold (fill.hold): 4 left out (two)",
    ]


def test_what_a_method_declares_holds_for_its_settings(run_of: Callable[..., Run]) -> None:
    @node("toy.window", cite="one2001", lookahead=lambda settings: settings["reach"])
    def window(x: float, *, reach: int = 1) -> float:
        return x

    text = TEXT.replace(
        "skip:", "  wide: {use: toy.window, in: capture, with: {reach: $length}}\n    skip:"
    )
    rows = Methods(run_of(text, more=[window])).rows()
    assert {row.node: row.declared for row in rows if row.declared} == {
        "wide": ("as published", "look-ahead 1 frame or 15 frames")
    }
