"""Pages of the server's own, with the policy that they state."""

from __future__ import annotations

import html
import json
import re
from collections.abc import Sequence
from http import HTTPStatus
from importlib.resources import files

from starlette.responses import HTMLResponse, Response

from nodegraph.report.page import policy, source, templates_of

_POLICY = re.compile('http-equiv="Content-Security-Policy" content="([^"]*)"')


def page_response(
    template: str,
    status: HTTPStatus = HTTPStatus.OK,
    *,
    scripts: Sequence[str] = (),
    styles: Sequence[str] = (),
    trusted: Sequence[str] = (),
    package: str = "nodegraph.serve",
    **context: object,
) -> Response:
    """Return a page of the server's own, from a template of a package."""
    from markupsafe import Markup

    content = (
        templates_of(package)
        .get_template(template)
        .render(
            policy=policy(trusted, *scripts, connect=True).replace(
                "form-action 'none'", "form-action 'self'"
            ),
            scripts=[Markup(script) for script in scripts],
            styles=[
                Markup(style) for style in (source("page.css"), own_source("serve.css"), *styles)
            ],
            **context,
        )
    )
    return html_response(content, status)


def html_response(content: str, status: HTTPStatus = HTTPStatus.OK) -> Response:
    """Return a page, with the policy that it states, and its forms lead here only."""
    stated = _POLICY.search(content)
    rules = html.unescape(stated[1]) if stated else "default-src 'none'"
    own = f"{rules}; frame-ancestors 'none'"
    return HTMLResponse(
        content.encode(errors="backslashreplace"),
        status,
        headers={"Content-Security-Policy": own},
    )


def own_source(name: str) -> str:
    """Return a style or a script of the server's pages."""
    return files("nodegraph.serve").joinpath("templates", name).read_text(encoding="utf-8")


def json_in_script(value: object) -> str:
    """Return data for a script in a page."""
    return json.dumps(value).replace("<", "\\u003c")
