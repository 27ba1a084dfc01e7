"""The reference of commands, from the parsers of their arguments."""

from __future__ import annotations

from argparse import SUPPRESS, Action, ArgumentParser
from collections.abc import Mapping
from html import escape

from nodegraph.site.page import Entry, Page
from nodegraph.site.prose import blocks_html, inline_html, table


def command_page(parsers: Mapping[str, ArgumentParser]) -> Page:
    """Return the page of all commands."""
    names = {name: _description(parser).partition("\n")[0] for name, parser in parsers.items()}
    rows = [
        (f'<a href="#{escape(name)}"><code>nodegraph {escape(name)}</code></a>', escape(text))
        for name, text in names.items()
    ]
    parts = ["<h1>Commands</h1>", table(("command", "what it does"), rows)]
    parts += [_command(name, parser) for name, parser in parsers.items()]
    entries = tuple(Entry(f"nodegraph {name}", text, name) for name, text in names.items())
    return Page("commands.html", "Commands", "\n".join(parts), entries)


def _command(name: str, parser: ArgumentParser) -> str:
    usage = " ".join(parser.format_usage().split()).removeprefix("usage: ")
    rows = [
        (f"<code>{escape(_form(action))}</code>", inline_html(_help(action, parser)))
        for action in parser._actions
        if action.help != SUPPRESS
    ]
    return "\n".join(
        [
            f'<section id="{escape(name)}">',
            f"<h2><code>nodegraph {escape(name)}</code></h2>",
            blocks_html(_description(parser)),
            f'<pre class="command" tabindex="0"><code>{escape(usage)}</code></pre>',
            table(("argument", "meaning"), rows),
            "</section>",
        ]
    )


def _description(parser: ArgumentParser) -> str:
    return parser.description or ""


def _form(action: Action) -> str:
    """Return an argument as it is typed: ``-q, --quiet`` or ``--out DIR``."""
    value = action.metavar or action.dest.upper()
    text = value if isinstance(value, str) else " ".join(value)
    if not action.option_strings:
        return text
    options = ", ".join(action.option_strings)
    return options if action.nargs == 0 else f"{options} {text}"


def _help(action: Action, parser: ArgumentParser) -> str:
    return (action.help or "") % {**vars(action), "prog": parser.prog}
