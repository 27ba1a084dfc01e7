"""What plugins return from their hooks; what fails is named with plugin, hook and line."""

from __future__ import annotations

import re
import sys
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from nodegraph import (
    Comparison,
    Conclusion,
    NodegraphError,
    Rendered,
    Renderer,
    RunningNumbers,
    Storage,
    node,
)
from nodegraph.plugin.guards import PluginError
from nodegraph.plugin.registry import Registry

Install = Callable[..., Registry]
LINE = r"\(test_hook_results\.py:\d+\)"


@node("fill.hold")
def hold(x: float) -> float:
    return x


def fails(*arguments: object) -> Any:
    raise RuntimeError("out of tune")


def fails_later(*arguments: object) -> Iterator[object]:
    yield "one"
    raise RuntimeError("out of tune")


def five(*arguments: object) -> Any:
    return 5


def text(*arguments: object) -> Any:
    return "<p>"


def test_the_results_of_all_plugins_are_put_together(install: Install, tmp_path: Path) -> None:
    hooks = install(
        one={"bibtex": "@misc{a}", "places": {"sample": lambda name: tmp_path / name}},
        two={
            "bibtex": "@misc{b}",
            "graphs": [Path("x/fill.yaml")],
            "renderers": [Renderer(float, lambda value, title: Rendered(title))],
        },
    ).hooks
    assert set(hooks.bibtex) == {"@misc{a}", "@misc{b}"}
    assert hooks.graphs == {"fill": Path("x/fill.yaml")}
    assert [renderer.type for renderer in hooks.renderers] == [float, RunningNumbers]
    assert hooks.place("sample:face") == tmp_path / "face"
    assert hooks.place("other:face") is None
    assert hooks.place("face.c3d") is None


@pytest.mark.parametrize(
    ("hook", "result", "reason"),
    [
        ("bibtex", fails, f"its hook nodegraph_bibtex .*RuntimeError: out of tune {LINE}"),
        ("graphs", fails_later, f"its hook nodegraph_graphs .*RuntimeError: out of tune {LINE}"),
        ("renderers", lambda: sys.exit("enough"), "its hook nodegraph_renderers .*SystemExit"),
        ("templates", ["plugin"], "its hook nodegraph_templates .*expected Mapping, got list"),
        ("graphs", "lips.yaml", "its hook nodegraph_graphs .*expected Iterable, got str"),
        ("bibtex", ["@misc{a}"], "its hook nodegraph_bibtex .*expected str, got list"),
        ("renderers", [float], "item 0 of nodegraph_renderers .*expected Renderer, got type"),
        (
            "renderers",
            lambda: [Renderer("float", text)],  # type: ignore[arg-type]
            f"its hook nodegraph_renderers .*Renderer.type: expected type, got str {LINE}",
        ),
        ("templates", {"mine": 3}, "'mine' of nodegraph_templates .*expected Path, got int"),
        ("templates", {7: Path("mine")}, "7 of nodegraph_templates .*expected str, got int"),
        ("bibtex", lambda style: style, "each of its hooks is left out"),
        ("bibtext", "@misc{a}", "nodegraph_bibtext is left out: .*'nodegraph_bibtex'"),
    ],
)
def test_a_hook_that_fails_is_named_and_the_rest_goes_on(
    install: Install, hook: str, result: object, reason: str
) -> None:
    good = {
        "nodes": [hold],
        "bibtex": "@misc{b}",
        "renderers": [Renderer(float, text)],
        "graphs": [Path("x/fill.yaml")],
        "templates": {"lips": Path("lips")},
    }
    registry = install(bad={"nodes": [hold], hook: result}, good=good)
    hooks = registry.hooks
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert hooks.bibtex == ("@misc{b}",)
        assert [renderer.type for renderer in hooks.renderers] == [float, RunningNumbers]
        assert hooks.graphs == {"fill": Path("x/fill.yaml")}
        assert hooks.templates == {"lips": Path("lips")}
    (warning,) = caught
    assert re.match(f"plugin 'bad': {reason}", str(warning.message))
    assert len(list(registry)) == 2


def test_of_two_plugins_with_one_name_the_first_keeps_it(install: Install, tmp_path: Path) -> None:
    def places(folder: str) -> Mapping[str, Callable[[str], Path]]:
        return {"sample": lambda name: tmp_path / folder / name}

    hooks = install(one={"places": places("one")}, two={"places": places("two")}).hooks
    with pytest.warns(UserWarning, match="plugin 'two': 'sample' of nodegraph_places .*'one'"):
        assert hooks.place("sample:face") == tmp_path / "one" / "face"


