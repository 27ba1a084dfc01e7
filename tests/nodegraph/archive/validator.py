"""Validate RO-Crates with their public validator: ``python -m tests.nodegraph.archive.validator``.

Validation reads the vocabularies that a crate names from the network. Here they are served from
memory, as far as an archive uses them; a term that is not listed fails. A process of its own gives
back the memory that the libraries of the validator take.
"""

from __future__ import annotations

import json
import sys

from rocrate_validator import models, services
from rocrate_validator.utils import http

PROFILE = "workflow-run-crate-0.5"
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


def get(requester: object, url: str, **how: object) -> Response:
    return Response(VOCABULARIES[url])


def main(*crates: str) -> None:
    """Print a line of JSON for each crate: the profiles that were checked, and the issues."""
    http.HttpRequester.get = get
    for crate in crates:
        settings = services.ValidationSettings(
            rocrate_uri=crate,
            profile_identifier=PROFILE,
            requirement_severity=models.Severity.REQUIRED,
            no_cache=True,
            abort_on_first=True,
        )
        result = services.validate(settings)
        profiles = {check.requirement.profile.identifier for check in result.executed_checks}
        issues = [str(issue.message) for issue in result.get_issues()]
        print(json.dumps({"profiles": sorted(profiles), "issues": issues}))


if __name__ == "__main__":
    main(*sys.argv[1:])
