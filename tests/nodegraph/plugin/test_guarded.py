"""Whatever of a plugin fails is told with plugin, hook and line, and is no mistake of ours."""

from __future__ import annotations

import json
import textwrap
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from nodegraph import NodegraphError
from nodegraph.cli.main import main
from nodegraph.plugin import loading
from nodegraph.plugin.guards import PluginError, Source, guarded, guarded_executor, guarded_place
from nodegraph.plugin.hook_types import Comparison, Conclusion, Rendered, Renderer, Storage

SOURCE = Source("bad", "nodegraph_things", "test_guarded")
OURS = Source("bad", "nodegraph_things", __name__.partition(".")[0])
Function = Callable[..., Any]


def fails(*given: Any) -> Any:
    raise RuntimeError("out of tune")


def fails_on_the_way(*given: Any) -> Iterator[str]:
    yield "one"
    raise RuntimeError("out of tune")


def five(*given: Any) -> Any:
    return 5


def gives_text(*given: Any) -> Any:
    return "<p>"


def conclusion(*, conclude: Function = five, numbers: Function = five) -> Conclusion:
    return guarded(Conclusion(int, conclude, numbers), OURS)


@pytest.mark.parametrize(
    ("function", "said"),
    [
        (fails, r"failed: RuntimeError: out of tune \(test_guarded.py:\d+\); it is left out"),
        (fails_on_the_way, r"failed: RuntimeError: out of tune \(test_guarded.py:\d+\)"),
        (five, "failed: it gave int where a list of sentences is due"),
        (lambda value: "a sentence", "failed: it gave str where a list of sentences is due"),
        (lambda value: [1, 2], "failed: it gave int where a text is due"),
        (lambda: ["too few arguments"], "failed: TypeError: .* takes 0 positional arguments"),
    ],
)
def test_a_conclusion_that_fails_is_told_and_concludes_nothing(
    function: Function, said: str
) -> None:
    whose = "plugin 'bad': the conclusion of int, from its hook nodegraph_things, "
    with pytest.warns(UserWarning, match=f"^{whose}{said}"):
        assert conclusion(conclude=function).conclude(1) == ()


def test_numbers_and_differences_that_fail_are_told_and_left_out() -> None:
    with pytest.warns(UserWarning, match="the numbers of int, .* it gave int where a text is due"):
        assert conclusion().numbers(1) == ""
    with pytest.warns(UserWarning, match="the comparison of int, .* RuntimeError: out of tune"):
        assert guarded(Comparison(int, fails), OURS).compare(1, 2) == ()


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (5, "it gave int where a mapping is due"),
        ({"speeds": ()}, "Held has no array 'speeds'"),
        ({5: ()}, "it gave int where a text is due"),
        ({"rows": (("row", ()), ("column", ()))}, "'rows' has 1 axes, and 2 are told"),
        ({"rows": (("row", ("a", "b")),)}, "of 'rows' it names 2 of 3: row"),
        ({"rows": ("row",)}, "ValueError"),
    ],
)
def test_parts_that_a_value_has_not_are_told_and_left_out(given: Any, said: str) -> None:
    class Held:
        rows = np.zeros(3)

    parts = guarded(Comparison(Held, five, lambda value: given), OURS).parts
    assert parts is not None
    with pytest.warns(UserWarning, match=f"the parts of Held, .* failed: {said}"):
        assert parts(Held()) == {}


def test_what_is_well_passes_as_it_is() -> None:
    class Held:
        rows = np.zeros(3)

    axes = {"rows": (("row", ("a", "b", "c")),)}
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        compared = guarded(Comparison(Held, lambda one, other: iter(["it"]), lambda _: axes), OURS)
        assert compared.compare(1, 2) == ("it",)
        assert compared.parts is not None
        assert compared.parts(Held()) == axes
        assert conclusion(numbers=str).numbers(1) == "1"
        shown = Rendered("<p>")
        assert guarded(Renderer(int, lambda value, title: shown), OURS).render(1, "") is shown
        assert guarded(Comparison(int, five), OURS).parts is None
        assert guarded("another thing", OURS) == "another thing"


