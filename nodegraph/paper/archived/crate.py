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
from nodegraph.paper.archived.entities import VERSION, Entities
from nodegraph.paper.archived.parameters import Parameters
from nodegraph.report.saved import STUDY

if TYPE_CHECKING:
    from nodegraph.paper.archived.contents import Contents

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
        failed = self._contents.record["counts"].get("failed", 0)
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
