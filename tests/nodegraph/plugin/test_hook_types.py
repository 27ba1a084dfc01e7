"""An object for a hook is refused at once where a field is of another type."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from nodegraph import Format, Kind, Rendered, late


def nothing(*arguments: object) -> tuple[str, ...]:
    return ()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Kind("int"), "Kind.type: expected type, got str"),  # type: ignore[arg-type]
        (lambda: Kind(nothing, int), "Kind.type: expected type, got function"),  # type: ignore[arg-type]
        (lambda: Kind(int, numbers=4), "Kind.numbers: expected Callable or NoneType, got int"),  # type: ignore[arg-type]
        (lambda: Kind(int, faithful=nothing), "Kind.faithful: expected bool"),  # type: ignore[arg-type]
        (lambda: Rendered(b"<p>"), "Rendered.html: expected str, got bytes"),  # type: ignore[arg-type]
        (lambda: Rendered("", scripts="let a = 1"), "Rendered.scripts: .*tuple"),  # type: ignore[arg-type]
        (lambda: Rendered("", scripts=(b"let a = 1",)), "Rendered.scripts: .*str"),  # type: ignore[arg-type]
        (lambda: Rendered("", answer="a wins."), "Rendered.answer: .*tuple"),  # type: ignore[arg-type]
        (lambda: Rendered("", answer=(3,)), "Rendered.answer: .*str"),  # type: ignore[arg-type]
        (lambda: Rendered("", files={".csv": "a,b"}), r"Rendered.files\['.csv'\]: .*bytes"),  # type: ignore[dict-item]
    ],
)
def test_a_field_of_another_type_is_named(make: Callable[[], object], message: str) -> None:
    with pytest.raises(TypeError, match=f"^{message}"):
        make()


@pytest.mark.parametrize("part", [{"scripts": ("</script>",)}, {"styles": ("</STYLE >",)}])
def test_a_script_that_would_end_its_tag_is_refused(part: dict[str, Any]) -> None:
    with pytest.raises(ValueError, match="must not contain </s"):
        Rendered("", **part)


@pytest.mark.parametrize("suffixes", [(), ("c3d",), (".C3D",), (1,)])
def test_a_suffix_of_another_form_is_refused(suffixes: Any) -> None:
    with pytest.raises(ValueError, match=r"Format\.suffixes"):
        Format("C3D", int, suffixes, nothing)


def test_fields_of_the_declared_types_are_accepted() -> None:
    assert Kind(int, take_apart=nothing, put_together=nothing, lend=nothing).faithful
    assert Rendered("", files={".csv": b"a"}, styles=("p {}",)).text == ""


def test_what_is_taken_apart_is_put_together() -> None:
    with pytest.raises(ValueError, match="belong together"):
        Kind(int, take_apart=nothing)


def test_a_function_is_imported_when_it_is_first_called() -> None:
    assert late("json:dumps")([1], indent=None) == "[1]"
    missing = late("nobody_has_this:render")
    with pytest.raises(ModuleNotFoundError):
        missing()
