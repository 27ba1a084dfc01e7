"""``nodegraph new``."""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from keyword import iskeyword
from pathlib import Path

from nodegraph.errors import NodegraphError, nearest
from nodegraph.registry import Registry

_NAME = re.compile(r"[a-z][a-z0-9_]*")
_PLACE = "{{name}}"
_SUFFIX = ".template"


def new(arguments: Namespace) -> int:
    """Write what a template holds, under a name, and say what to do with it."""
    registry = Registry.installed(arguments.plugin)
    templates = registry.templates
    if arguments.kind not in templates:
        raise NodegraphError(
            f"nothing new of kind {arguments.kind!r}; {nearest(arguments.kind, templates)}"
        )
    _check_name(arguments.name, registry)
    files = _filled(templates[arguments.kind], arguments.name)
    taken = [arguments.to / path for path in files if (arguments.to / path).exists()]
    if taken:
        raise NodegraphError(f"{taken[0]} is there already; it is left as it is")
    for path, text in files.items():
        target = arguments.to / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
        print(f"wrote {target}")
    return 0


def _check_name(name: str, registry: Registry) -> None:
    if not _NAME.fullmatch(name) or iskeyword(name):
        raise NodegraphError(
            f"{name!r} cannot be a name here: write small letters, digits and underscores, a "
            "letter first, and no word of Python"
        )
    taken = {plugin.name for plugin in registry.loaded} | set(sys.stdlib_module_names)
    if name in taken:
        raise NodegraphError(
            f"{name!r} is the name of a plugin or of a module of Python; choose another"
        )


def _filled(folder: Path, name: str) -> dict[Path, str]:
    """Return the text of each file, by its path from where it is written."""
    made: dict[Path, str] = {}
    for source in sorted(path for path in folder.rglob("*") if path.is_file()):
        inside = source.relative_to(folder).as_posix().replace(_PLACE, name)
        text = source.read_text(encoding="utf-8")
        made[Path(inside.removesuffix(_SUFFIX))] = text.replace(_PLACE, name)
    return made
