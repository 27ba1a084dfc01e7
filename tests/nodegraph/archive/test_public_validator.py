"""Archives pass the public validator of RO-Crates.

Validation reads the vocabularies that a crate names from the network. Here they are served from
memory, as far as an archive uses them; a term that is not listed fails.
"""

from __future__ import annotations

import zipfile
from pathlib import Path
from typing import Any

import pytest

from tests.studies import ROOT, command

# warnings of the validator's libraries
pytestmark = pytest.mark.filterwarnings(
    "ignore::DeprecationWarning:rdflib", "ignore::DeprecationWarning:pyshacl"
)

GRAPH = ROOT / "graphs" / "procrustes_example.yaml"
PROFILE = "workflow-run-crate-0.5"
PROFILES = {PROFILE, "process-run-crate-0.5", "workflow-ro-crate-1.0", "ro-crate-1.1"}
"""It and those from which it inherits."""

SCHEMA = (
    *("ComputerLanguage", "CreateAction", "CreativeWork", "Dataset", "PropertyValue"),
    *("SoftwareApplication", "SoftwareSourceCode", "about", "actionStatus", "additionalType"),
    *("citation", "contentSize", "datePublished", "description", "encodingFormat", "endTime"),
    *("exampleOfWork", "hasPart", "instrument", "license", "mainEntity", "mentions", "name"),
    *("object", "programmingLanguage", "result", "softwareRequirements", "startTime", "value"),
    "version",
)
CRATE = {term: f"http://schema.org/{term}" for term in SCHEMA} | {
    "File": "http://schema.org/MediaObject",
    "ComputationalWorkflow": "https://bioschemas.org/ComputationalWorkflow",
    "FormalParameter": "https://bioschemas.org/FormalParameter",
    "input": "https://bioschemas.org/properties/input",
    "output": "https://bioschemas.org/properties/output",
    "conformsTo": "http://purl.org/dc/terms/conformsTo",
}
WORKFLOW_RUN = {"sha256": "https://w3id.org/ro/terms/workflow-run#sha256"}
VOCABULARIES = {
    "https://w3id.org/ro/crate/1.1/context": CRATE,
    "https://w3id.org/ro/terms/workflow-run/context": WORKFLOW_RUN,
}


class Response:
    """A response of the network with a vocabulary."""

    status_code, ok = 200, True

    def __init__(self, terms: dict[str, str]) -> None:
        self.headers = {"Content-Type": "application/ld+json"}
        self._terms = terms

    def json(self) -> object:
        return {"@context": self._terms}


@pytest.fixture(autouse=True)
def _vocabularies(monkeypatch: pytest.MonkeyPatch) -> None:
    def get(requester: object, url: str, **how: object) -> Response:
        return Response(VOCABULARIES[url])

    from rocrate_validator.utils import http

    monkeypatch.setattr(http.HttpRequester, "get", get, raising=False)


@pytest.fixture(scope="module")
def crate(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("crate")
    for words in (("run", str(GRAPH), "--out", "ran"), ("archive", "ran")):
        ended = command(*words, folder=folder)
        assert ended.status == 0, ended.err
    with zipfile.ZipFile(folder / "ran.zip") as file:
        file.extractall(folder / "crate")
    return folder / "crate"


def validated(crate: Path, **options: bool) -> Any:
    from rocrate_validator import models, services

    settings = services.ValidationSettings(
        rocrate_uri=str(crate),
        profile_identifier=PROFILE,
        requirement_severity=models.Severity.REQUIRED,
        no_cache=True,
        **options,
    )
    return services.validate(settings)


def test_an_archive_is_a_crate_of_its_profiles(crate: Path) -> None:
    result = validated(crate)
    profiles = {check.requirement.profile.identifier for check in result.executed_checks}
    assert profiles == PROFILES
    assert [str(issue.message) for issue in result.get_issues()] == []


def test_the_validator_sees_a_crate_without_its_workflow(crate: Path) -> None:
    metadata = crate / "ro-crate-metadata.json"
    text = metadata.read_text()
    try:
        metadata.write_text(text.replace('"mainEntity"', '"mentions"'))
        assert validated(crate, abort_on_first=True).get_issues()
    finally:
        metadata.write_text(text)