@pytest.mark.parametrize(
    ("use", "said"),
    [
        (lambda: guarded(Renderer(int, fails), OURS).render(1, ""), "the rendering of int, .* out"),
        (
            lambda: guarded(Renderer(int, gives_text), OURS).render(1, ""),
            "the rendering of int, .* it gave str where a Rendered is due",
        ),
        (lambda: guarded(Storage(int, fails, int), OURS).take_apart(1), "the taking apart of int"),
        (
            lambda: guarded(Storage(int, int, str), OURS).put_together(1),
            "the putting together of int, .* it gave str where a int is due",
        ),
        (lambda: guarded_place("zz", fails, OURS)("a"), "what finds zz:..., .* out of tune"),
        (
            lambda: guarded_place("zz", five, OURS)("a"),
            "what finds zz:..., .* failed: it gave int where a path is due",
        ),
        (
            lambda: list(guarded_executor("zz", five, OURS)(None, None)),
            "executor 'zz', .* failed: it gave int where an iterator of steps",
        ),
        (
            lambda: list(guarded_executor("zz", fails_on_the_way, OURS)(None, None)),
            r"executor 'zz', .* failed: RuntimeError: out of tune \(test_guarded.py:\d+\)",
        ),
    ],
)
def test_what_nobody_can_go_on_without_raises_with_its_plugin(
    use: Callable[[], object], said: str
) -> None:
    with pytest.raises(PluginError, match=f"^plugin 'bad': {said}"):
        use()


def test_a_stand_in_may_be_of_another_type() -> None:
    kept = guarded(Storage(int, str, str, faithful=False), OURS)
    assert kept.put_together("1") == "1"


def test_a_plugin_s_own_words_pass() -> None:
    def finds(name: str) -> Path:
        raise NodegraphError(f"no sample {name!r}; there is face")

    with pytest.raises(NodegraphError, match=r"^no sample 'fase'; there is face$"):
        guarded_place("sample", finds, SOURCE)("fase")


def test_an_executor_that_is_closed_gives_up_what_runs() -> None:
    closed = []

    def steps(schedule: Any, how: Any) -> Iterator[int]:
        try:
            yield 1
            yield 2
        finally:
            closed.append(True)

    running = guarded_executor("zz", steps, OURS)(None, None)
    assert next(running) == 1
    running.close()
    assert closed == [True]


NODES = """
from nodegraph import InputFile, hookimpl, node
from nodegraph.plugin.hooks import Comparison, Conclusion, Renderer, Storage


def fails(*given):
    raise RuntimeError("out of tune")


@node("bad.number")
def number(*, start: float = 1.0) -> float:
    '''Give a number.'''
    return start


@node("bad.file")
def file(*, path: InputFile) -> float:
    '''Read a number.'''
    return 1.0


@hookimpl
def nodegraph_nodes():
    return [number, file]


@hookimpl
def {hook}():
    return {returned}
"""
GRAPH = """
nodegraph: 1
title: A number
nodes: {a: {use: bad.number}}
report: [a]
"""
READS_A_FILE = "nodegraph: 1\nnodes: {a: {use: bad.file, with: {path: 'zz:a'}}}\n"


