"""Settings are validated at every label, with the units and bounds of the node."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Annotated, Literal

import pytest
from pydantic import Field

from nodegraph import InputFile, Unit, node
from nodegraph.errors import NodegraphError
from nodegraph.graph import Choices, Graph, build
from nodegraph.graphfile import read_graph_text
from nodegraph.plugin.registry import Registry
from tests.nodegraph.conftest import ProblemsOf


@node("set.all")
def everything(
    *,
    whole: Annotated[int, Field(ge=1, le=9), Unit("frames")] = 1,
    number: Annotated[float, Field(gt=0), Unit("mm")] = 0.5,
    text: str = "",
    flag: bool = True,
    way: Literal["up", "down"] = "up",
    many: tuple[int, ...] = (),
    pair: tuple[float, float] = (0.0, 1.0),
    names: list[str] | None = None,
    some: int | list[int] = 0,
    path: InputFile | None = None,
    settings: dict[str, float] | None = None,
) -> float:
    return 0.0


def values(graph: Graph) -> dict[str, object]:
    (settings,) = graph.nodes["a"].first.settings.values.values()
    return dict(settings)


@pytest.mark.parametrize(
    ("written", "expected"),
    [
        ("whole: 9", {"whole": 9}),
        ("number: 1e-3", {"number": 0.001}),
        ("number: 2", {"number": 2.0}),
        ("text: no", {"text": "no"}),
        ("flag: false", {"flag": False}),
        ("way: down", {"way": "down"}),
        ("many: [1, 2]", {"many": (1, 2)}),
        ("pair: [1, 2.5]", {"pair": (1.0, 2.5)}),
        ("names: [a, no]", {"names": ["a", "no"]}),
        ("names: ~", {"names": None}),
        ("settings: {a: 1}", {"settings": {"a": 1.0}}),
        ("many: [$k, 7]", {"many": (3, 7)}),
        ("settings: {a: $k.part}", {"settings": {"a": 0.25}}),
    ],
)
def test_a_setting_arrives_as_its_type(
    graph_of: Callable[..., Graph], written: str, expected: dict[str, object]
) -> None:
    form = "{m: {part: 0.25}}" if ".part" in written else "[3]"
    axes = f"axes: {{k: {form}}}\n" if "$" in written else ""
    graph = graph_of(
        f"{axes}nodes: {{a: {{use: set.all, with: {{{written}}}}}}}", more=[everything]
    )
    actual = {name: values(graph)[name] for name in expected}
    assert actual == expected
    assert [type(value) for value in actual.values()] == [
        type(value) for value in expected.values()
    ]


@pytest.mark.parametrize(
    ("written", "expected", "description"),
    [
        (
            "whole: @@0",
            "should be greater than or equal to 1, got 0",
            "expected: whole number >= 1 and <= 9, frames",
        ),
        ("whole: @@10", "should be less than or equal to 9, got 10", "frames"),
        ("whole: @@1.0", "should be a valid integer, got 1.0", "whole number"),
        ("whole: @@'1'", "should be a valid integer, got '1'", "whole number"),
        ("whole: @@true", "should be a valid integer, got True", "whole number"),
        ("whole: @@~", "should be a valid integer, got None", "whole number"),
        ("number: @@0", "should be greater than 0, got 0", "number > 0, mm"),
        ("number: @@fast", "should be a valid number, got 'fast'", "number > 0, mm"),
        (
            "whole: @@[1, 2]",
            "should be a valid integer, got [1, 2]",
            "several values are an axis: axes: {whole: [1, 2]}, and $whole here",
        ),
        ("many: @@[a]", "should be a valid integer, got 'a'", "expected: list of whole numbers"),
        ("path: @@'*.c3d'", "no such file: *.c3d", 'a label for each file: {files: "*.c3d"}'),
        ("text: @@5", "should be a valid string, got 5", "text"),
        ("flag: @@no", "should be a valid boolean, got 'no'", "true or false"),
        ("way: @@left", "should be 'up' or 'down', got 'left'", "one of up, down"),
        ("many: @@3", "is a list", "list of whole numbers"),
        ("many: @@[1, x]", "should be a valid integer, got 'x'", "list of whole numbers"),
        ("names: @@a", "is a list", "list of texts or null"),
        ("some: @@x", "should be a valid integer, got 'x'", "or list of whole numbers; write [x]"),
        ("path: @@none.c3d", "no such file: none.c3d", ""),
        ("hole: @@3", "has no setting 'hole'", "did you mean 'whole'?"),
        (f"whole: @@{'9' * 3500}", "setting 'whole' of set.all", "whole number"),
        (f"text: @@{'9' * 2500}", "should be a valid string", "text"),
    ],
)
def test_an_invalid_setting_is_reported_with_its_description(
    problems_of: ProblemsOf, written: str, expected: str, description: str
) -> None:
    (problem,) = problems_of(
        f"nodes: {{a: {{use: set.all, with: {{{written}}}}}}}", more=[everything]
    )
    assert expected in problem.message
    assert description in problem.instead


def test_a_required_setting_must_be_set(problems_of: ProblemsOf) -> None:
    (problem,) = problems_of("nodes: {a: {use: @@read.file}}")
    assert problem.message == "a: setting 'path' of read.file must be given"


def test_all_invalid_settings_of_a_node_are_reported(problems_of: ProblemsOf) -> None:
    text = "nodes: {a: {use: set.all, with: {whole: @@0, number: @@x, way: @@y}}}"
    assert len(problems_of(text, more=[everything])) == 3


def test_an_axis_of_what_should_be_lists_is_named_in_the_hint(problems_of: ProblemsOf) -> None:
    text = "axes: {each: [3]}\nnodes: {a: {use: set.all, with: {many: @@$each}}}"
    (problem,) = problems_of(text, more=[everything])
    assert problem.instead == "expected: list of whole numbers; write [$each]"


def test_a_setting_is_checked_at_every_label(problems_of: ProblemsOf) -> None:
    text = """
        axes: {k: [1, 5, 10, 12]}
        nodes: {a: {use: set.all, with: {whole: @@@@$k}}}
        """
    problems = problems_of(text, more=[everything])
    assert [problem.message[-6:] for problem in problems] == ["got 10", "got 12"]
    text = text.replace("[1,", "[20, 21, 22,").replace("@@@@", 4 * "@@")
    *_, last = problems_of(text, more=[everything])
    assert last.message == "a: 2 more values of 'whole' are not valid"


def test_settings_depend_on_the_axes_that_they_name(graph_of: Callable[..., Graph]) -> None:
    graph = graph_of(
        """
        inputs: {n: 4}
        axes: {j: [1, 2], k: {a: {w: 3, t: x}, b: {w: 4, t: y}}, other: [1]}
        nodes:
          a: {use: set.all, with: {text: $k.t, whole: $k.w, many: [$j, $n]}}
          o: {use: read.number, with: {start: $other}}
        """,
        more=[everything],
    )
    settings = graph.nodes["a"].first.settings
    assert settings.axes == ("j", "k")
    assert settings.values[2, "b"]["many"] == (2, 4)
    assert settings.values[2, "b"]["whole"] == 4
    assert settings.shown[2, "b"]["text"] == "y"
    assert settings.shown[2, "b"]["number"] == 0.5


def test_a_field_that_a_label_lacks_is_named(problems_of: ProblemsOf) -> None:
    problems = problems_of(
        """
        axes: {k: {a: {whole: 3}, b: {hole: 4}}}
        nodes: {a: {use: set.all, with: {whole: @@@@$k.whole}}}
        """,
        more=[everything],
    )
    assert "label 'b' has no field 'whole'" in problems[0].message
    assert problems[0].instead == "did you mean 'hole'? there is: hole"


def test_an_input_has_the_fields_of_its_value(
    graph_of: Callable[..., Graph], problems_of: ProblemsOf
) -> None:
    text = "inputs: {n: VALUE}\nnodes: {a: {use: set.all, with: {whole: @@$n.a}}}"
    good = text.replace("VALUE", "{a: 1}").replace("@@", "")
    assert values(graph_of(good, more=[everything]))["whole"] == 1
    assert values(graph_of(good, more=[everything], inputs={"n": {"a": 2}}))["whole"] == 2
    (problem,) = problems_of(text.replace("VALUE", "5"), more=[everything])
    assert problem.message == "$n.a: the input 'n' has no fields, 5"
    problem, _ = problems_of(
        text.replace("VALUE", "{b: 1}").replace("@@", "@@@@"), more=[everything]
    )
    assert problem.message == "$n.a: the input 'n' has no field 'a'"


def test_paths_start_at_the_graph_or_the_working_folder(
    graph_of: Callable[..., Graph], tmp_path: Path
) -> None:
    beside, working = tmp_path / "graphs", tmp_path
    beside.mkdir()
    for folder in (beside, working):
        (folder / "take.txt").write_text("1")
    text = "nodegraph: 1\ninputs: {p: take.txt}\nnodes: {a: {use: set.all, with: {path: $p}}}"
    spec = read_graph_text(text, "g.yaml", beside)
    registry = Registry.of([everything])
    assert values(build(spec, registry))["path"] == (beside / "take.txt").resolve()
    graph = graph_of(text.partition("\n")[2], more=[everything], inputs={"p": "take.txt"})
    assert values(graph)["path"] == (working / "take.txt").resolve()
    apart = Choices({"p": "take.txt"}, folder=working, folders={"p": beside})
    for choices in (apart, Choices().updated(apart), apart.updated(Choices())):
        assert values(build(spec, registry, choices))["path"] == (beside / "take.txt").resolve()


def test_a_scheme_finds_a_place(tmp_path: Path) -> None:
    (tmp_path / "face").mkdir()

    def sample(name: str) -> Path:
        if name != "face":
            raise NodegraphError(f"no sample {name!r}")
        return tmp_path / name

    registry = Registry.of([everything])
    registry.hooks._known["places"] = {"sample": sample}
    text = "nodegraph: 1\nnodes: {a: {use: set.all, with: {path: 'sample:face'}}}"
    graph = build(read_graph_text(text, "g.yaml", Path()), registry)
    assert values(graph)["path"] == (tmp_path / "face").resolve()
    assert graph.nodes["a"].first.settings.shown[()]["path"] == "sample:face"
    with pytest.raises(NodegraphError, match=r"g\.yaml:2:40: a: no sample 'fase'"):
        build(read_graph_text(text.replace("face", "fase"), "g.yaml", Path()), registry)
