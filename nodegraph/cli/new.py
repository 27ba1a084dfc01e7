"""``nodegraph new``: write a plugin package, a graph or a shipped study to start from."""

from __future__ import annotations

import re
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Collection, Iterable, Mapping
from importlib.machinery import PathFinder
from keyword import iskeyword
from pathlib import Path
from typing import TYPE_CHECKING

from nodegraph.cli.arguments import add_plugin
from nodegraph.cli.output import columns, refuse_existing
from nodegraph.errors import NodegraphError, nearest

if TYPE_CHECKING:
    from nodegraph.plugin.registry import Registry

HELP = "Write a plugin package, a graph or a shipped study to start from; without KIND, list them."

_PACKAGE = re.compile(r"[a-z][a-z0-9_]*")
_FILE = re.compile(r"\w([\w .-]*\w)?")
_PLACE = "{{name}}"
_SUFFIX = ".template"


def add_arguments(parser: ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument(
        "kind",
        nargs="?",
        metavar="KIND",
        help="plugin, graph, or another template of a plugin; or a study, such as fill.",
    )
    parser.add_argument(
        "name",
        nargs="?",
        metavar="NAME",
        help="Name of the package, or of the graph file; a study keeps its own.",
    )
    parser.add_argument(
        "--to",
        type=Path,
        default=Path(),
        metavar="DIR",
        help="Folder to write to (default: the current one).",
    )
    add_plugin(parser)


def new(arguments: Namespace) -> int:
    """Write the files of a template under a name, or those of a study."""
    from nodegraph.plugin.registry import Registry

    registry = Registry.installed(arguments.plugin)
    templates, studies = registry.hooks.of("templates"), registry.hooks.graphs
    if arguments.kind is None:
        _list(templates, studies)
        return 0
    study = arguments.kind.removesuffix(".yaml")
    if arguments.kind not in templates:
        if study not in studies:
            hint = nearest(study, [*templates, *studies])
            raise NodegraphError(f"no template or study {arguments.kind!r}; {hint}")
        if arguments.name:
            raise NodegraphError(f"a study keeps its name; write nodegraph new {study}")
        _copy(studies[study], arguments.to)
        return 0
    if not arguments.name:
        raise NodegraphError(f"write nodegraph new {arguments.kind} NAME")
    folder = templates[arguments.kind]
    files = _files(folder, arguments.name)
    if not files:
        raise NodegraphError(f"{folder}: the template {arguments.kind!r} of a plugin has no files")
    if any(path.suffix == ".py" for path in files):
        _check_package_name(arguments.name, registry)
    else:
        _check_file_name(arguments.name, files)
    for target in _write(arguments.to, {path: text.encode() for path, text in files.items()}):
        print(f"wrote {target}")
    return 0


def _list(templates: Iterable[str], studies: Mapping[str, Path]) -> None:
    from nodegraph.graphfile import read_graph_file

    rows = [(name, read_graph_file(path).title) for name, path in studies.items()]
    print(f"{columns(rows)}\n\nnodegraph new STUDY copies one of these to the current folder.")
    print(f"nodegraph new KIND NAME writes an empty one; KIND is {', '.join(sorted(templates))}.")


def _copy(path: Path, folder: Path) -> None:
    from nodegraph.graphfile import read_graph_file

    names = (path.name, *read_graph_file(path).included)
    first, *_ = _write(folder, {Path(name): (path.parent / name).read_bytes() for name in names})
    print(f"wrote {first}; run it with: nodegraph run {first}")


def _write(folder: Path, files: Mapping[Path, bytes]) -> list[Path]:
    """Write files into a folder, all of them or none, and return where they are."""
    targets = {folder / path: content for path, content in files.items()}
    for target in targets:
        refuse_existing(target)
    for target, content in targets.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        target.write_bytes(content)
    return list(targets)


def _check_package_name(name: str, registry: Registry) -> None:
    if not _PACKAGE.fullmatch(name) or iskeyword(name):
        raise NodegraphError(
            f"{name!r} cannot be the name of a package: write lower-case letters, digits and "
            "underscores, beginning with a letter; not a Python keyword"
        )
    owner = _owner(name, registry)
    if owner:
        raise NodegraphError(
            f"{name!r} is the name of {owner}, which a package of that name would overwrite or "
            "hide; choose another name"
        )


def _check_file_name(name: str, files: Collection[Path]) -> None:
    if not _FILE.fullmatch(name):
        raise NodegraphError(
            f"{name!r} is not a portable file name: write letters, digits, '_', '-', '.' and "
            "spaces, with a letter or digit first and last"
        )
    suffix = Path(name).suffix
    if suffix and any(path.name == name + suffix for path in files):
        raise NodegraphError(f"{name!r}: {suffix} is added to the name; write {Path(name).stem!r}")


def _owner(name: str, registry: Registry) -> str:
    """Return what already has the name of a package; empty if nothing has."""
    if any(plugin.name == name for plugin in registry.loaded):
        return "a plugin"
    if name in sys.stdlib_module_names:
        return "a module of Python"
    return "an installed package or module" if _is_installed(name) else ""


def _is_installed(name: str) -> bool:
    from importlib import metadata

    try:
        metadata.distribution(name)
        return True
    except metadata.PackageNotFoundError:
        pass
    # what is in the current folder may be what is written
    current = {"", str(Path.cwd())}
    path = [folder for folder in sys.path if folder not in current]
    finders = (finder for finder in sys.meta_path if finder is not PathFinder)
    return PathFinder.find_spec(name, path) is not None or any(
        finder.find_spec(name, None) is not None for finder in finders
    )


def _files(folder: Path, name: str) -> dict[Path, str]:
    """Return the texts of a template's files by their paths, with the name filled in."""
    texts: dict[Path, str] = {}
    for source in sorted(path for path in folder.rglob("*") if path.is_file()):
        path = source.relative_to(folder).as_posix().replace(_PLACE, name)
        try:
            text = source.read_text(encoding="utf-8")
        except UnicodeDecodeError as error:
            raise NodegraphError(f"{source}: files of a template must be UTF-8 text") from error
        texts[Path(path.removesuffix(_SUFFIX))] = text.replace(_PLACE, name)
    return texts
