"""Haystack: components in a pipeline."""

from __future__ import annotations

from typing import Any

import pytest

from tests.benchmarks.work import Build, Run, Work


def haystack(work: Work, count: int) -> Build:
    library: Any = pytest.importorskip("haystack")
    component = library.component

    class First:
        def run(self) -> dict[str, object]:
            return {"value": work.first()}

    class Step:
        def run(self, value: object) -> dict[str, object]:
            return {"value": work.step(value)}

    Step.run.__annotations__["value"] = work.kind
    gives = component.output_types(value=work.kind)
    kinds = [_component(component, gives, result) for result in (First, Step)]

    def build() -> Run:
        pipeline = library.Pipeline()
        pipeline.add_component("n0", kinds[0]())
        for at in range(count):
            pipeline.add_component(f"n{at + 1}", kinds[1]())
            pipeline.connect(f"n{at}.value", f"n{at + 1}.value")
        return lambda: pipeline.run({})[f"n{count}"]["value"]

    return build


def _component(component: Any, gives: Any, result: Any) -> Any:
    result.run = gives(result.run)
    return component(result)
