"""The program: parse the words of a command line, run the command, return the exit status.

Status 0: success. 1: a step failed, or the command says so in its help. 2: the graph or the
command is not valid; nothing has run. 130: interrupted.
"""

from __future__ import annotations

import gc
import os
import shlex
import sys
import warnings
from argparse import SUPPRESS, Action, ArgumentParser, Namespace, RawDescriptionHelpFormatter
from collections.abc import Callable, Mapping, Sequence
from importlib import import_module
from io import TextIOWrapper
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, NoReturn

from nodegraph.cli import ending
from nodegraph.cli.arguments import add_plugin
from nodegraph.errors import GraphError, NodegraphError, Place, closest, nearest

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry

COMMANDS = (
    "run", "check", "edit", "live", "fetch", "draw", "show", "view", "new", "diff", "lock",
    "verify", "export", "open", "report", "runs", "site", "cite", "archive", "cache", "schema",
    "completion",
)  # fmt: skip
"""Modules of this package, each with a function of its name, `HELP` and `add_arguments`.

`MORE` follows `HELP` in the help of the command, in lines as they are.
"""

_EXCERPT = 60  # characters of a line that are shown on either side of an error


class _Command(NamedTuple):
    help: str
    add_arguments: Callable[[ArgumentParser], None]
    call: Callable[[Namespace], int]
    more: str = ""


def program() -> NoReturn:
    """Run the command that the process was started with, and end the process."""
    # most commands end before collecting garbage would pay
    gc.set_threshold(600_000, 20, 20)
    ending.begin()
    try:
        status = main()
    except SystemExit as ended:  # of argparse
        status = int(ended.code or 0)
    gc.freeze()
    gc.disable()
    ending.end_with(status)


