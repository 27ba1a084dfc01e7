"""The charts of a comparison in a browser: what they draw, what keys and clicks do, odd data."""

from __future__ import annotations

import base64
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest
from numpy.typing import NDArray
from playwright.sync_api import Page
from scipy.stats import gmean, rankdata

from nodegraph import Across, Detail, Kind, Label, Rendered, json_script
from nodegraph.report.page import page
from nodegraph.report.study import Section, Study
from nodegraph_compare import nodegraph_kinds
from nodegraph_compare.overview.value import Overview
from nodegraph_compare.table.node import table as table_of
from nodegraph_mocap import Table
from nodegraph_tables import TableInfo, with_info
from tests.browser import load, middle, needs_axe, resize, until, violations

RECIPES = ("plain", "rich", "vegan", "nut", "rye")
FACTORS = {180: (1.0, 1.02, 1.6, 2.0, 3.0), 220: (2.0, 1.0, 1.7, 2.4, 2.6)}
SHELVES = tuple(f"{side}{row}" for side in "LR" for row in range(3))
SUSPECTS = (4, 9)
LINE = "[data-chart=ranking] .line-chart g[role=button][data-method=%s]"
CELLS = (
    "[...document.querySelectorAll('.heat tbody tr[data-method=%s] td:not(.aside)')]"
    ".map((cell) => cell.querySelector('button').firstChild.textContent)"
)
COUNT = "document.querySelectorAll(%r).length"


@dataclass(frozen=True)
class Bakery:
    """The origin of an overview in a run."""

    node: str = "recipes"
    labels: Mapping[str, object] = field(default_factory=dict)
    caption: str = ""
    answer: tuple[str, ...] = ()
    view: Detail | None = None
    gathered: Mapping[str, Iterable[object]] = field(
        default_factory=lambda: {"kitchen": range(8), "heat": FACTORS, "recipe": RECIPES}
    )

    def seconds(self, axis: str) -> Mapping[Label, Sequence[float]]:
        return {recipe: [0.001 * 3**at] * 4 for at, recipe in enumerate(RECIPES)}

    def summaries(self, axis: str) -> Mapping[Label, str]:
        return {}

    def open_axes(self, labels: Mapping[str, object]) -> Mapping[str, tuple[object, ...]]:
        return {axis: tuple(of) for axis, of in self.gathered.items() if axis not in labels}

    def inputs(self, labels: Mapping[str, object]) -> Mapping[str, object] | None:
        return None if self.open_axes(labels) else {"oven": 1.0}

    def detail(self, value: object) -> Detail | None:
        return self.view if isinstance(value, float) else None

    def command(self, labels: Mapping[str, object]) -> str:
        return "nodegraph run bake.yaml " + " ".join(f"--only {k}={v}" for k, v in labels.items())


def wastes() -> dict[tuple[int, int, str], NDArray[np.float64]]:
    """Sixty cakes of each recipe by kitchen and heat, ten on each shelf."""
    random = np.random.default_rng(1)
    errors = {}
    for kitchen in range(8):
        for heat, factors in FACTORS.items():
            base = random.lognormal(sigma=0.5, size=12)
            for recipe, factor in zip(RECIPES, factors, strict=True):
                errors[kitchen, heat, recipe] = base * factor * random.uniform(0.95, 1.05, 12)
    return errors


WASTES = wastes()


def scores() -> Across[Table]:
    entries: list[tuple[dict[str, Label], Table]] = []
    for (kitchen, heat, recipe), waste in WASTES.items():
        frame = pd.DataFrame(
            {
                "cake": np.arange(12),
                "shelf": [SHELVES[at % 6] for at in range(12)],
                "waste": waste,
                "mess": waste**2,
                "suspect": ["the scale slipped" if at in SUSPECTS else "" for at in range(12)],
            }
        )
        info = TableInfo(units={"waste": "g"}, better={"waste": "lower", "mess": "lower"})
        labels: dict[str, Label] = {"kitchen": kitchen, "heat": heat, "recipe": recipe}
        entries.append((labels, with_info(frame, info)))
    return Across(
        ("kitchen", "heat", "recipe"), tuple(entries), sources=("kitchen",), units={"heat": "K"}
    )


def overview() -> Overview:
    result: Overview = table_of(
        scores(), metric="waste", compare="recipe", within=("heat",), blocks=("cake", "shelf")
    ).overview
    return result


