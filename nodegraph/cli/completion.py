"""``nodegraph completion``: print a script with which a shell completes commands and options."""

from __future__ import annotations

import shlex
from argparse import ArgumentParser, Namespace

HELP = "Print a script with which a shell completes commands and options."
MORE = """\
Nodes of `show` and `nodes` are those that were installed when the script was printed.

example, in ~/.bashrc or ~/.zshrc:
  source <(nodegraph completion bash)
"""
_SCRIPT = """\
{start}_nodegraph() {{
  local word=${{COMP_WORDS[COMP_CWORD]}} command=${{COMP_WORDS[1]}} words=
  if [ "$COMP_CWORD" = 1 ]; then
    words={commands}
  else
    case $command in
{cases}
    esac
  fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
}}
complete -o default -F _nodegraph nodegraph
"""
_STARTS = {"bash": "", "zsh": "autoload -U +X bashcompinit && bashcompinit\n"}


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("shell", choices=_STARTS, help="The shell.")


def completion(arguments: Namespace) -> int:
    """Print the script."""
    from nodegraph.cli.main import all_parsers
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed()
    nodes = [entry.node.name for entry in registry]
    operands = {
        "show": [*registry.families, *nodes],
        "new": [*registry.hooks.of("templates"), *registry.hooks.graphs],
    }
    parsers = all_parsers(registry)
    cases = []
    for name, parser in parsers.items():
        options = [option for action in parser._actions for option in action.option_strings]
        words = shlex.quote(" ".join([*options, *operands.get(name, ())]))
        cases.append(f"      {shlex.quote(name)}) words={words} ;;")
    print(
        _SCRIPT.format(
            start=_STARTS[arguments.shell],
            commands=shlex.quote(" ".join(parsers)),
            cases="\n".join(cases),
        ),
        end="",
    )
    return 0