@pytest.mark.parametrize(
    ("conclude", "reason"),
    [
        (fails, f"RuntimeError: out of tune {LINE}; it is left out"),
        (fails_later, f"RuntimeError: out of tune {LINE}"),
        (five, "expected Iterable, got int"),
        (lambda value: "a sentence", "expected Iterable, got str"),
        (lambda value: [1, 2], "expected str, got int"),
        (lambda: ["too few arguments"], "TypeError: .* takes 0 positional arguments"),
    ],
)
def test_a_conclusion_that_fails_concludes_nothing(
    install: Install, conclude: Callable[..., Any], reason: str
) -> None:
    (conclusion,) = install(
        bad={"conclusions": [Conclusion(int, conclude, five)]}
    ).hooks.conclusions
    whose = "plugin 'bad': the conclusion of int, from hook nodegraph_conclusions, failed: "
    with pytest.warns(UserWarning, match=f"^{whose}.*{reason}"):
        assert conclusion.conclude(1) == ()
    with pytest.warns(UserWarning, match="'bad': the numbers of int, .*expected str, got int"):
        assert conclusion.numbers(1) == ""


def test_a_comparison_that_fails_finds_no_difference(install: Install) -> None:
    (comparison,) = install(bad={"comparisons": [Comparison(int, fails)]}).hooks.comparisons
    with pytest.warns(UserWarning, match=f"'bad': the comparison of int, .*out of tune {LINE}"):
        assert comparison.compare(1, 2) == ()


def test_what_works_passes_unchanged(install: Install) -> None:
    rendered = Rendered("<p>")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        hooks = install(
            good={
                "comparisons": [Comparison(int, lambda first, second: iter(["it"]))],
                "conclusions": [Conclusion(int, lambda value: ["it"], str)],
                "renderers": [Renderer(int, lambda value, title: rendered)],
                "storages": [Storage(int, str, str, faithful=False)],
            }
        ).hooks
        assert hooks.comparisons[0].compare(1, 2) == ("it",)
        assert hooks.conclusions[0].conclude(1) == ("it",)
        assert hooks.conclusions[0].numbers(1) == "1"
        assert hooks.renderers[0].render(1, "") is rendered
        assert hooks.storages[0].put_together("1") == "1"  # a stand-in may be of any type


@pytest.mark.parametrize(
    ("hook", "result", "use", "reason"),
    [
        (
            "renderers",
            [Renderer(int, fails)],
            lambda hooks: hooks.renderers[0].render(1, ""),
            f"the renderer of int, .*RuntimeError: out of tune {LINE}",
        ),
        (
            "renderers",
            [Renderer(int, text)],
            lambda hooks: hooks.renderers[0].render(1, ""),
            "the renderer of int, .*expected Rendered, got str",
        ),
        (
            "storages",
            [Storage(int, fails, int)],
            lambda hooks: hooks.storages[0].take_apart(1),
            f"take_apart of int, .*out of tune {LINE}",
        ),
        (
            "storages",
            [Storage(int, int, str)],
            lambda hooks: hooks.storages[0].put_together(1),
            "put_together of int, .*expected int, got str",
        ),
        ("places", {"zz": fails}, lambda hooks: hooks.place("zz:a"), "the place zz:.*out of tune"),
        (
            "places",
            {"zz": five},
            lambda hooks: hooks.place("zz:a"),
            "the place zz:.*expected Path, got int",
        ),
        (
            "executors",
            {"zz": five},
            lambda hooks: list(hooks.executors["zz"](None, None)),
            "executor 'zz', .*'int' object is not iterable",
        ),
        (
            "executors",
            {"zz": fails_later},
            lambda hooks: list(hooks.executors["zz"](None, None)),
            f"executor 'zz', .*RuntimeError: out of tune {LINE}",
        ),
    ],
)
def test_a_failure_that_nothing_can_stand_in_for_is_raised(
    install: Install, hook: str, result: object, use: Callable[[Any], object], reason: str
) -> None:
    hooks = install(bad={hook: result}).hooks
    with pytest.raises(PluginError, match=f"^plugin 'bad': {reason}"):
        use(hooks)


def test_a_message_that_a_plugin_wrote_for_its_users_passes(install: Install) -> None:
    def find(name: str) -> Path:
        raise NodegraphError(f"no sample {name!r}; there is face")

    with pytest.raises(NodegraphError, match=r"^no sample 'fase'; there is face$"):
        install(good={"places": {"sample": find}}).hooks.place("sample:fase")


def test_an_executor_that_is_closed_closes_the_plugin_s(install: Install) -> None:
    closed = []

    def steps(schedule: object, how: object) -> Iterator[int]:
        try:
            yield 1
            yield 2
        finally:
            closed.append(True)

    running: Any = install(good={"executors": {"zz": steps}}).hooks.executors["zz"](None, None)
    assert next(running) == 1
    running.close()
    assert closed == [True]


def test_a_value_that_cannot_be_lent_is_copied(install: Install) -> None:
    bad = {"storages": [Storage(list, list, list, lend=repr)]}
    (storage,) = install(bad=bad).hooks.storages
    assert storage.lend is not None
    value = [1.0]
    with pytest.warns(UserWarning, match="'bad': lend of list, .*a copy is lent$"):
        lent = storage.lend(value)
    assert lent == value
    assert lent is not value
