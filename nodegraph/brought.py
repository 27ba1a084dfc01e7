"""What plugins bring beside nodes: asked once, when it is first needed, and guarded."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from nodegraph import asked, hooks
from nodegraph.guarded import guarded_executor, guarded_place, guarded_specimens
from nodegraph.plugins import Plugin

if TYPE_CHECKING:
    import pluggy

    from nodegraph.hooks import Comparison, Conclusion, Contract, Renderer, Storage
    from nodegraph.source import Source


@dataclass
class Brought:
    """What plugins bring beside nodes.

    Attributes
    ----------
    loaded : list of Plugin
        Those whose hooks are asked.
    """

    loaded: list[Plugin] = field(default_factory=list)

    @cached_property
    def hooks(self) -> pluggy.PluginManager:
        """The pluggy manager of the loaded plugins."""
        return asked.manager(self.loaded)

    @cached_property
    def renderers(self) -> tuple[Renderer, ...]:
        """How values appear in a report; the last plugin comes first."""
        return asked.listed(self.hooks, "nodegraph_renderers", hooks.Renderer)

    @cached_property
    def comparisons(self) -> tuple[Comparison, ...]:
        """How values are told apart; the last plugin comes first."""
        return asked.listed(self.hooks, "nodegraph_comparisons", hooks.Comparison)

    @cached_property
    def conclusions(self) -> tuple[Conclusion, ...]:
        """What a study concludes from values; the last plugin comes first."""
        return asked.listed(self.hooks, "nodegraph_conclusions", hooks.Conclusion)

    @cached_property
    def storages(self) -> tuple[Storage, ...]:
        """How values are kept; the last plugin comes first."""
        return asked.listed(self.hooks, "nodegraph_storages", hooks.Storage)

    @cached_property
    def executors(self) -> Mapping[str, Callable[..., Any]]:
        """Ways to compute steps that plugins bring, by name."""
        return asked.named(self.hooks, "nodegraph_executors", Callable, guarded_executor)

    @cached_property
    def bibtex(self) -> tuple[str, ...]:
        """The BibTeX that each plugin ships."""
        return tuple(text for _, text in asked.results(self.hooks, "nodegraph_bibtex"))

    @cached_property
    def graphs(self) -> Mapping[str, Path]:
        """Example graphs by name."""
        paths = asked.listed(self.hooks, "nodegraph_graphs", Path)
        return {path.stem: path for path in sorted(paths)}

    @cached_property
    def templates(self) -> Mapping[str, Path]:
        """What ``nodegraph new`` writes: folders by kind."""
        return asked.named(self.hooks, "nodegraph_templates", Path)

    def place(self, path: str) -> Path | None:
        """Return where ``scheme:name`` lies, or None when no plugin has the scheme.

        Parameters
        ----------
        path
            As a graph has it.

        Raises
        ------
        NodegraphError
            If the scheme has no such name, or its plugin fails.
        """
        scheme, _, name = path.partition(":")
        finder = self._places.get(scheme) if name else None
        return finder(name) if finder else None

    def contracts(self, family: str) -> Iterator[tuple[Source, Contract]]:
        """Yield what every node of a family promises, and who says so.

        Parameters
        ----------
        family
            The first word of its nodes' names.
        """
        for source, every in asked.results(self.hooks, "nodegraph_contracts"):
            for name, promised in asked.fitting(every, str, Iterable, source):
                if name == family:
                    yield from ((source, one) for one in asked.only(promised, Callable, source))

    def specimens(self) -> Iterator[tuple[type, Callable[[], Mapping[str, Any]]]]:
        """Yield types, and what makes small values of them by name, the last plugin first."""
        for source, makers in asked.results(self.hooks, "nodegraph_specimens"):
            for held, make in asked.fitting(makers, type, Callable, source):
                yield held, guarded_specimens(held, make, source)

    @cached_property
    def _places(self) -> Mapping[str, Callable[[str], Path]]:
        return asked.named(self.hooks, "nodegraph_places", Callable, guarded_place)
