"""What an archived run was given, and what it gave: parameters and their values, for programs."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from nodegraph.paper.archived.entities import Entities, append

if TYPE_CHECKING:
    from nodegraph.paper.archived.contents import Contents

_PARAMETER = "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"
_TYPES = {bool: "Boolean", int: "Integer", float: "Float", str: "Text"}


class Parameters:
    """Describes parameters.

    Parameters
    ----------
    contents
    entities
        Where the files of the archive are described already.
    """

    def __init__(self, contents: Contents, entities: Entities) -> None:
        self._contents = contents
        self._entities = entities

    def inputs(self) -> Iterator[tuple[Any, Any]]:
        """Yield a parameter with its value, for each input and each axis of the graph."""
        record = self._contents.record
        for name, value in record["inputs"].items():
            file = self._file_of(value)
            kind = "File" if file is not None else _TYPES.get(type(value), "Text")
            parameter = self._parameter(f"#input-{quote(name)}", name, kind)
            given = file if file is not None else self._value(f"#value-{quote(name)}", name, value)
            append(given, "exampleOfWork", parameter)
            yield parameter, given
        for name, labels in record["axes"].items():
            parameter = self._parameter(f"#axis-{quote(name)}", name, "Text")
            shown = ", ".join(map(str, labels))
            given = self._value(f"#labels-{quote(name)}", name, shown)
            given["exampleOfWork"] = parameter
            yield parameter, given

    def outputs(self) -> Iterator[Any]:
        """Yield a parameter for each reported output, which its files refer to."""
        for section in self._contents.study.sections:
            files = [self._entities.file(f"run/{one.path}") for one in section.files]
            files = [one for one in files if one is not None]
            if files:
                parameter = self._parameter(
                    f"#output-{quote(section.title)}", section.title, "File"
                )
                for one in files:
                    append(one, "exampleOfWork", parameter)
                yield parameter

    def read(self, already: list[Any]) -> Iterator[Any]:
        """Yield what else the run read."""
        there = {one.id for one in already}
        for one in self._contents.inputs:
            for entity in self._known(one.written):
                if entity.id not in there:
                    there.add(entity.id)
                    yield entity

    def _file_of(self, value: Any) -> Any:
        found = list(self._known(value)) if isinstance(value, str) else []
        return found[0] if len(found) == 1 and found[0].type != "PropertyValue" else None

    def _known(self, written: str) -> Iterator[Any]:
        """Yield the files in the archive for what is written so, or what is known of them."""
        for one in self._contents.inputs:
            if one.written == written:
                files = [self._entities.file(name) for name, _ in one.contents()]
                files = [found for found in files if found is not None]
                if files:
                    yield from files
                else:
                    described = {"name": one.name, "value": one.name, "sha256": one.digest[:64]}
                    yield self._entities.add(
                        f"#file-{quote(one.name)}", "PropertyValue", **described
                    )

    def _parameter(self, identifier: str, name: str, kind: str) -> Any:
        profile = self._entities.add(
            _PARAMETER, "CreativeWork", name="Bioschemas FormalParameter", version="1.0"
        )
        described = {"name": name, "additionalType": kind, "conformsTo": profile}
        return self._entities.add(identifier, "FormalParameter", **described)

    def _value(self, identifier: str, name: str, value: Any) -> Any:
        plain = value if isinstance(value, (str, int, float)) else json.dumps(value)
        return self._entities.add(identifier, "PropertyValue", name=name, value=plain)
