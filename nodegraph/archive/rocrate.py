"""The description of an archive, for programs: a Workflow Run RO-Crate.

Soiland-Reyes et al. 2022, Packaging research artefacts with RO-Crate; Leo et al. 2024, Recording
provenance of workflow runs with RO-Crate. It keeps Workflow Run Crate 0.5, Process Run Crate 0.5
and Workflow RO-Crate 1.0, on RO-Crate 1.1.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterator, Mapping
from datetime import datetime, timedelta
from pathlib import PurePosixPath
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

from nodegraph.errors import NodegraphError
from nodegraph.runs.folder import EVENTS, STUDY
from nodegraph.state import State

if TYPE_CHECKING:
    from nodegraph.archive.contents import Contents


VERSION = "1.1"
"""Of RO-Crate."""


class Entities:
    """What a crate describes.

    Raises
    ------
    NodegraphError
        If the package that writes it is not installed.
    """

    def __init__(self) -> None:
        try:
            from rocrate.rocrate import ROCrate
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] != "rocrate":
                raise
            raise NodegraphError(
                "an archive needs what is not installed; pip install 'nodegraph[archive]'"
            ) from error
        self.crate = ROCrate(version=VERSION)

    def add(self, identifier: str, kind: str, **described: Any) -> Any:
        """Return what is described under an identifier; it is added unless it is there."""
        from rocrate.model import ContextEntity

        there = self.crate.get(identifier)
        if there is not None:
            return there
        properties = {"@type": kind, **described}
        return self.crate.add(ContextEntity(self.crate, identifier, properties))

    def add_file(self, name: str, described: Mapping[str, Any]) -> Any:
        """Add a file of the archive."""
        from rocrate.model import DataEntity

        return self.crate.add(DataEntity(self.crate, quote(name), dict(described)))

    def file(self, name: str) -> Any:
        """Return a file of the archive, or None."""
        return self.crate.get(quote(name))


def append(entity: Any, name: str, value: Any) -> None:
    """Add a reference, once, to those that an entity has under a name."""
    there = entity.get(name, [])
    known = there if isinstance(there, list) else [there]
    if value not in known:
        entity[name] = [*known, value] if known else value


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
        for name, value in record.inputs.items():
            file = self._file_of(value)
            kind = "File" if file is not None else _TYPES.get(type(value), "Text")
            parameter = self._parameter(f"#input-{quote(name)}", name, kind)
            given = file if file is not None else self._value(f"#value-{quote(name)}", name, value)
            append(given, "exampleOfWork", parameter)
            yield parameter, given
        for name, labels in record.axes.items():
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


_RUN_TERMS = "https://w3id.org/ro/terms/workflow-run/context"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
_WORKFLOW = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"
_NO_LICENCE = "No licence is stated here; ask those who made this archive"
_FORMATS = {
    ".bib": "application/x-bibtex", ".csv": "text/csv", ".gz": "application/gzip",
    ".html": "text/html", ".json": "application/json", ".jsonl": "application/jsonl",
    ".md": "text/markdown", ".pdf": "application/pdf", ".png": "image/png",
    ".py": "text/x-python", ".svg": "image/svg+xml", ".tex": "text/x-tex", ".tsv":
    "text/tab-separated-values", ".txt": "text/plain", ".yaml": "application/yaml",
}  # fmt: skip


def crate_metadata(contents: Contents) -> bytes:
    """Return the content of ``ro-crate-metadata.json``; the same contents give the same bytes.

    Raises
    ------
    NodegraphError
        If the package that writes it is not installed.
    """
    graph = _Crate(contents).described()
    text = json.dumps(graph, indent=1, ensure_ascii=False, sort_keys=True)
    return contents.elsewhere.text(text).encode(errors="backslashreplace") + b"\n"


class _Crate:
    def __init__(self, contents: Contents) -> None:
        self._contents = contents
        self._entities = Entities()
        self._crate = self._entities.crate
        self._began, self._ended = _times(contents)

    def described(self) -> Mapping[str, Any]:
        """Return the whole description as JSON-LD."""
        self._describe_root()
        for name, content in sorted(self._contents.files.items()):
            self._add_file(name, content)
        parameters = Parameters(self._contents, self._entities)
        inputs, outputs = list(parameters.inputs()), list(parameters.outputs())
        main = self._entities.file(self._contents.graph)
        main["input"] = [parameter for parameter, _ in inputs]
        main["output"] = outputs
        read = [value for _, value in inputs if value is not None]
        self._describe_action(main, [*read, *parameters.read(read)])
        described: Mapping[str, Any] = self._crate.metadata.generate()
        return described

    def _describe_root(self) -> None:
        study, root = self._contents.study, self._crate.root_dataset
        root["name"] = study.title
        said = " ".join(study.answer) or f"A run of the graph {self._contents.graph}"
        root["description"] = said
        root["datePublished"] = self._ended.isoformat(timespec="seconds")
        root["license"] = _NO_LICENCE
        root["conformsTo"] = [
            self._entities.add(url, "CreativeWork", name=name, version=version)
            for url, (name, version) in _PROFILES.items()
        ]
        self._crate.metadata.extra_contexts.append(_RUN_TERMS)
        self._crate.metadata["conformsTo"] = [
            {"@id": f"https://w3id.org/ro/crate/{VERSION}"},
            {"@id": list(_PROFILES)[-1]},
        ]

    def _add_file(self, name: str, content: bytes) -> None:
        is_main = name == self._contents.graph
        described = {
            "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"] if is_main else "File",
            "name": name,
            "contentSize": str(len(content)),
            "encodingFormat": _FORMATS.get(PurePosixPath(name).suffix, "application/octet-stream"),
            "sha256": hashlib.sha256(content).hexdigest(),
        }
        made = self._entities.add_file(name, described)
        if is_main:
            self._describe_workflow(made, described["sha256"])
        elif name == "README.md":
            made["about"] = self._crate.root_dataset

    def _describe_workflow(self, main: Any, digest: Any) -> None:
        versions = dict(self._contents.study.versions)
        main["name"] = self._contents.study.title
        main["version"] = digest[:12]
        main["conformsTo"] = self._entities.add(
            _WORKFLOW, "CreativeWork", name="Bioschemas ComputationalWorkflow", version="1.0"
        )
        main["programmingLanguage"] = self._entities.add(
            "#nodegraph",
            "ComputerLanguage",
            name="nodegraph",
            version=versions.get("nodegraph", ""),
        )
        main["hasPart"] = list(self._methods())
        main["softwareRequirements"] = [
            self._entities.add(
                f"#package-{quote(name)}", "SoftwareApplication", name=name, version=one
            )
            for name, one in self._contents.study.versions
            if name != "platform"
        ]
        self._crate.root_dataset["mainEntity"] = main

    def _methods(self) -> Iterator[Any]:
        for one in {row.use: row for row in self._contents.study.methods}.values():
            said = {"citation": one.citation} if one.citation else {}
            yield self._entities.add(
                f"#method-{quote(one.use)}",
                "SoftwareApplication",
                name=one.use,
                description=one.summary,
                version=one.plugin,
                **said,
            )

    def _describe_action(self, main: Any, read: list[Any]) -> None:
        failed = self._contents.record.counts.get(State.FAILED, 0)
        status = "FailedActionStatus" if failed else "CompletedActionStatus"
        error = {"error": f"{failed} steps failed; run/run.json says which"} if failed else {}
        action = self._entities.add(
            "#run",
            "CreateAction",
            name=f"Run of {self._contents.graph}",
            description=self._contents.command,
            instrument=main,
            object=read,
            result=[self._entities.file(name) for name in self._contents.results],
            startTime=self._began.isoformat(timespec="seconds"),
            endTime=self._ended.isoformat(timespec="seconds"),
            actionStatus=f"http://schema.org/{status}",
            **error,
        )
        self._crate.root_dataset["mentions"] = action


def _times(contents: Contents) -> tuple[datetime, datetime]:
    """Return when the run began and ended."""
    try:
        ended = datetime.fromisoformat(contents.study.created)
    except ValueError as error:
        raise NodegraphError(f"{STUDY}: created: {error}; run the graph again") from error
    first = contents.files.get(f"run/{EVENTS}", b"").partition(b"\n")[0]
    try:
        began = datetime.fromisoformat(json.loads(first)["began"])
    except (ValueError, LookupError, TypeError):
        return ended - timedelta(seconds=contents.study.seconds), ended
    return began, began + timedelta(seconds=contents.study.seconds)