def main(words: Sequence[str] | None = None) -> int:
    """Run a command and return its exit status."""
    words = list(sys.argv[1:] if words is None else words)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    with warnings.catch_warnings():
        warnings.simplefilter("default", UserWarning)
        warnings.showwarning = _show_warning
        try:
            commands = _commands(words)
            if not words or words[0] == "help":
                words = [*words[1:], "--help"]
            arguments = _parsed(commands, words)
            status = int(commands[arguments.command].call(arguments))
            sys.stdout.flush()
            return status
        except BrokenPipeError:
            # the reader of the output has closed it; Python must not flush it again at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 0
        except (NodegraphError, OSError) as error:
            text = _with_excerpts(error) if isinstance(error, GraphError) else error
            print(f"nodegraph: {text}", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            print("nodegraph: interrupted", file=sys.stderr)
            return 130
        except Exception as error:
            print(f"nodegraph: {_internal_error(error)}", file=sys.stderr)
            return 1


def _with_excerpts(error: GraphError) -> str:
    """Return the first errors of a graph, each with its line and a caret below the column."""
    texts: list[str] = []
    files = {problem.place.file for problem in error.first if problem.place.line}
    lines = {file: _lines_of(file) for file in files}
    for problem in error.first:
        text, _, hint = str(problem).partition("\n")
        place = problem.place
        line = "".join(lines[place.file][place.line - 1 : place.line]) if place.line else ""
        texts += [text, *_excerpt(place, line.rstrip()), *([hint] if hint else [])]
    return "\n".join([*texts, *error.more])


def _lines_of(file: str) -> list[str]:
    if not os.path.isfile(file):
        return []
    try:
        with open(file, encoding="utf-8", errors="replace") as stream:
            return stream.readlines()
    except OSError:
        return []


def _excerpt(place: Place, line: str) -> list[str]:
    start = max(place.column - _EXCERPT, 0)
    shown = "".join(each if each.isprintable() else " " for each in line[start:][: 2 * _EXCERPT])
    number = f"{place.line:>5} | "
    return [f"{number}{shown}", f"{'':>5} | {' ' * (place.column - 1 - start)}^"] if shown else []


def _parsed(commands: Mapping[str, _Command], words: Sequence[str]) -> Namespace:
    """Return the arguments of a command; a mistyped one is answered with the nearest there is."""
    parser, _ = _parsers(commands, words)
    if words and not words[0].startswith("-") and words[0] not in commands:
        is_graph = words[0].endswith((".yaml", ".yml"))
        run = shlex.join(["nodegraph", "run", *words])
        hint = f"to run a graph, write: {run}" if is_graph else nearest(words[0], commands)
        parser.error(f"no command {words[0]!r}; {hint}")
    arguments, rest = parser.parse_known_args(words)
    if rest:
        options = [place for place, word in enumerate(rest) if word.startswith("-")]
        hints = [_instead_of_option(rest[place:], arguments) for place in options]
        arguments.parser.error("; ".join(hints) or f"too many arguments: {' '.join(rest)}")
    return arguments


def _instead_of_option(words: Sequence[str], arguments: Namespace) -> str:
    """Return that there is no such option as the first of the words, and what there is instead."""
    option, _, value = words[0].partition("=")
    known = list(arguments.parser._option_string_actions)
    choices = _choices_of(arguments.graph) if "--set" in known else {}
    name = option.removeprefix("--")
    if name not in choices:
        is_option = closest(name, [each.lstrip("-") for each in known])
        name = "" if is_option else closest(name, choices)
    if not name:
        return f"no option {option}; {nearest(option, known)}"
    what, instead = choices[name]
    word = shlex.quote(f"{name}={value or ' '.join(words[1:2]) or 'VALUE'}")
    return f"no option {option}; {name!r} is {what} of the graph: write {instead} {word}"


def _choices_of(path: Path) -> dict[str, tuple[str, str]]:
    """Return what the names in a graph file are that options choose by, and the options."""
    from nodegraph.graphfile import read_graph_file

    try:
        spec = read_graph_file(path)
    except GraphError:
        return {}
    methods = [name for name, node in spec.nodes.items() if node.has_alternatives]
    return {
        **dict.fromkeys(spec.inputs, ("an input", "--set")),
        **dict.fromkeys(spec.axes, ("an axis", "--axis")),
        **dict.fromkeys(methods, ("a node with alternatives", "--only")),
    }


def _commands(words: Sequence[str]) -> Mapping[str, _Command]:
    """Return the commands among which the first word chooses.

    For a word that is a built-in command that is this one alone, so that nothing else is
    imported. Plugins are imported only for another word, never for options such as ``--help``.
    """
    word = words[0] if words else "-"
    if word in COMMANDS:
        return {word: _built_in(word)}
    if word.startswith("-"):
        return {name: _built_in(name) for name in COMMANDS}
    from nodegraph.plugin.registry import Registry

    options = ArgumentParser(add_help=False, allow_abbrev=False)
    add_plugin(options)
    return _all_commands(Registry.installed(options.parse_known_args(words)[0].plugin))


def all_parsers(registry: Registry) -> Mapping[str, ArgumentParser]:
    """Return a parser for each command, those of plugins included, as documentation needs it."""
    commands = _all_commands(registry)
    _, parsers = _parsers(commands, list(commands))
    return parsers


def _all_commands(registry: Registry) -> Mapping[str, _Command]:
    commands = {name: _built_in(name) for name in COMMANDS}
    added = registry.hooks.of("commands")
    for name in added.keys() & commands.keys():
        warnings.warn(f"command {name!r} of a plugin is left out: it is built in", stacklevel=2)
    return commands | {
        name: _Command(command.help, command.add_arguments, command.call)
        for name, command in added.items()
        if name not in commands
    }


def _built_in(name: str) -> _Command:
    module = import_module(f"nodegraph.cli.{name}")
    more = getattr(module, "MORE", "")
    return _Command(module.HELP, module.add_arguments, getattr(module, name), more)


def _parsers(
    commands: Mapping[str, _Command], words: Sequence[str]
) -> tuple[ArgumentParser, Mapping[str, ArgumentParser]]:
    """Return the parser of all commands, and of each; those that words name have arguments."""
    parser = ArgumentParser(
        prog="nodegraph",
        description="Compare methods that process facial motion capture.",
        epilog="Plugins may add commands; 'nodegraph help' lists them as well.",
        allow_abbrev=False,
        add_help=False,
    )
    _add_help(parser)
    parser.add_argument(
        "--version",
        action=_Version,
        nargs=0,
        default=SUPPRESS,
        help="Show the version and exit.",
    )
    choices = parser.add_subparsers(
        title="commands", dest="command", required=True, metavar="COMMAND"
    )
    for name, command in commands.items():
        choice = choices.add_parser(
            name,
            description=command.help,
            help=command.help.replace("%", "%%"),
            allow_abbrev=False,
            add_help=False,
        )
        if name in words:
            _declare(choice, name, command)
    return parser, choices.choices


def _declare(parser: ArgumentParser, name: str, command: _Command) -> None:
    """Add the arguments of a command."""
    _add_help(parser)
    if command.more:
        parser.description = f"{command.help}\n\n{command.more}"
        parser.formatter_class = RawDescriptionHelpFormatter
    if name not in COMMANDS:
        add_plugin(parser)
    command.add_arguments(parser)
    parser.set_defaults(parser=parser)


def _add_help(parser: ArgumentParser) -> None:
    parser.add_argument("-h", "--help", action="help", help="Show this help and exit.")


class _Version(Action):
    """Print the version, which is looked up only then."""

    def __call__(self, parser: ArgumentParser, *rest: object) -> None:
        from importlib import metadata

        print(f"nodegraph {metadata.version('nodegraph')}")
        parser.exit()


def _internal_error(error: Exception) -> str:
    """Return a line for an error of the program itself, after its traceback if requested."""
    import traceback

    last = traceback.extract_tb(error.__traceback__)[-1]
    text = f"{type(error).__name__}: {error} ({Path(last.filename).name}:{last.lineno})"
    text = f"internal error; please report it: {text}"
    if os.environ.get("NODEGRAPH_TRACE"):
        return "".join([*traceback.format_exception(error), text])
    return f"{text}; NODEGRAPH_TRACE=1 shows the trace"


def _show_warning(message: Warning | str, *rest: object, **more: object) -> None:
    print(f"warning: {message}", file=sys.stderr)


if __name__ == "__main__":
    program()
