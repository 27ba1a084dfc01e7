"""An object for a hook is refused at once where a field is of another type."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest

from nodegraph import Conclusion, Format, Rendered, Renderer, Storage


def nothing(*arguments: object) -> tuple[str, ...]:
    return ()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Conclusion("int", nothing, str), "Conclusion.type: expected type, got str"),  # type: ignore[arg-type]
        (lambda: Conclusion(int, nothing, 4), "Conclusion.numbers: expected Callable, got int"),  # type: ignore[arg-type]
        (lambda: Renderer(nothing, int), "Renderer.type: expected type, got function"),  # type: ignore[arg-type]
        (lambda: Storage(int, nothing, None), "Storage.put_together: .* got NoneType"),  # type: ignore[arg-type]
        (lambda: Storage(int, nothing, nothing, nothing), "Storage.faithful: expected bool"),  # type: ignore[arg-type]
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
    assert Storage(int, nothing, nothing, lend=nothing).faithful
    assert Rendered("", files={".csv": b"a"}, styles=("p {}",)).text == ""