def shelves(inputs: Mapping[str, object], column: str) -> Mapping[str, object] | None:
    if column != "shelf":
        return None
    return {
        "title": "in the oven",
        "names": list(SHELVES),
        "points": [[at // 3, at % 3] for at in range(6)],
        "edges": [[0, 1], [1, 2], [3, 4], [4, 5], [0, 3]],
        "regions": {"left": [0, 1, 2], "right": [3, 4, 5]},
    }


def pack(block: Mapping[str, object], inputs: Mapping[str, object]) -> Mapping[str, object]:
    return {name: str(block[name]) for name in ("cake", "heat")}


VIEW = """nodegraph.define("bakery/cake", [], () => ({
  show: (stage, { cake, heat }) => {
    const shown = Object.assign(document.createElement("p"), { className: "errors" });
    shown.textContent = `cake ${cake} heat ${heat}`;
    stage.replaceChildren(shown);
  },
}));"""
PROBE = """nodegraph.define("probe", ["compare/scale"], (scales) => { window.scales = scales; });"""


def saved(folder: Path, rendered: Rendered, **more: Any) -> Path:
    file = folder / "report.html"
    study = Study("Which recipe wastes least?", sections=(Section("recipes", rendered),))
    file.write_text(page(study, **more), encoding="utf-8")
    return file


def in_run(compared: Overview, **origin: Any) -> Rendered:
    """A comparison in a run."""
    (render,) = (
        each.render_in_run
        for each in nodegraph_kinds()
        if isinstance(each, Kind) and each.type is Overview
    )
    assert render is not None
    detail = Detail(pack, shelves, "bakery/cake", scripts=(VIEW, PROBE))
    return render(compared, "Recipes", Bakery(view=detail, **origin))


@pytest.fixture(scope="module")
def recipes() -> Rendered:
    """The comparison of recipes in a run."""
    return in_run(overview())


@pytest.fixture(scope="module")
def bakery(tmp_path_factory: pytest.TempPathFactory, recipes: Rendered) -> Path:
    """The report of the comparison of recipes."""
    return saved(tmp_path_factory.mktemp("bakery"), recipes)


def mean_over_kitchens(recipe: str, heat: int, cakes: list[int]) -> float:
    return float(gmean([WASTES[kitchen, heat, recipe][cakes].mean() for kitchen in range(8)]))


def mean_rank(kitchen: int, heat: int, recipe: str) -> float:
    wasted = np.array([WASTES[kitchen, heat, each] for each in RECIPES])
    return float((rankdata(wasted, axis=0)[RECIPES.index(recipe)]).mean())


def text(tab: Page, selector: str) -> str:
    return str(tab.evaluate(f"document.querySelector({selector!r}).textContent"))


def choose(tab: Page, label: str, value: str) -> None:
    tab.evaluate(
        "{ const select = [...document.querySelectorAll('.control-bar label')]"
        f".find((each) => each.textContent.startsWith({label!r})).querySelector('select');"
        f"select.value = {value!r}; select.dispatchEvent(new Event('change')); }}"
    )


def numbers(cells: list[str]) -> list[float]:
    return [float(cell) for cell in cells]


def test_the_charts_show_the_numbers_of_the_table(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    for recipe in RECIPES:
        means = [mean_over_kitchens(recipe, heat, list(range(12))) for heat in FACTORS]
        assert numbers(tab.evaluate(CELLS % recipe)) == pytest.approx(means, rel=6e-3)
        assert tab.evaluate(COUNT % (LINE % recipe)) == 1
    best = tab.evaluate(
        "[...document.querySelectorAll('.heat td.first')]"
        ".map((cell) => cell.closest('tr').dataset.method)"
    )
    assert sorted(best) == ["plain", "rich"]
    bars = "[...document.querySelectorAll('.interval')].filter((bar) => bar.checkVisibility())"
    ends = tab.evaluate(f"{bars}.map((bar) => ['y1', 'y2'].map((y) => +bar.getAttribute(y)))")
    assert len(ends) == len(best) * len(FACTORS)
    assert all(low > high for low, high in ends)
    assert tab.evaluate(COUNT % ".cost-chart g.method") == len(RECIPES)
    assert tab.evaluate(COUNT % ".map-chart circle.disc[data-marker]") == 6 * len(
        tab.evaluate("[...document.querySelectorAll('.map')].map(() => 1)")
    )
    assert "rich" in text(tab, "[data-chart=cost]") + text(tab, "[data-chart=blocks]")


def test_a_method_is_selected_everywhere_and_cleared_by_a_second_click(
    tab: Page, bakery: Path
) -> None:
    load(tab, bakery)
    for clicks in (1, 2):
        tab.click(f"{LINE % 'rye'} + g text")
        marks = tab.evaluate(
            "[...document.querySelectorAll('.selected')].map((mark) => mark.closest('[data-chart]')"
            "?.dataset.chart ?? 'lead')"
        )
        assert set(marks) == (
            {"lead", "ranking", "cost", "blocks", "layout"} if clicks == 1 else set()
        )
        assert ("rye" in tab.evaluate("location.hash")) is (clicks == 1)
    tab.evaluate("location.hash = '#select:method=nut&group=0'")
    assert tab.evaluate(f"document.querySelector({LINE % 'nut'!r}).matches('.selected')")
    assert text(tab, ".segments [aria-checked=true]") == "180\N{NO-BREAK SPACE}K"


def test_pointing_changes_no_number(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    before = text(tab, "[data-overview]")
    x, y = middle(tab, f"{LINE % 'vegan'} + g text")
    tab.mouse.move(x, y)
    assert tab.evaluate("document.querySelector('.line-chart .plot').matches('.dim')")
    assert "vegan" in text(tab, ".chart-note.visible")
    assert text(tab, "[data-overview]") == before
    assert tab.evaluate("location.hash") == ""


def test_a_filter_recomputes_what_is_described_and_says_so(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    lead = tab.evaluate("document.querySelector('.lead').innerHTML")
    kept = [1, 7]
    for statistic in ("mean", "median"):
        choose(tab, "Statistic", statistic)
        tab.click(".map-chart circle[data-marker=L1]")
        for recipe in RECIPES:
            wanted = [
                mean_over_kitchens(recipe, heat, kept)
                if statistic == "mean"
                else float(np.median([WASTES[k, heat, recipe][kept] for k in range(8)]))
                for heat in FACTORS
            ]
            assert numbers(tab.evaluate(CELLS % recipe)) == pytest.approx(wanted, rel=6e-3)
        assert "16 blocks; this explores" in text(tab, ".filter-note")
        assert tab.evaluate(COUNT % ".heat td.tied") == 0
        tab.click(".chip")
        assert text(tab, ".filter-note") == ""
        assert tab.evaluate("document.querySelector('.lead').innerHTML") == lead


def test_suspects_are_left_out(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.click(".control-bar .toggle")
    kept = [at for at in range(12) if at not in SUSPECTS]
    means = [mean_over_kitchens("nut", heat, kept) for heat in FACTORS]
    assert numbers(tab.evaluate(CELLS % "nut")) == pytest.approx(means, rel=6e-3)
    assert "80 blocks" in text(tab, ".filter-note")
    tab.click(".chip.clear")
    assert text(tab, ".filter-note") == ""


def test_ranks_and_other_metrics(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    choose(tab, "Statistic", "rank")
    ranks = [np.mean([mean_rank(kitchen, heat, "rye") for kitchen in range(8)]) for heat in FACTORS]
    assert numbers(tab.evaluate(CELLS % "rye")) == pytest.approx(ranks, rel=6e-3)
    tab.click(".control-bar .toggle")
    assert numbers(tab.evaluate(CELLS % "rye")) == pytest.approx(ranks, rel=0.05)
    tab.click(".control-bar .toggle")
    choose(tab, "Statistic", "mean")
    choose(tab, "Metric", "mess")
    squares = [
        gmean([(WASTES[kitchen, heat, "rye"] ** 2).mean() for kitchen in range(8)])
        for heat in FACTORS
    ]
    assert numbers(tab.evaluate(CELLS % "rye")) == pytest.approx(squares, rel=6e-3)


def test_marks_and_heads_are_used_by_keys(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.evaluate("document.querySelector('.line-chart g[tabindex=\"0\"]').focus()")
    first = tab.evaluate("document.activeElement.dataset.method")
    tab.keyboard.press("ArrowDown")
    second = tab.evaluate("document.activeElement.dataset.method")
    assert first != second
    tab.keyboard.press("Enter")
    assert tab.evaluate("document.activeElement.dataset.method") == second
    assert tab.evaluate("document.activeElement.ariaPressed") == "true"
    assert tab.evaluate(COUNT % ".line-chart g[tabindex='0']") == 1
    tab.evaluate("document.querySelector('.heat thead button').focus()")
    tab.keyboard.press("Enter")
    names = "[...document.querySelectorAll('.heat tbody tr')].map((row) => row.dataset.method)"
    assert tab.evaluate(names) == sorted(RECIPES)
    tab.keyboard.press("Enter")
    assert tab.evaluate(names) == sorted(RECIPES, reverse=True)
    assert (
        tab.evaluate("document.querySelector('.heat thead th[aria-sort]').ariaSort") == "descending"
    )


def test_a_dot_opens_its_block(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.evaluate("document.querySelector('.dots canvas').focus()")
    tab.keyboard.press("ArrowLeft")
    live = "document.querySelector('[aria-live=polite]').textContent"
    assert "96 of 96: " in tab.evaluate(live)
    tab.keyboard.press("ArrowLeft")
    assert "95 of 96: " in tab.evaluate(live)
    tab.keyboard.press("Enter")
    assert tab.evaluate("document.querySelector('dialog').open")
    worst = sorted(((*key, at) for key in WASTES for at in range(12) if key[1:] == (220, "rich")),
                   key=lambda item: WASTES[item[:3]][item[3]])  # fmt: skip
    kitchen, _, _, cake = worst[-2]
    head = text(tab, "dialog .head")
    assert f"kitchen {kitchen}" in head
    assert f"cake {cake}" in head
    bars = tab.evaluate(
        "[...document.querySelectorAll('.bars button')]"
        ".map((bar) => [bar.dataset.method, Number(bar.lastChild.textContent)])"
    )
    assert dict(bars) == pytest.approx(
        {recipe: WASTES[kitchen, 220, recipe][cake] for recipe in RECIPES}, rel=6e-3
    )
    assert f"--only kitchen={kitchen}" in text(tab, "dialog code")
    tab.keyboard.press("PageUp")
    assert f"cake {worst[-1][3]}" in text(tab, "dialog .head")
    tab.keyboard.press("Escape")
    until(tab, "['', '#'].includes(location.hash)")  # the page hears of it some tasks later
    assert not tab.evaluate("document.querySelector('dialog').open")
    assert tab.evaluate("document.activeElement.tagName") == "CANVAS"


def test_a_number_of_the_table_and_a_place_open_the_worst_block(tab: Page, bakery: Path) -> None:
    load(tab, bakery)

    def is_worst(recipe: str, heat: int, cakes: list[int]) -> None:
        waste, kitchen, cake = max(
            (WASTES[kitchen, heat, recipe][at], kitchen, at) for kitchen in range(8) for at in cakes
        )
        head = text(tab, "dialog[open] .head")
        assert f"heat {heat}" in head
        assert f"kitchen {kitchen} \u00b7 cake {cake}" in head
        bar = tab.text_content(f".bars [data-method={recipe}] span:last-child")
        assert numbers([bar or ""]) == pytest.approx([waste], rel=6e-3)
        tab.keyboard.press("Escape")

    tab.click(".heat tr[data-method=vegan] td >> nth=0")
    is_worst("vegan", 180, [*range(12)])
    tab.focus(".heat tr[data-method=vegan] td button >> nth=0")
    order = tab.locator(".heat tbody tr").evaluate_all(
        "(rows) => rows.map((r) => r.dataset.method)"
    )
    below = order[order.index("vegan") + 1]
    for key in ("ArrowDown", "ArrowRight", "Enter"):
        tab.keyboard.press(key)
    is_worst(below, 220, [*range(12)])
    tab.focus("circle[data-marker=L1]")
    tab.keyboard.press("Enter")
    tab.click(".map-chart .here button >> nth=0")
    is_worst("rich", 220, [1, 7])


def test_focus_that_moves_on_when_a_block_closes_stays(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.click(".heat tr[data-method=vegan] td button >> nth=0")
    stays = tab.evaluate("""async () => {
      const dialog = document.querySelector("dialog[open]");
      const disc = document.querySelector("circle[data-marker=L1]");
      const closed = new Promise((resolve) => dialog.addEventListener("close", resolve));
      dialog.close();
      const back = document.activeElement.closest("tr").dataset.method;
      disc.focus();
      await closed;
      return [back, document.activeElement === disc];
    }""")
    assert stays == ["vegan", True]


def test_a_suggested_block_is_shown_by_the_plugin(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.click(".suggestion.suspect")
    assert "the scale slipped" in text(tab, "dialog .suspect")
    assert re.fullmatch(r"cake \d+ heat 220", text(tab, "dialog .stage"))
    tab.click("dialog .bars button >> nth=1")
    assert re.fullmatch(r"cake \d+ heat 220", text(tab, "dialog .stage"))
    assert tab.locator("dialog .bars").count() == 1


SERVER = """nodegraph.define("server", [], () => ({
  get: async (path, { node, block, methods, now }) => {
    if (!now) throw Object.assign(new Error("may differ"), { changed: ["the oven was edited"] });
    return { cake: [path, node, block.cake, methods.length], heat: block.heat };
  },
}));"""


def test_other_blocks_come_from_a_server_or_say_how_they_are_seen(
    tab: Page, bakery: Path, recipes: Rendered, tmp_path: Path
) -> None:
    stage = "document.querySelector('dialog .stage')"
    served = saved(tmp_path, recipes, server=SERVER)
    for file, shown in ((bakery, "nodegraph open"), (served, "the oven was edited")):
        load(tab, file)
        packed = tab.evaluate("JSON.parse(document.getElementById('overview-recipes').textContent)")
        blocks = set(map(str, range(96))) - {
            key.split("/")[1] for key in packed["detail"]["packed"]
        }
        block = min(blocks, key=int)
        tab.evaluate(f"location.hash = '#select:block={block}'")
        tab.evaluate("new Promise((resolve) => setTimeout(resolve, 20))")
        assert shown in tab.evaluate(f"{stage}.textContent")
    cake = re.search(r"cake (\d+)", text(tab, "dialog .head"))
    assert cake is not None
    tab.click("dialog .stage button")
    assert tab.evaluate(f"{stage}.textContent") == f"cake detail,recipes,{cake[1]},5 heat 220"


def test_a_suggestion_follows_the_method_that_it_names_if_that_has_no_role(
    tab: Page, bakery: Path
) -> None:
    load(tab, bakery)
    suggestion = tab.locator(".suggestion.suspect").first
    named = suggestion.inner_text().rpartition("\u00b7 ")[2].split()[0]
    for statistic, follows in (("mean", False), ("median", True)):  # medians have no best
        choose(tab, "Statistic", statistic)
        suggestion.click()
        assert (f"method={named}" in tab.url) is follows
        tab.keyboard.press("Escape")


def test_a_frame_stays_in_the_address_as_long_as_its_block_is_open(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.evaluate("location.hash = '#select:block=5&frame=7&method=nut'")
    until(tab, "document.querySelector('dialog').open")
    tab.click("dialog .bars button >> nth=0")
    assert "frame=7" in tab.url
    tab.click("dialog .steps button:enabled >> nth=0")
    assert "block=" in tab.url
    assert "frame=" not in tab.url


def test_of_a_block_that_averages_over_an_axis_its_members_are_shown(
    tab: Page, tmp_path: Path
) -> None:
    over_heats = table_of(scores(), metric="waste", compare="recipe", blocks=("cake", "shelf"))
    load(tab, saved(tmp_path, in_run(over_heats.overview), server=SERVER))
    tab.click(".suggestion >> nth=0")
    assert "Mean over heat" in text(tab, "dialog .members")
    stage = "dialog .stage"
    assert text(tab, stage).endswith("heat 180")
    tab.select_option("dialog .members select", "220")
    assert tab.evaluate("document.activeElement.name") == "heat"
    tab.click("dialog .stage button")
    assert text(tab, stage).endswith("heat 220")
    assert "--only heat=220" in text(tab, "dialog code")


def test_a_phone_shows_all_without_scrolling_sideways(tab: Page, bakery: Path) -> None:
    load(tab, bakery, width=390)
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390
    assert not tab.evaluate("document.querySelector('.control-bar .filters').checkVisibility()")
    tab.click(".more-controls")
    assert tab.evaluate("document.querySelector('.control-bar .filters').checkVisibility()")
    assert tab.evaluate("document.documentElement.scrollWidth") <= 390


def test_a_print_has_no_controls(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    tab.emulate_media(media="print")
    shown = "document.querySelector(%r).checkVisibility()"
    assert not tab.evaluate(shown % ".control-bar")
    assert not tab.evaluate(shown % ".suggestion")
    assert tab.evaluate(shown % ".heat")


@needs_axe
def test_axe_finds_nothing(tab: Page, bakery: Path) -> None:
    tab.emulate_media(reduced_motion="reduce")
    load(tab, bakery)
    for state in ("[data-overview]", "dialog"):
        if state == "dialog":
            tab.click(".suggestion")
        tab.emulate_media(color_scheme="light")
        assert violations(tab, state) == []
        tab.emulate_media(color_scheme="dark")
        assert violations(tab, state, ("color-contrast",)) == []


SCALE = "scales.fitting(%s, 0, 300).ticks(60).map(({ value, text }) => [value, text])"
TICKS: tuple[tuple[list[float], list[float]], ...] = (
    ([1, 100], [1, 3, 10, 30, 100]),
    ([0.31, 3.8], [0.5, 1, 2]),
    ([5.1, 5.3], [5.1, 5.15, 5.2, 5.25, 5.3]),
    ([0, 10], [0, 5, 10]),
    ([0, 0.02, 40], [0, 0.1, 1, 10]),
    ([123456, 123462], [123456, 123458, 123460, 123462]),
    ([-4, 4], [-4, -2, 0, 2, 4]),
    ([1e-9, 1e6], [1e-9, 1e-6, 1e-3, 1, 1e3, 1e6]),
)


def test_ticks_are_round_numbers(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    for values, ticks in TICKS:
        drawn = tab.evaluate(SCALE % json.dumps(values))
        assert [value for value, _ in drawn] == pytest.approx(ticks)
        texts = [float(label.replace("\u2212", "-")) for _, label in drawn]
        assert texts == pytest.approx(ticks, rel=1e-9)


def test_labels_move_apart_as_little_as_can_be(tab: Page, bakery: Path) -> None:
    load(tab, bakery)
    wanted = [50.0, 10.0, 11.0, 12.0, 95.0, 99.0]
    places = tab.evaluate(f"scales.spread({wanted}, 10, 0, 100)")
    assert places == pytest.approx([50, 1, 11, 21, 90, 100])
    assert tab.evaluate("scales.spread([5, 5], 10, 0, 100)") == [0, 10]


def packed(values: NDArray[np.generic]) -> str:
    return base64.b64encode(np.asarray(values).astype("<u2").tobytes()).decode()


def codes(values: NDArray[np.float64]) -> tuple[str, dict[str, object]]:
    known = np.isfinite(values)
    log = bool((values[known] > 0).all())
    ends = np.log(values[known]) if log else values[known]
    low, high = (float(ends.min()), float(ends.max())) if known.any() else (0.0, 0.0)
    result = np.full(values.shape, 65535)
    result[known] = np.rint((ends - low) / ((high - low) or 1) * 65534)
    return packed(result), {"log": log, "low": low, "high": high}


def data_of(
    groups: list[NDArray[np.float64]], better: str = "lower", **more: object
) -> dict[str, Any]:
    """The data of an overview of (B, K) errors by group, as the charts read them."""
    methods = [f"method_{at}_of_a_family" for at in range(groups[0].shape[1])]
    entries = []
    for at, errors in enumerate(groups):
        text, scale = codes(errors)
        usable = np.isfinite(errors).any(axis=0)
        whole = np.isfinite(errors[:, usable]).all(axis=1) & usable.any()
        mean = np.full(len(methods), np.nan)
        if whole.any():
            mean[usable] = errors[whole][:, usable].mean(axis=0)
        listed = [float(value) if np.isfinite(value) else None for value in mean]
        best = [] if better == "none" or not whole.any() else [
            int(np.nanargmax(mean) if better == "higher" else np.nanargmin(mean))
        ]  # fmt: skip
        entries.append(
            {
                "labels": [at], "texts": [f"{at} K"], "title": f"heat {at} K",
                "all_blocks": len(errors), "mean": listed, "median": listed, "rank": listed,
                "best": best, "tied": [], "suspects": 0, "without_suspects": None,
                "cluster": packed(np.where(whole, np.arange(len(errors)) % 9, 65535)),
                "rows": {"cake": packed(np.arange(len(errors)))}, "suspect": {},
                "errors": {"waste": text}, "scale": {"waste": scale},
            }
        )  # fmt: skip
    metric = {"name": "waste", "unit": "g", "better": better, "ratio": False}
    return {
        "node": "odd", "metric": "waste", "compare": "recipe",
        "baseline": None, "blocks_name": "cakes", "metrics": [metric],
        "groups": entries,
        "within": [
            {
                "name": "heat",
                "labels": [*range(len(groups))],
                "texts": [f"{at} K" for at in range(len(groups))],
                "times": "",
            }
        ],
        "methods": [{"label": each, "seconds": 0.01 + at} for at, each in enumerate(methods)],
        "shown_group": len(groups) - 1, "layout": None, "detail": None, "suggested": [],
        "command": None, "members": [],
        "columns": {"cake": {"labels": [*map(str, range(max(map(len, groups))))]}},
        **more,
    }  # fmt: skip


def some(*shape: int) -> NDArray[np.float64]:
    return np.random.default_rng(3).lognormal(size=shape)


def lacking() -> list[NDArray[np.float64]]:
    errors = some(2, 30, 4)
    errors[0, :, 1] = np.nan
    errors[1, 3, 2] = np.inf
    return [*errors]


ODD = {
    "one method": data_of([*some(2, 30, 1)]),
    "one group": data_of([some(30, 4)], within=[]),
    "many methods": data_of([*some(2, 12, 200)]),
    "many groups": data_of([*some(40, 6, 5)]),
    "numbers missing": data_of(lacking()),
    "an empty group": data_of([some(30, 4), np.full((5, 4), np.nan), some(30, 4)]),
    "no numbers": data_of([np.full((5, 4), np.nan)]),
    "values of 0 and below": data_of([some(30, 4) - 1, np.zeros((30, 4))]),
    "all equal": data_of([np.full((30, 4), 2.5)] * 2),
    "higher is better": data_of([*some(2, 30, 4)], better="higher"),
    "neither end is better": data_of([*some(2, 30, 4)], better="none"),
}
OVERLAPS = """(() => {
  const boxes = [...document.querySelectorAll("%s .line-chart text:not(.tick, .head, .title)")]
    .map((text) => text.getBoundingClientRect()).filter(({ width }) => width);
  let count = 0;
  boxes.forEach((a, at) => boxes.slice(at + 1).forEach((b) => {
    const beside = a.left >= b.right - 1 || b.left >= a.right - 1;
    count += !beside && a.top < b.bottom - 3 && b.top < a.bottom - 3;
  }));
  return count;
})()"""


def charts_of(folder: Path, *data: Mapping[str, object], html: str = "") -> Path:
    """A page of comparisons from their data alone."""
    for at, each in enumerate(data):
        places = (
            f'<div data-chart="{name}"></div>' for name in ("controls", "ranking", "cost", "blocks")
        )
        html += (
            f'<div data-overview="odd-{at}">{"".join(places)}</div>{json_script(each, f"odd-{at}")}'
        )
    web = files("nodegraph_compare.overview").joinpath("web")
    sources = {item.name: item.read_text(encoding="utf-8") for item in web.iterdir()}
    scripts = tuple(text for name, text in sources.items() if name.endswith(".js"))
    styles = tuple(text for name, text in sources.items() if name.endswith(".css"))
    return saved(folder, Rendered(html, scripts=scripts, styles=styles))


def test_odd_data_are_drawn_without_complaint(tab: Page, tmp_path: Path) -> None:
    load(tab, charts_of(tmp_path, *ODD.values()))
    places = {kind: f"[data-overview=odd-{at}]" for at, kind in enumerate(ODD)}
    for width in (1280, 390):
        resize(tab, width, 900)
        tab.evaluate("new Promise((resolve) => setTimeout(resolve, 60))")
        assert tab.evaluate("document.documentElement.scrollWidth") <= width
        for kind, place in places.items():
            drawn = tab.evaluate(f"document.querySelector('{place}').innerHTML")
            assert not re.search(r"NaN|Infinity|undefined|null", drawn), kind
            assert tab.evaluate(OVERLAPS % place) == 0, kind
    for kind, place in places.items():
        bests = tab.evaluate(COUNT % f"{place} .heat td.first")
        assert (bests == 0) is (kind in ("no numbers", "neither end is better")), kind
    many, one = places["many methods"], places["one group"]
    assert tab.evaluate(COUNT % f"{many} .heat tbody tr") < 40
    tab.click(f"{many} .heat-table .more")
    assert tab.evaluate(COUNT % f"{many} .heat tbody tr") == 200
    assert tab.evaluate(COUNT % f"{one} .line-chart path.line") == 0
    assert tab.evaluate(COUNT % f"{one} .line-chart g[role=button]") == 4


@pytest.mark.parametrize("groups", [1, 2])
def test_methods_tied_with_the_best_are_ringed(tab: Page, tmp_path: Path, groups: int) -> None:
    within: dict[str, Any] = {"within": []} if groups == 1 else {}
    data = data_of([*some(groups, 30, 4)], **within)
    for group in data["groups"]:
        group["tied"] = [*group["best"], next(at for at in range(4) if at not in group["best"])]
    load(tab, charts_of(tmp_path, data))
    rings = [COUNT % f"{place} .tied" for place in (".heat", ".line-chart", ".cost-chart")]
    assert [tab.evaluate(count) for count in rings] == [2 * groups, 2 * groups, 2]
    choose(tab, "Statistic", "median")  # of which no test was made
    assert [tab.evaluate(count) for count in rings] == [0, 0, 0]


WATCH = """
window.drawn = [];
new MutationObserver((changes) => drawn.push(...changes
  .filter(({ target, addedNodes }) => addedNodes.length && target.closest("[data-chart]"))
  .map(({ target }) => target.closest("figure.chart")?.className ?? "controls"))
).observe(document.body, { childList: true, subtree: true });
"""


def test_of_thousands_of_blocks_a_change_draws_each_chart_once(tab: Page, tmp_path: Path) -> None:
    load(tab, charts_of(tmp_path, data_of([*some(5, 1000, 12)])))
    name = tab.get_attribute(".dots canvas", "aria-label") or ""
    assert name.startswith("1000 cakes as dots")
    assert tab.evaluate(COUNT % "[data-overview] *") < 1500
    tab.evaluate(WATCH)
    tab.hover(".heat tbody tr >> nth=3")
    assert tab.locator("g.method.hover").count() > 0
    assert tab.evaluate("drawn") == []
    tab.click(".heat tbody th button >> nth=3")
    drawn = tab.evaluate("drawn")
    for chart in ("line-chart", "heat-table", "cost-chart"):
        assert drawn.count(f"chart {chart}") == 2  # the picture and its caption


def test_a_few_values_far_from_all_others_stand_at_the_edge_and_are_counted(
    tab: Page, tmp_path: Path
) -> None:
    errors = some(200, 5)
    errors[7, 3], errors[9, 2] = 1e5, 1e-9
    load(tab, charts_of(tmp_path, data_of([some(200, 5), errors])))
    caption = text(tab, ".dots-chart figcaption")
    assert re.search(r"\. 1 dot below \S+ g stands at the left edge\. ", caption)
    assert re.search(r"\. 1 dot above \S+ g stands at the right edge\. ", caption)
    load(tab, charts_of(tmp_path, data_of([some(200, 5)] * 2)))
    assert "edge" not in text(tab, ".dots-chart figcaption")


HEADS = """(() => {
  const boxes = [...document.querySelectorAll(".line-chart text.head")]
    .map((text) => text.getBoundingClientRect());
  const edge = document.querySelector(".line-chart svg").getBoundingClientRect().left;
  return boxes.filter((a, at) => a.left < edge - 1 || boxes.slice(at + 1).some(
    (b) => a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom)).length;
})()"""


@pytest.mark.parametrize("groups", [3, 12])
def test_heads_of_groups_do_not_overlap_on_a_phone(tab: Page, tmp_path: Path, groups: int) -> None:
    data = data_of([*some(groups, 30, 4)])
    for at, group in enumerate(data["groups"]):
        group["texts"] = [f"{10 * at + 5}\N{NO-BREAK SPACE}frames"]
    load(tab, charts_of(tmp_path, data), width=390)
    assert tab.locator(".line-chart text.head").count() >= 2
    assert tab.evaluate(HEADS) == 0
    assert tab.evaluate("document.querySelector('.control-bar').offsetHeight") < 60


def test_the_reference_is_the_baseline_until_a_reader_chooses_another(
    tab: Page, tmp_path: Path
) -> None:
    baseline = "method_1_of_a_family"
    load(tab, charts_of(tmp_path, {**ODD["all equal"], "baseline": baseline}))
    reference = ".heat tr.reference"
    assert tab.get_attribute(reference, "data-method") == baseline
    assert tab.evaluate("location.hash") == ""
    choose(tab, "Reference", "")
    assert tab.locator(reference).count() == 0
    tab.reload()
    assert tab.locator(reference).count() == 0
    tab.evaluate("location.hash = '#select:method=method_2_of_a_family'")
    tab.click(".chip")
    assert tab.get_attribute(reference, "data-method") == baseline
    assert tab.evaluate("location.hash") == ""


def test_comparisons_on_one_page_share_methods_and_no_more(tab: Page, tmp_path: Path) -> None:
    path = charts_of(tmp_path, ODD["higher is better"], ODD["all equal"])
    load(tab, path)
    checked = (
        "[...document.querySelectorAll('.segments [aria-checked=true]')]"
        ".map((button) => button.textContent)"
    )
    assert tab.evaluate(checked) == ["1 K", "1 K"]
    tab.click("[data-overview=odd-1] .segments button")
    assert tab.evaluate(checked) == ["1 K", "0 K"]
    address = tab.evaluate("location.hash")
    assert address == "#select:2.group=0"
    tab.click("[data-overview=odd-1] .heat tbody th button")
    assert tab.evaluate(COUNT % ".heat tr.selected") == 2
    tab.goto("about:blank")
    tab.goto(f"{path.as_uri()}{address}")
    assert tab.evaluate(checked) == ["1 K", "0 K"]


def test_the_tabs_of_the_verdicts_choose_the_group(tab: Page, tmp_path: Path) -> None:
    tabs = "".join(f'<input type="radio" name="odd-0-heat" id="tab-{at}">' for at in (0, 1))
    load(tab, charts_of(tmp_path, ODD["all equal"], html=tabs))
    chosen = "[...document.querySelectorAll('[name=odd-0-heat]')].map((each) => each.checked)"
    assert tab.evaluate(chosen) == [False, True]
    tab.click("#tab-0")
    assert text(tab, ".segments [aria-checked=true]") == "0 K"
    tab.click(".segments button:last-child")
    assert tab.evaluate(chosen) == [False, True]
