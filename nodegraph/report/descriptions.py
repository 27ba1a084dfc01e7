"""The methods of a study as its page describes them: each once, with what was set first."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass

from nodegraph.report.study import MethodRow, SettingRow


@dataclass(frozen=True, slots=True)
class MethodUse:
    """A method in a node of the graph, with the settings that differ from their defaults."""

    name: str
    settings: tuple[SettingRow, ...]


@dataclass(frozen=True, slots=True)
class Description:
    """A method.

    Attributes
    ----------
    use : str
        Its full name.
    row : MethodRow
        Its texts.
    uses : tuple of MethodUse
        Where the graph has it.
    defaults : tuple of SettingRow
        The settings that have their defaults everywhere.
    """

    use: str
    row: MethodRow
    uses: tuple[MethodUse, ...]
    defaults: tuple[SettingRow, ...]

    @property
    def sources(self) -> list[tuple[str, str]]:
        """The reference as it is printed, and the key of its entry."""
        texts = self.row.citation.splitlines()
        keys = [*self.row.keys, *[""] * len(texts)]
        return list(zip(texts, keys, strict=False))


def descriptions(methods: Iterable[MethodRow]) -> tuple[Description, ...]:
    """Return the methods, each once, in the order of the graph."""
    rows: dict[str, list[MethodRow]] = {}
    for row in methods:
        rows.setdefault(row.use, []).append(row)
    return tuple(_description(use, of_use) for use, of_use in rows.items())


def _description(use: str, rows: list[MethodRow]) -> Description:
    uses = [
        MethodUse(
            f"{row.node}={row.label}" if row.label else row.node,
            tuple(setting for setting in row.settings if not setting.default),
        )
        for row in rows
    ]
    changed = {setting.name for each in uses for setting in each.settings}
    defaults = [setting for setting in rows[0].settings if setting.name not in changed]
    return Description(use, rows[0], tuple(uses), tuple(defaults))


def shared_meanings(methods: Iterable[Description]) -> tuple[SettingRow, ...]:
    """Return the settings that several methods have, and describe in the same words."""
    described = [
        (setting.name, setting.unit, setting.meaning)
        for method in methods
        for setting in {each.name: each for each in method.row.settings}.values()
        if setting.meaning
    ]
    return tuple(
        SettingRow(name, "", unit, meaning=meaning)
        for (name, unit, meaning), count in Counter(described).items()
        if count > 1
    )
