"""``nodegraph new``."""

from __future__ import annotations

import re
import sys
from argparse import Namespace
from collections.abc import Collection
from importlib import metadata
from importlib.machinery import PathFinder
from keyword import iskeyword
from pathlib import Path

from nodegraph.errors import NodegraphError, nearest
from nodegraph.plugin.registry import Registry

_PACKAGE = re.compile(r"[a-z][a-z0-9_]*")
_FILE = re.compile(r"\w([\w .-]*\w)?")
_PLACE = "{{name}}"
_SUFFIX = ".template"


def new(arguments: Namespace) -> int:
    """Write what a template holds, under a name, and say what to do with it."""
    registry = Registry.installed(arguments.plugin)
    templates = registry.hooks.templates
    if arguments.kind not in templates:
        raise NodegraphError(
            f"nothing new of kind {arguments.kind!r}; {nearest(arguments.kind, templates)}"
        )
    files = _filled(templates[arguments.kind], arguments.name)
    if not files:
        folder = templates[arguments.kind]
        raise NodegraphError(f"{folder}: the template {arguments.kind!r} of a plugin has no files")
    if any(path.suffix == ".py" for path in files):
        _check_package_name(arguments.name, registry)
    else:
        _check_file_name(arguments.name, files)
    taken = [arguments.to / path for path in files if (arguments.to / path).exists()]
    if taken:
        raise NodegraphError(f"{taken[0]} is there already; it is left as it is")
    for path, text in files.items():
        target = arguments.to / path
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_text(text, encoding="utf-8")
        print(f"wrote {target}")
    return 0


def _check_package_name(name: str, registry: Registry) -> None:
    if not _PACKAGE.fullmatch(name) or iskeyword(name):
        raise NodegraphError(
            f"{name!r} cannot be a name here: write small letters, digits and underscores, a "
            "letter first, and no word of Python"
        )
    owner = _owner(name, registry)
    if owner:
        raise NodegraphError(
            f"{name!r} is the name of {owner}, which a package of that name would overwrite or "
            "hide; choose another"
        )


def _check_file_name(name: str, files: Collection[Path]) -> None:
    if not _FILE.fullmatch(name):
        raise NodegraphError(
            f"{name!r} cannot be a file's name everywhere: write letters, digits, '_', '-', '.' "
            "and spaces, a letter or digit first and last"
        )
    suffix = Path(name).suffix
    if suffix and any(path.name == name + suffix for path in files):
        raise NodegraphError(f"{name!r}: {suffix} comes by itself; write {Path(name).stem!r}")


def _owner(name: str, registry: Registry) -> str:
    """Return what has the name of a package already; empty if nothing has."""
    for plugin in registry.loaded:
        if plugin.name == name:
            return "a plugin"
        if getattr(plugin.module, "__name__", "") == name:
            return f"the package of the plugin {plugin.name!r}"
    if name in sys.stdlib_module_names:
        return "a module of Python"
    try:
        return f"the installed package {_with_version(name)}"
    except metadata.PackageNotFoundError:
        pass
    if not _is_found(name):
        return ""
    packages = dict.fromkeys(metadata.packages_distributions().get(name, ()))
    of = " and ".join(map(_with_version, packages))
    return f"a module of the installed package {of}" if of else "a module that Python finds"


def _is_found(name: str) -> bool:
    """Return whether Python finds a module elsewhere than in the folder where we are."""
    here = {"", str(Path.cwd())}
    elsewhere = [one for one in sys.path if one not in here]
    others = (one for one in sys.meta_path if one is not PathFinder)
    return PathFinder.find_spec(name, elsewhere) is not None or any(
        one.find_spec(name, None) is not None for one in others
    )


def _with_version(package: str) -> str:
    found = metadata.distribution(package)
    return f"{found.name} {found.version}"


def _filled(folder: Path, name: str) -> dict[Path, str]:
    """Return the text of each file, by its path from where it is written."""
    made: dict[Path, str] = {}
    for source in sorted(path for path in folder.rglob("*") if path.is_file()):
        inside = source.relative_to(folder).as_posix().replace(_PLACE, name)
        try:
            text = source.read_text(encoding="utf-8")
        except UnicodeDecodeError as error:
            raise NodegraphError(f"{source}: a template's files are text in UTF-8") from error
        made[Path(inside.removesuffix(_SUFFIX))] = text.replace(_PLACE, name)
    return made
