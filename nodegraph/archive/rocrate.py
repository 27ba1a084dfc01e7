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
from typing import Any
from urllib.parse import quote

from nodegraph.archive.contents import README, RUN, Contents
from nodegraph.errors import NodegraphError
from nodegraph.formatting import number_of
from nodegraph.runs.folder import EVENTS, STUDY
from nodegraph.state import State

_VERSION = "1.1"
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
_PARAMETER = "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"
_TYPES = {bool: "Boolean", int: "Integer", float: "Float", str: "Text"}


def crate_metadata(contents: Contents) -> bytes:
    """Return the content of ``ro-crate-metadata.json``, which depends only on the contents.

    Raises
    ------
    NodegraphError
        If rocrate is not installed.
    """
    metadata = _Crate(contents).metadata()
    text = json.dumps(metadata, indent=1, ensure_ascii=False, sort_keys=True)
    return contents.relocation.encoded(text) + b"\n"


def _add_reference(entity: Any, name: str, value: object) -> None:
    """Add a reference to a property, unless it has it."""
    references = entity.get(name, [])
    references = references if isinstance(references, list) else [references]
    if value not in references:
        entity[name] = [*references, value] if references else value


class _Crate:
    def __init__(self, contents: Contents) -> None:
        try:
            from rocrate.rocrate import ROCrate
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] != "rocrate":
                raise
            raise NodegraphError(
                "archives need rocrate; pip install 'nodegraph[archive]'"
            ) from error
        self._contents = contents
        self._crate = ROCrate(version=_VERSION)
        self._began, self._ended = _times(contents)

    def metadata(self) -> Mapping[str, Any]:
        """Return the metadata as JSON-LD."""
        self._describe_root()
        for name, content in sorted(self._contents.files.items()):
            self._add_file(name, content)
        inputs, outputs = list(self._inputs()), list(self._outputs())
        main = self._file(self._contents.graph)
        main["input"] = [parameter for parameter, _ in inputs]
        main["output"] = outputs
        values = [value for _, value in inputs]
        self._describe_action(main, [*values, *self._further_files(values)])
        metadata: Mapping[str, object] = self._crate.metadata.generate()
        return metadata

    def _describe_root(self) -> None:
        study, root = self._contents.study, self._crate.root_dataset
        root["name"] = study.title
        root["description"] = " ".join(study.answer) or f"A run of the graph {self._contents.graph}"
        root["datePublished"] = self._ended.isoformat(timespec="seconds")
        root["license"] = _NO_LICENCE
        root["conformsTo"] = [
            self._add(url, "CreativeWork", name=name, version=version)
            for url, (name, version) in _PROFILES.items()
        ]
        self._crate.metadata.extra_contexts.append(_RUN_TERMS)
        self._crate.metadata["conformsTo"] = [
            {"@id": f"https://w3id.org/ro/crate/{_VERSION}"},
            {"@id": list(_PROFILES)[-1]},
        ]

    def _add_file(self, name: str, content: bytes) -> None:
        from rocrate.model import DataEntity

        is_main = name == self._contents.graph
        properties = {
            "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"] if is_main else "File",
            "name": name,
            "contentSize": str(len(content)),
            "encodingFormat": _FORMATS.get(PurePosixPath(name).suffix, "application/octet-stream"),
            "sha256": hashlib.sha256(content).hexdigest(),
        }
        file = self._crate.add(DataEntity(self._crate, quote(name), properties))
        if is_main:
            self._describe_workflow(file, properties["sha256"])
        elif name == README:
            file["about"] = self._crate.root_dataset

    def _describe_workflow(self, main: Any, digest: Any) -> None:
        versions = dict(self._contents.study.versions)
        main["name"] = self._contents.study.title
        main["version"] = digest[:12]
        main["conformsTo"] = self._add(
            _WORKFLOW, "CreativeWork", name="Bioschemas ComputationalWorkflow", version="1.0"
        )
        main["programmingLanguage"] = self._add(
            "#nodegraph",
            "ComputerLanguage",
            name="nodegraph",
            version=versions.get("nodegraph", ""),
        )
        main["hasPart"] = list(self._methods())
        main["softwareRequirements"] = [
            self._add(f"#package-{quote(name)}", "SoftwareApplication", name=name, version=version)
            for name, version in self._contents.study.versions
            if name != "platform"
        ]
        self._crate.root_dataset["mainEntity"] = main

    def _methods(self) -> Iterator[Any]:
        for method in {row.use: row for row in self._contents.study.methods}.values():
            citation = {"citation": method.citation} if method.citation else {}
            yield self._add(
                f"#method-{quote(method.use)}",
                "SoftwareApplication",
                name=method.use,
                description=method.summary,
                version=method.plugin,
                **citation,
            )

    def _inputs(self) -> Iterator[tuple[object, object]]:
        """Yield a parameter with its value, for each input and each axis of the graph."""
        record = self._contents.record
        for name, value in record.inputs.items():
            file = self._file_of(value)
            kind = "File" if file is not None else _TYPES.get(type(value), "Text")
            parameter = self._parameter(f"#input-{quote(name)}", name, kind)
            entity = file if file is not None else self._value(f"#value-{quote(name)}", name, value)
            _add_reference(entity, "exampleOfWork", parameter)
            yield parameter, entity
        for name, labels in record.axes.items():
            parameter = self._parameter(f"#axis-{quote(name)}", name, "Text")
            text = ", ".join(map(str, labels))
            entity = self._value(f"#labels-{quote(name)}", name, text)
            entity["exampleOfWork"] = parameter
            yield parameter, entity

    def _outputs(self) -> Iterator[object]:
        """Yield a parameter for each reported output, which its files refer to."""
        for section in self._contents.study.sections:
            entities = (self._file(f"{RUN}/{link.path}") for link in section.files)
            files = [entity for entity in entities if entity is not None]
            if files:
                parameter = self._parameter(
                    f"#output-{quote(section.title)}", section.title, "File"
                )
                for file in files:
                    _add_reference(file, "exampleOfWork", parameter)
                yield parameter

    def _further_files(self, inputs: list[Any]) -> Iterator[object]:
        """Yield the files that the run read except those among its inputs."""
        known = {entity.id for entity in inputs}
        for file in self._contents.inputs:
            for entity in self._files_of(file.written):
                if entity.id not in known:
                    known.add(entity.id)
                    yield entity

    def _file_of(self, value: object) -> object:
        files = list(self._files_of(value)) if isinstance(value, str) else []
        return files[0] if len(files) == 1 and files[0].type != "PropertyValue" else None

    def _files_of(self, written: str) -> Iterator[Any]:
        """Yield the files of a path in the settings, or an entity with the digest."""
        for file in self._contents.inputs:
            if file.written == written:
                entities = (self._file(name) for name, _ in file.contents())
                files = [entity for entity in entities if entity is not None]
                if files:
                    yield from files
                else:
                    yield self._add(
                        f"#file-{quote(file.name)}",
                        "PropertyValue",
                        name=file.name,
                        value=file.name,
                        sha256=file.digest[:64],
                    )

    def _parameter(self, identifier: str, name: str, kind: str) -> object:
        profile = self._add(
            _PARAMETER, "CreativeWork", name="Bioschemas FormalParameter", version="1.0"
        )
        return self._add(
            identifier, "FormalParameter", name=name, additionalType=kind, conformsTo=profile
        )

    def _value(self, identifier: str, name: str, value: object) -> Any:
        plain = value if isinstance(value, (str, int, float)) else json.dumps(value)
        return self._add(identifier, "PropertyValue", name=name, value=plain)

    def _describe_action(self, main: object, inputs: list[object]) -> None:
        failed = self._contents.record.counts.get(State.FAILED, 0)
        status = "FailedActionStatus" if failed else "CompletedActionStatus"
        error = {"error": f"{number_of(failed, 'step')} failed; see run/run.json"} if failed else {}
        action = self._add(
            "#run",
            "CreateAction",
            name=f"Run of {self._contents.graph}",
            description=self._contents.command,
            instrument=main,
            object=inputs,
            result=[self._file(name) for name in self._contents.results],
            startTime=self._began.isoformat(timespec="seconds"),
            endTime=self._ended.isoformat(timespec="seconds"),
            actionStatus=f"http://schema.org/{status}",
            **error,
        )
        self._crate.root_dataset["mentions"] = action

    def _add(self, identifier: str, kind: str, **properties: object) -> Any:
        """Return the entity with an identifier, which is added unless it exists."""
        from rocrate.model import ContextEntity

        entity = self._crate.get(identifier)
        if entity is not None:
            return entity
        entity = ContextEntity(self._crate, identifier, {"@type": kind, **properties})
        return self._crate.add(entity)

    def _file(self, name: str) -> Any:
        """Return a file of the archive, or None."""
        return self._crate.get(quote(name))


def _times(contents: Contents) -> tuple[datetime, datetime]:
    """Return when the run began and ended."""
    try:
        ended = datetime.fromisoformat(contents.study.created)
    except ValueError as error:
        raise NodegraphError(f"{STUDY}: created: {error}; run the graph again") from error
    first = contents.files.get(f"{RUN}/{EVENTS}", b"").partition(b"\n")[0]
    try:
        began = datetime.fromisoformat(json.loads(first)["began"])
    except (ValueError, LookupError, TypeError):
        return ended - timedelta(seconds=contents.study.seconds), ended
    return began, began + timedelta(seconds=contents.study.seconds)
