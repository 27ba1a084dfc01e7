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
from nodegraph.folder import EVENTS

if TYPE_CHECKING:
    from nodegraph.paper.archived.contents import Contents

_VERSION = "1.1"
_RUN_TERMS = "https://w3id.org/ro/terms/workflow-run/context"
_PROFILES = {
    "https://w3id.org/ro/wfrun/process/0.5": ("Process Run Crate", "0.5"),
    "https://w3id.org/ro/wfrun/workflow/0.5": ("Workflow Run Crate", "0.5"),
    "https://w3id.org/workflowhub/workflow-ro-crate/1.0": ("Workflow RO-Crate", "1.0"),
}
_WORKFLOW = "https://bioschemas.org/profiles/ComputationalWorkflow/1.0-RELEASE"
_PARAMETER = "https://bioschemas.org/profiles/FormalParameter/1.0-RELEASE"
_NO_LICENCE = "No licence is stated here; ask those who made this archive"
_FORMATS = {
    ".bib": "application/x-bibtex", ".csv": "text/csv", ".gz": "application/gzip",
    ".html": "text/html", ".json": "application/json", ".jsonl": "application/jsonl",
    ".md": "text/markdown", ".pdf": "application/pdf", ".png": "image/png",
    ".py": "text/x-python", ".svg": "image/svg+xml", ".tex": "text/x-tex", ".tsv":
    "text/tab-separated-values", ".txt": "text/plain", ".yaml": "application/yaml",
}  # fmt: skip
_TYPES = {bool: "Boolean", int: "Integer", float: "Float", str: "Text"}


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
        try:
            from rocrate.rocrate import ROCrate
        except ModuleNotFoundError as error:
            if (error.name or "").partition(".")[0] != "rocrate":
                raise
            raise NodegraphError(
                "an archive needs what is not installed; pip install 'nodegraph[archive]'"
            ) from error
        self._contents = contents
        self._crate = ROCrate(version=_VERSION)
        self._began, self._ended = _times(contents)

    def described(self) -> Mapping[str, Any]:
        """Return the whole description as JSON-LD."""
        self._describe_root()
        for name, content in sorted(self._contents.files.items()):
            self._add_file(name, content)
        inputs, outputs = list(self._inputs()), list(self._outputs())
        main = self._crate.get(quote(self._contents.graph))
        main["input"] = [parameter for parameter, _ in inputs]
        main["output"] = outputs
        read = [value for _, value in inputs if value is not None]
        self._describe_action(main, [*read, *self._read(read)])
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
        described = {
            "@type": ["File", "SoftwareSourceCode", "ComputationalWorkflow"] if is_main else "File",
            "name": name,
            "contentSize": str(len(content)),
            "encodingFormat": _FORMATS.get(PurePosixPath(name).suffix, "application/octet-stream"),
            "sha256": hashlib.sha256(content).hexdigest(),
        }
        made = self._crate.add(DataEntity(self._crate, quote(name), described))
        if is_main:
            self._describe_workflow(made, described["sha256"])
        elif name == "README.md":
            made["about"] = self._crate.root_dataset

    def _describe_workflow(self, main: Any, digest: Any) -> None:
        versions = dict(self._contents.study.versions)
        main["name"] = self._contents.study.title
        main["version"] = digest[:12]
        main["conformsTo"] = self._add(
            _WORKFLOW, "CreativeWork", name="Bioschemas ComputationalWorkflow", version="1.0"
        )
        main["programmingLanguage"] = self._add(
            "#nodegraph", "ComputerLanguage", name="nodegraph", version=versions["nodegraph"]
        )
        main["hasPart"] = list(self._methods())
        main["softwareRequirements"] = [
            self._add(f"#package-{quote(name)}", "SoftwareApplication", name=name, version=one)
            for name, one in self._contents.study.versions
            if name != "platform"
        ]
        self._crate.root_dataset["mainEntity"] = main

    def _methods(self) -> Iterator[Any]:
        for one in {row.use: row for row in self._contents.study.methods}.values():
            said = {"citation": one.citation} if one.citation else {}
            yield self._add(
                f"#method-{quote(one.use)}",
                "SoftwareApplication",
                name=one.use,
                description=one.summary,
                version=one.plugin,
                **said,
            )

    def _inputs(self) -> Iterator[tuple[Any, Any]]:
        """Yield a parameter with its value, for each input and each axis of the graph."""
        record = self._contents.record
        for name, value in record["inputs"].items():
            file = self._file_of(value)
            kind = "File" if file is not None else _TYPES.get(type(value), "Text")
            parameter = self._parameter(f"#input-{quote(name)}", name, kind)
            given = file if file is not None else self._value(f"#value-{quote(name)}", name, value)
            _append(given, "exampleOfWork", parameter)
            yield parameter, given
        for name, labels in record["axes"].items():
            parameter = self._parameter(f"#axis-{quote(name)}", name, "Text")
            shown = ", ".join(map(str, labels))
            given = self._value(f"#labels-{quote(name)}", name, shown)
            given["exampleOfWork"] = parameter
            yield parameter, given

    def _outputs(self) -> Iterator[Any]:
        """Yield a parameter for each reported output, which its files refer to."""
        for section in self._contents.study.sections:
            files = [self._crate.get(quote(f"run/{one.path}")) for one in section.files]
            files = [one for one in files if one is not None]
            if files:
                parameter = self._parameter(
                    f"#output-{quote(section.title)}", section.title, "File"
                )
                for one in files:
                    _append(one, "exampleOfWork", parameter)
                yield parameter

    def _read(self, already: list[Any]) -> Iterator[Any]:
        """Yield what else the run read."""
        there = {one.id for one in already}
        for one in self._contents.inputs:
            for entity in self._entities(one.written):
                if entity.id not in there:
                    there.add(entity.id)
                    yield entity

    def _file_of(self, value: Any) -> Any:
        found = list(self._entities(value)) if isinstance(value, str) else []
        return found[0] if len(found) == 1 and found[0].type != "PropertyValue" else None

    def _entities(self, written: str) -> Iterator[Any]:
        """Yield the files in the archive for what is written so, or what is known of them."""
        for one in self._contents.inputs:
            if one.written == written:
                files = [self._crate.get(quote(name)) for name, _ in one.contents()]
                files = [found for found in files if found is not None]
                if files:
                    yield from files
                else:
                    described = {"name": one.name, "value": one.name, "sha256": one.digest[:64]}
                    yield self._add(f"#file-{quote(one.name)}", "PropertyValue", **described)

    def _describe_action(self, main: Any, read: list[Any]) -> None:
        failed = self._contents.record["counts"].get("failed", 0)
        status = "FailedActionStatus" if failed else "CompletedActionStatus"
        error = {"error": f"{failed} steps failed; run/run.json says which"} if failed else {}
        action = self._add(
            "#run",
            "CreateAction",
            name=f"Run of {self._contents.graph}",
            description=self._contents.command,
            instrument=main,
            object=read,
            result=[self._crate.get(quote(name)) for name in self._contents.results],
            startTime=self._began.isoformat(timespec="seconds"),
            endTime=self._ended.isoformat(timespec="seconds"),
            actionStatus=f"http://schema.org/{status}",
            **error,
        )
        self._crate.root_dataset["mentions"] = action

    def _parameter(self, identifier: str, name: str, kind: str) -> Any:
        profile = self._add(
            _PARAMETER, "CreativeWork", name="Bioschemas FormalParameter", version="1.0"
        )
        described = {"name": name, "additionalType": kind, "conformsTo": profile}
        return self._add(identifier, "FormalParameter", **described)

    def _value(self, identifier: str, name: str, value: Any) -> Any:
        plain = value if isinstance(value, (str, int, float)) else json.dumps(value)
        return self._add(identifier, "PropertyValue", name=name, value=plain)

    def _add(self, identifier: str, kind: str, **described: Any) -> Any:
        from rocrate.model import ContextEntity

        there = self._crate.get(identifier)
        if there is not None:
            return there
        properties = {"@type": kind, **described}
        return self._crate.add(ContextEntity(self._crate, identifier, properties))


def _append(entity: Any, name: str, value: Any) -> None:
    """Add a reference, once, to those that an entity has under a name."""
    there = entity.get(name, [])
    known = there if isinstance(there, list) else [there]
    if value not in known:
        entity[name] = [*known, value] if known else value


def _times(contents: Contents) -> tuple[datetime, datetime]:
    """Return when the run began and ended."""
    ended = datetime.fromisoformat(contents.study.created)
    first = contents.files.get(f"run/{EVENTS}", b"").partition(b"\n")[0]
    try:
        began = datetime.fromisoformat(json.loads(first)["began"])
    except (ValueError, LookupError, TypeError):
        return ended - timedelta(seconds=contents.study.seconds), ended
    return began, began + timedelta(seconds=contents.study.seconds)
