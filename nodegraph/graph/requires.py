"""What a graph requires to be installed."""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError, version
from operator import attrgetter

from nodegraph.errors import Problems
from nodegraph.spec.parts import GraphSpec


def check_requires(spec: GraphSpec, problems: Problems) -> None:
    """Note every required package that is not installed in a version that will do."""
    if not spec.requires:
        return
    from packaging.requirements import InvalidRequirement, Requirement

    for text, place in spec.requires:
        try:
            wanted = Requirement(text)
        except InvalidRequirement:
            hint = "write a package as pip takes it: my-plugin>=1.2"
            problems.add(place, f"requires: {text!r} is not a package", hint)
            continue
        here = attrgetter("marker")(wanted)  # what stands behind the semicolon
        if here is not None and not here.evaluate():
            continue
        found = _version(wanted.name)
        if found is None or not wanted.specifier.contains(found, prereleases=True):
            has = f"{found} is installed" if found else "it is not installed"
            problems.add(place, f"requires {text}, but {has}", f"pip install '{text}'")


def _version(name: str) -> str | None:
    try:
        return version(name)
    except PackageNotFoundError:
        return None