@pytest.fixture
def command(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., tuple[int, str]]:
    """Give a command beside a plugin with a bad hook, and return its status and what it said."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(loading, "installed", lambda: ([], []))
    (tmp_path / "graph.yaml").write_text(GRAPH)

    def call(*words: str, hook: str, returned: str) -> tuple[int, str]:
        text = NODES.replace("{hook}", hook).replace("{returned}", returned)
        Path("bad_hook.py").write_text(textwrap.dedent(text))
        status = main([*words, "--plugin", "bad_hook.py"])
        said = capsys.readouterr()
        assert "mistake of the program" not in said.err
        return status, said.err

    return call


CONCLUSIONS = {
    "raises": "[Conclusion(float, fails, repr)]",
    "gives a number": "[Conclusion(float, int, repr)]",
    "of a text": "[Conclusion('float', fails, repr)]",
    "of nothing": "[None]",
}


@pytest.mark.parametrize("name", CONCLUSIONS)
def test_a_study_is_locked_and_verified_though_a_conclusion_fails(
    command: Callable[..., tuple[int, str]], name: str
) -> None:
    bad = {"hook": "nodegraph_conclusions", "returned": CONCLUSIONS[name]}
    status, said = command("lock", "graph.yaml", **bad)
    assert (status, "plugin 'bad_hook': " in said, "left out" in said) == (0, True, True)
    assert Path("graph.lock").is_file()
    assert command("verify", "graph.lock", **bad)[0] == 0


@pytest.mark.parametrize(
    "returned", ["[Comparison(float, fails, fails)]", "[Comparison(float, int, int)]"]
)
def test_a_study_is_locked_verified_and_compared_though_a_comparison_fails(
    command: Callable[..., tuple[int, str]], returned: str
) -> None:
    bad = {"hook": "nodegraph_comparisons", "returned": returned}
    status, said = command("lock", "graph.yaml", **bad)
    assert (status, "plugin 'bad_hook': the parts of float" in said) == (0, True)
    assert command("verify", "graph.lock", **bad)[0] == 0
    assert command("run", "graph.yaml", "--out", "one", **bad)[0] == 0
    graph = Path("graph.yaml")
    graph.write_text(graph.read_text().replace("bad.number}", "bad.number, with: {start: 2}}"))
    assert command("run", "graph.yaml", "--out", "other", **bad)[0] == 0
    status, said = command("diff", "one", "other", **bad)
    assert (status, "plugin 'bad_hook': the comparison of float" in said) == (1, True)


@pytest.mark.parametrize("returned", ["[Renderer(float, fails)]", "[Renderer(float, repr)]"])
def test_a_run_has_all_its_files_though_a_rendering_fails(
    command: Callable[..., tuple[int, str]], returned: str
) -> None:
    bad = {"hook": "nodegraph_renderers", "returned": returned}
    status, said = command("run", "graph.yaml", "--out", "run", **bad)
    assert (status, "plugin 'bad_hook': the rendering of float" in said) == (1, True)
    assert json.loads(Path("run/run.json").read_text())["steps"][0]["state"] == "done"
    assert "the rendering of float" in Path("run/report.html").read_text()
    status, said = command("export", "run", "a", "--out", "a.csv", **bad)
    assert (status, "plugin 'bad_hook': the rendering of float" in said) == (2, True)


@pytest.mark.parametrize(
    "returned", ["[Storage(float, fails, fails)]", "[Storage(float, str, str)]"]
)
def test_a_run_goes_on_though_a_storage_fails(
    command: Callable[..., tuple[int, str]], returned: str
) -> None:
    bad = {"hook": "nodegraph_storages", "returned": returned}
    for _ in range(2):
        assert command("run", "graph.yaml", "--out", "run", **bad)[0] == 0
    assert command("lock", "graph.yaml", **bad)[0] == 0


def test_of_a_value_that_cannot_be_lent_a_copy_is(
    command: Callable[..., tuple[int, str]],
) -> None:
    value = [1.0]
    lend = guarded(Storage(list, list, list, lend=repr), OURS).lend
    assert lend is not None
    with pytest.warns(UserWarning, match="the lending of list, .*; a copy is lent$"):
        lent = lend(value)
    assert lent == value
    assert lent is not value
    bad = {"hook": "nodegraph_storages", "returned": "[Storage(float, float, float, lend=repr)]"}
    status, said = command("run", "graph.yaml", "--out", "run", **bad)
    assert (status, "plugin 'bad_hook': the lending of float" in said) == (0, True)
    assert Path("run/run.json").is_file()


@pytest.mark.parametrize(
    ("hook", "returned", "words", "told"),
    [
        (
            "executors",
            "{'zz': 4}",
            ["run", "graph.yaml", "--executor", "zz"],
            "4 is not a function",
        ),
        (
            "executors",
            "{'zz': lambda schedule, how: 4}",
            ["run", "graph.yaml", "--executor", "zz"],
            "plugin 'bad_hook': executor 'zz', from its hook nodegraph_executors, failed: it gave",
        ),
        (
            "executors",
            "{'zz': lambda schedule, how: [4]}",
            ["run", "graph.yaml", "--executor", "zz"],
            "executor 'zz' gave 4 where the index of a step and its outcome are due",
        ),
        (
            "executors",
            "{'zz': lambda schedule, how: []}",
            ["run", "graph.yaml", "--executor", "zz"],
            "executor 'zz' ended with 1 of 1 steps left to compute",
        ),
        ("executors", "{'zz': fails}", ["run", "graph.yaml", "--executor", "zz"], "out of tune"),
        (
            "templates",
            "{'t2': 3}",
            ["new", "t2", "mine"],
            "'t2' of nodegraph_templates is left out",
        ),
        (
            "templates",
            "{'t2': __import__('pathlib').Path('nowhere')}",
            ["new", "t2", "mine"],
            "nowhere: the template 't2' of a plugin has no files",
        ),
    ],
)
def test_a_command_that_needs_what_a_plugin_does_not_have_says_whose_it_is(
    command: Callable[..., tuple[int, str]], hook: str, returned: str, words: list[str], told: str
) -> None:
    status, said = command(*words, hook=f"nodegraph_{hook}", returned=returned)
    assert (status, told in said) == (2, True), said


@pytest.mark.parametrize(
    ("returned", "told"),
    [
        ("{'zz': 4}", "'zz' of nodegraph_places is left out: 4 is not a function"),
        ("{'zz': fails}", "plugin 'bad_hook': what finds zz:..., from its hook nodegraph_places"),
        ("{'zz': len}", "failed: it gave int where a path is due"),
    ],
)
def test_a_path_whose_scheme_fails_is_a_mistake_at_its_line(
    command: Callable[..., tuple[int, str]], returned: str, told: str
) -> None:
    Path("graph.yaml").write_text(READS_A_FILE)
    status, said = command("check", "graph.yaml", hook="nodegraph_places", returned=returned)
    assert (status, told in said, "graph.yaml:2" in said) == (2, True, True), said
