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
    Detail,
    Kind,
    NodegraphError,
    Rendered,
    RunningNumbers,
    Streamable,
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


def kind_of(install: Install, of: type = int, **fields: Any) -> Kind:
    """Return what a plugin knows of a type, guarded."""
    return install(bad={"kinds": [Kind(of, **fields)]}).hooks.kinds[0]


def test_the_results_of_all_plugins_are_put_together(install: Install, tmp_path: Path) -> None:
    hooks = install(
        one={"bibtex": "@misc{a}", "places": {"sample": lambda name: tmp_path / name}},
        two={
            "bibtex": "@misc{b}",
            "graphs": [Path("x/fill.yaml")],
            "kinds": [Kind(float, lambda value, title: Rendered(title))],
        },
    ).hooks
    assert set(hooks.of("bibtex")) == {"@misc{a}", "@misc{b}"}
    assert hooks.graphs == {"fill": Path("x/fill.yaml")}
    assert [kind.type for kind in hooks.kinds] == [float, RunningNumbers]
    assert hooks.place("sample:face") == tmp_path / "face"
    assert hooks.place("other:face") is None
    assert hooks.place("face.c3d") is None


@pytest.mark.parametrize(
    ("hook", "result", "reason"),
    [
        ("bibtex", fails, f"its hook nodegraph_bibtex .*RuntimeError: out of tune {LINE}"),
        ("graphs", fails_later, f"its hook nodegraph_graphs .*RuntimeError: out of tune {LINE}"),
        ("kinds", lambda: sys.exit("enough"), "its hook nodegraph_kinds .*SystemExit"),
        ("templates", ["plugin"], "its hook nodegraph_templates .*expected Mapping, got list"),
        ("graphs", "lips.yaml", "its hook nodegraph_graphs .*expected Iterable, got str"),
        ("bibtex", ["@misc{a}"], "its hook nodegraph_bibtex .*expected str, got list"),
        ("kinds", [float], "item 0 of nodegraph_kinds .*expected Kind, got type"),
        (
            "kinds",
            lambda: [Kind("float", text)],  # type: ignore[arg-type]
            f"its hook nodegraph_kinds .*Kind.type: expected type, got str {LINE}",
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
        "kinds": [Kind(float, text)],
        "graphs": [Path("x/fill.yaml")],
        "templates": {"lips": Path("lips")},
    }
    registry = install(bad={"nodes": [hold], hook: result}, good=good)
    hooks = registry.hooks
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        assert hooks.of("bibtex") == ("@misc{b}",)
        assert [kind.type for kind in hooks.kinds] == [float, RunningNumbers]
        assert hooks.graphs == {"fill": Path("x/fill.yaml")}
        assert hooks.of("templates") == {"lips": Path("lips")}
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
    kind: Any = kind_of(install, conclude=conclude, numbers=five)
    whose = "plugin 'bad': the conclusion of int, from hook nodegraph_kinds, failed: "
    with pytest.warns(UserWarning, match=f"^{whose}.*{reason}"):
        assert kind.conclude(1) == ()
    with pytest.warns(UserWarning, match="'bad': the numbers of int, .*expected str, got int"):
        assert kind.numbers(1) == ""


def test_a_comparison_that_fails_finds_no_difference(install: Install) -> None:
    kind: Any = kind_of(install, compare=fails)
    with pytest.warns(UserWarning, match=f"'bad': the comparison of int, .*out of tune {LINE}"):
        assert kind.compare(1, 2) == ()


def test_what_works_passes_unchanged(install: Install) -> None:
    rendered = Rendered("<p>")
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        kind: Any = kind_of(
            install,
            render=lambda value, title: rendered,
            take_apart=str,
            put_together=str,
            faithful=False,
            compare=lambda first, second: iter(["it"]),
            conclude=lambda value: ["it"],
            numbers=str,
        )
        assert kind.compare(1, 2) == ("it",)
        assert kind.conclude(1) == ("it",)
        assert kind.numbers(1) == "1"
        assert kind.render(1, "") is rendered
        assert kind.put_together("1") == "1"  # a stand-in may be of any type


def test_of_a_type_and_its_base_the_last_plugin_counts_for_each_field(install: Install) -> None:
    hooks = install(
        one={"kinds": [Kind(int, compare=fails), Kind(bool, numbers=repr)]},
        two={"kinds": [Kind(int, text)]},
    ).hooks
    known = [hooks.kind(bool, field) for field in ("render", "compare", "numbers", "lend")]
    assert [kind and kind.type for kind in known] == [int, int, bool, None]
    assert hooks.kind(float, "render") is None
    assert [kind.type for kind in hooks.having("compare")] == [int]


def test_what_is_made_late_is_made_once_and_guarded(install: Install) -> None:
    made: list[int] = []

    def stream() -> Streamable:
        made.append(1)
        return Streamable(fails, list, five, fails)

    kind: Any = kind_of(
        install,
        stream=stream,
        live_view=five,
        detail=lambda: Detail(fails, five, "a/b"),
    )
    assert kind.stream() is kind.stream()
    assert made == [1]
    assert kind.stream().join(None, []) == 5
    with pytest.raises(PluginError, match=f"'bad': header of int, .*out of tune {LINE}"):
        kind.stream().header(1)
    with pytest.warns(UserWarning, match="expected LiveView, got int; it is not shown"):
        assert kind.live_view() is None
    with pytest.warns(UserWarning, match="the view of a block of int, .*; it is not shown"):
        assert kind.detail().pack({}, {}) is None
    with pytest.warns(UserWarning, match="the layout of int, .*expected Mapping"):
        assert kind.detail().layout({}, "") is None


@pytest.mark.parametrize(
    ("hook", "result", "use", "reason"),
    [
        (
            "kinds",
            [Kind(int, fails)],
            lambda hooks: hooks.kinds[0].render(1, ""),
            f"the renderer of int, .*RuntimeError: out of tune {LINE}",
        ),
        (
            "kinds",
            [Kind(int, text)],
            lambda hooks: hooks.kinds[0].render(1, ""),
            "the renderer of int, .*expected Rendered, got str",
        ),
        (
            "kinds",
            [Kind(int, take_apart=fails, put_together=int)],
            lambda hooks: hooks.kinds[0].take_apart(1),
            f"take_apart of int, .*out of tune {LINE}",
        ),
        (
            "kinds",
            [Kind(int, take_apart=int, put_together=str)],
            lambda hooks: hooks.kinds[0].put_together(1),
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
            lambda hooks: list(hooks.of("executors")["zz"](None, None)),
            "executor 'zz', .*'int' object is not iterable",
        ),
        (
            "executors",
            {"zz": fails_later},
            lambda hooks: list(hooks.of("executors")["zz"](None, None)),
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

    running: Any = install(good={"executors": {"zz": steps}}).hooks.of("executors")["zz"](
        None, None
    )
    assert next(running) == 1
    running.close()
    assert closed == [True]


def test_a_value_that_cannot_be_lent_is_copied(install: Install) -> None:
    kind: Any = kind_of(install, list, lend=repr)
    value = [1.0]
    with pytest.warns(UserWarning, match="'bad': lend of list, .*a copy is lent$"):
        lent = kind.lend(value)
    assert lent == value
    assert lent is not value
