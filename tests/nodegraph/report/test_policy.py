from __future__ import annotations

import base64
import hashlib

from nodegraph.report.page import policy


def digest(script: str) -> str:
    return base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()


def test_scripts_of_trusted_parts_are_allowed_once_each() -> None:
    parts = [
        "<p>no</p>",
        "<SCRIPT>a &amp; b < c</SCRIPT>",
        "<script>own()</script>",
        "<script>d\r\n</script>",
    ]
    rules = dict(value.split(" ", 1) for value in policy(parts, "own()").split("; "))
    expected = [digest(value) for value in ("own()", "a &amp; b < c", "d\n")]
    assert rules["script-src"] == " ".join(f"'sha256-{script}'" for script in expected)
    assert rules["default-src"] == "'none'"


def test_text_that_only_looks_like_a_script_is_not_allowed() -> None:
    assert policy(
        ["&lt;script>a()&lt;/script>", "<b title='<script>a()</script>'>"], "own()"
    ) == policy([], "own()")
