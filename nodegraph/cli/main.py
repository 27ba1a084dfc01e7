"""The command line: words in, one function call each, an exit status out.

Status 0: all well. 1: some step failed. 2: the graph or the command is wrong, and nothing ran.
130: interrupted.
"""

from __future__ import annotations

import gc
import os
import sys
import warnings
from collections.abc import Sequence
from importlib import import_module
from io import TextIOWrapper
from pathlib import Path
from typing import Any

from nodegraph.cli.arguments import parser
from nodegraph.errors import NodegraphError


def program() -> int:
    """Be the program: run the command that it was started with."""
    # most commands end before there is any garbage worth looking for
    gc.set_threshold(50_000, 20, 20)
    status = main()
    gc.freeze()
    gc.disable()
    return status


def main(words: Sequence[str] | None = None) -> int:
    """Run one command and return its exit status."""
    arguments = parser().parse_args(words)
    if isinstance(sys.stdout, TextIOWrapper):
        sys.stdout.reconfigure(errors="backslashreplace")
    with warnings.catch_warnings():
        warnings.simplefilter("default", UserWarning)
        warnings.showwarning = _show_warning
        try:
            module = import_module(f"nodegraph.cli.{arguments.command}")
            status = int(getattr(module, arguments.command)(arguments))
            sys.stdout.flush()
            return status
        except BrokenPipeError:
            # whoever read the output has seen enough; what is left must not be tried again at exit
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            return 0
        except (NodegraphError, OSError) as error:
            print(f"nodegraph: {error}", file=sys.stderr)
            return 2
        except KeyboardInterrupt:
            print("nodegraph: interrupted", file=sys.stderr)
            return 130
        except Exception as error:
            print(f"nodegraph: {_own_mistake(error)}", file=sys.stderr)
            return 1


def _own_mistake(error: Exception) -> str:
    """Return a line for a mistake of this program, with the whole trace where it is wanted."""
    import traceback

    last = traceback.extract_tb(error.__traceback__)[-1]
    where = f"{Path(last.filename).name}:{last.lineno}"
    said = f"{type(error).__name__}: {error} ({where})"
    trace = "".join(traceback.format_exception(error)) if os.environ.get("NODEGRAPH_TRACE") else ""
    hint = "" if trace else "; NODEGRAPH_TRACE=1 shows where it came from"
    return f"{trace}this is a mistake of the program itself, not yours: {said}{hint}"


def _show_warning(message: Warning | str, *rest: Any, **more: Any) -> None:
    print(f"warning: {message}", file=sys.stderr)


if __name__ == "__main__":
    sys.exit(program())
