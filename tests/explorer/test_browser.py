"""The page in a real browser: what is drawn is read from the page's state, not from pixels."""

import json
import shutil
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

import whirlmap
from whirlmap.explorer.encoding import json_text
from whirlmap.explorer.exploration import Exploration, of_result
from whirlmap.explorer.overview import overview
from whirlmap.explorer.server import Server
from whirlmap.explorer.session import Session

sync_api = pytest.importorskip("playwright.sync_api", reason="the browser tests need playwright: pip install '.[browser]'")
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="the browser tests need chromium: apt-get install chromium")

#: The machine has no graphics; nothing of the browser's own may ask for the network.
ARGUMENTS = [
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
]  # fmt: skip


class Page:
    """A page of the explorer in a browser, with all that it asked for and complained of."""

    def __init__(self, context: Any, address: str) -> None:
        self.page, self.asked, self.wrong = context.new_page(), list[str](), list[str]()
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("console", lambda m: self.wrong.append(m.text) if m.type in ("error", "warning") else None)
        self.page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self.page.goto(address)
        self.until("explorer.shown !== null")

    def read(self, expression: str) -> Any:
        return self.page.evaluate(f"() => {expression}")

    def until(self, condition: str, seconds: float = 60) -> None:
        for _ in range(int(seconds / 0.02)):
            if self.read(condition):
                return
            self.page.wait_for_timeout(20)
        raise AssertionError(f"{condition} did not come; status: {self.read('explorer.$(`status`).textContent')}")

    def then(self, action: Callable[[], Any]) -> None:
        """Wait for the motion that an action leads to."""
        before = self.read("explorer.timing.asked")
        action()
        self.until(f"explorer.timing.asked > {before}")

    def place(self, x: float, share: float = 0.3) -> tuple[float, float]:
        """Where a value of the diagram's axis is on the screen, at a share of the height."""
        box = self.page.locator("#overview .u-over").bounding_box()
        low, high = self.read("explorer.overview.ranges().x")
        return box["x"] + box["width"] * (x - low) / (high - low), box["y"] + box["height"] * share


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with sync_api.sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield made
        made.close()


@contextmanager
def serving(exploration: Exploration) -> Iterator[Server]:
    """A server of an exploration in a thread."""
    with Session(exploration) as session, Server(session) as made:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        yield made
        made.shutdown()
        thread.join()


@pytest.fixture(scope="module")
def server(exploration: Exploration) -> Iterator[Server]:
    with serving(exploration) as made:
        yield made


@pytest.fixture(scope="module")
def page(browser: Any, server: Server) -> Page:
    return Page(browser.new_context(viewport={"width": 1440, "height": 1000}), server.address)


def test_a_click_shows_the_four_places_of_a_motion_of_four_periods(page: Page) -> None:
    page.then(lambda: page.page.mouse.click(*page.place(0.29)))  # between its points: white there
    assert page.read("explorer.value('gamma')") == 0.29
    assert page.read("explorer.shown.label.period") == 4
    assert page.read("explorer.shown.clusters") == 4
    assert "in 4 places" in page.page.inner_text("#section-line")
    assert page.page.inner_text("#label") == "periodic, 4T"
    names = page.page.inner_text("#lines")
    assert "1/4 forcing" in names


def test_keys_sliders_and_link(page: Page, browser: Any) -> None:
    page.page.focus("#overview")
    page.then(lambda: page.page.keyboard.press("ArrowLeft"))
    assert page.read("explorer.value('gamma')") == 0.285
    page.then(lambda: page.page.keyboard.press("Shift+ArrowLeft"))
    assert page.read("explorer.value('gamma')") == 0.2
    page.then(lambda: page.page.fill("#v-delta", "0.31") or page.page.keyboard.press("Enter"))
    assert page.read("explorer.value('delta')") == 0.31
    slider = page.page.get_by_label("β, cubic stiffness")
    page.then(lambda: slider.focus() or page.page.keyboard.press("ArrowRight"))
    assert page.read("explorer.value('beta')") > 1
    page.page.select_option("#quantity", "v")
    page.until("explorer.shown.spectrum.quantity === 'v'")
    page.page.select_option("#colour", "period")
    address = page.read("location.href")
    other = Page(browser.new_context(), address)
    assert other.read("explorer.state") == page.read("explorer.state")
    assert other.read("Array.from(explorer.shown.series.x)") == page.read("Array.from(explorer.shown.series.x)")
    page.then(lambda: page.page.click("#reset"))
    assert page.read("explorer.value('delta')") == 0.3


def test_a_zoom_is_computed_finer_and_can_be_left(page: Page) -> None:
    a, b = page.place(0.283, 0.05), page.place(0.2885, 0.95)
    page.page.mouse.move(*a)
    page.page.mouse.down()
    page.page.mouse.move(*b, steps=4)
    page.page.mouse.up()
    page.until("explorer.state.zoom !== null")
    low, high = page.read("explorer.overview.ranges().x")
    assert 0.282 < low < 0.284
    assert 0.288 < high < 0.289
    page.until("explorer.layers.length === 2 && explorer.layers[1].regime.length === 160")
    found = page.read("[...explorer.layers[1].period]")
    assert set(found[:80]) == {2}
    assert set(found[-50:]) == {4}
    assert set(found) <= {0, 2, 4}  # next to the doubling at 0.28669 motions settle too slowly to be told
    page.page.click("#back")
    page.until("explorer.state.zoom === null")


def test_coarse_points_of_both_ways_stay_until_the_finer_ones_of_the_same_way_are_there(browser: Any) -> None:
    values = np.linspace(0.28, 0.29, 11)
    coarse = whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", values, lyapunov=0, follow="both")
    system, axes = whirlmap.load("duffing"), {"gamma": (values[3:9].tolist(), "1")}
    first, second = coarse.isel(direction=0, gamma=slice(3, 6)), coarse.isel(gamma=slice(3, 9)).copy(deep=True)
    first.attrs["incomplete"], second.attrs["incomplete"] = (
        "interrupted after 3 of 12 points",
        "interrupted after 8 of 12 points",
    )
    second["section"][1, :4] = np.nan  # on its way down it has come to the two highest values
    one = {"gamma": (values[3:4].tolist(), "1")}
    begun = coarse.isel(direction=0, gamma=slice(3, 4)).assign_attrs(incomplete="interrupted after 1 of 12 points")
    steps = [
        overview(system, one, begun),
        overview(system, {"gamma": (values[3:6].tolist(), "1")}, first), overview(system, axes, second),
        overview(system, axes, coarse.isel(gamma=slice(3, 9))),
    ]  # fmt: skip
    hidden = [([], []), ([3, 4, 5], []), ([*range(3, 9)], [7, 8]), ([*range(3, 9)], [*range(3, 9)])]
    with serving(of_result(coarse, "both")) as server:
        page = Page(browser.new_context(), server.address)
        for step, wanted in zip(steps, hidden, strict=True):
            page.page.evaluate("(o) => explorer.overview.add(o, 1)", json.loads(json_text(step)))
            for way, gone in zip(("up", "down"), wanted, strict=True):
                seen = page.read(f"explorer.cells.uncovered(explorer.layers, 0, '{way}', 'x', false)")
                assert seen == [k for k in range(11) if k not in gone]
        assert page.wrong == []


@pytest.mark.slow  # test_server asks the same without a browser
def test_votes_coexisting_motions_and_branches(page: Page) -> None:
    page.then(lambda: page.page.mouse.click(*page.place(0.24)))
    page.page.click("#ask-votes")
    page.until("Boolean(explorer.verdict)")
    assert "floquet" in page.page.inner_text("#votes")
    page.page.click("#ask-coexisting")
    page.until("explorer.$('coexisting').textContent.includes('down')")
    page.page.click("#branch")
    page.until("explorer.branches.length === 1 && explorer.$('cancel').hidden")
    assert page.read("explorer.branches[0].events.some((e) => e.kind === 'period-doubling')")


def test_the_picture_and_the_script_are_exported(page: Page) -> None:
    for kind, name in (("script", "motion.py"), ("picture", "motion.png")):
        with page.page.expect_download() as found:
            page.page.select_option("#export", kind)
        assert found.value.suggested_filename == name
        assert found.value.path().read_bytes()[:4] == (b"\x89PNG" if kind == "picture" else b'"""T')


@pytest.mark.slow  # follows a curve; test_branches does so without a browser
def test_curves_of_bifurcations_lie_over_a_map(browser: Any) -> None:
    axes = {"gamma": np.linspace(0.2, 0.3, 5), "omega": np.linspace(1.15, 1.25, 3)}
    ds = whirlmap.regime_map(whirlmap.load("duffing"), axes, lyapunov=0).load()
    with serving(of_result(ds, "map")) as server:
        page = Page(browser.new_context(), server.address)
        page.then(lambda: page.page.mouse.click(*page.place(0.225, 0.5)))
        page.page.click("#branch")
        page.until("explorer.branches.length === 1 && explorer.$('cancel').hidden")
        assert page.read("explorer.branches[0].kind") == "period-doubling"
        assert page.page.inner_text("#lines-legend") == "curve of period doubling points"
        assert page.wrong == []


def test_a_map_of_one_row_can_be_clicked(browser: Any) -> None:
    axes = {"gamma": np.linspace(0.2, 0.3, 5), "omega": [1.2]}
    ds = whirlmap.regime_map(whirlmap.load("duffing"), axes, lyapunov=0).load()
    with serving(of_result(ds, "map")) as server:
        page = Page(browser.new_context(), server.address)
        low, high = page.read("explorer.overview.ranges().y")
        assert low < 1.2 < high
        page.then(lambda: page.page.mouse.click(*page.place(0.225, 0.5)))
        assert page.read("explorer.state.values") == {"gamma": 0.225, "omega": 1.2}
        assert page.wrong == []


def test_a_map_that_is_not_complete_says_so_and_lets_coarser_points_show(browser: Any) -> None:
    axes = {"gamma": np.linspace(0.2, 0.3, 4), "omega": [1.15, 1.25]}
    ds = whirlmap.regime_map(whirlmap.load("duffing"), axes, lyapunov=0).load()
    part = ds.copy(deep=True)
    part["evaluation"][1:] = 0
    with serving(of_result(part, "map")) as server:
        page = Page(browser.new_context(), server.address)
        assert page.page.inner_text("#incomplete") == "2 of 8 points computed"
        assert page.page.inner_text("#legend").endswith("not computed 75 %")
        page.page.select_option("#colour", "period")
        assert page.page.inner_text("#legend").endswith("not computed 75 %")
        system, over = whirlmap.load("duffing"), {k: (list(v), "1") for k, v in axes.items()}
        whole, some = (json.loads(json_text(overview(system, over, one))) for one in (ds, part))
        page.page.evaluate("(o) => explorer.overview.replace(o)", whole)
        assert page.read("explorer.$('incomplete').hidden")
        assert "not computed" not in page.page.inner_text("#legend")
        page.page.evaluate("(o) => explorer.overview.add(o, 1)", some)
        assert page.page.inner_text("#incomplete") == "finer: 2 of 8 points computed"
        for gamma, layer in ((0.2, 1), (0.3, 0)):
            assert page.read(f"explorer.layers.indexOf(explorer.overview.cellAt([{gamma}, 1.15]).layer)") == layer
        assert page.wrong == []


@pytest.mark.slow  # test_switches asks the same without a browser
def test_words_choose_switches(browser: Any) -> None:
    with serving(Exploration(whirlmap.load("machines/jeffcott-rig"), {})) as server:
        page = Page(browser.new_context(), server.address)
        page.page.click("#more summary")
        page.then(lambda: page.page.select_option("#v-arc", "fixed"))
        assert page.page.inner_text("#where") == "arc = fixed"
        other = Page(browser.new_context(), page.read("location.href"))
        assert other.read("explorer.state.values") == {"arc": "fixed"}
        page.page.select_option("#v-rotor", "rigid")
        page.until("explorer.$('status').textContent.includes('the model has other states there')")
        assert page.read("document.querySelector('.panels').classList.contains('old')")


def test_a_section_without_points_says_why_and_ticks_of_a_flat_axis_differ(page: Page) -> None:
    why = {("ok", "at_rest"): "this is at rest", ("ok", "undecided"): "no point of this motion lies in it",
           ("ended", "undecided"): "the run ended"}  # fmt: skip
    page.page.evaluate("() => { window.kept = explorer.shown; }")
    for (status, name), words in why.items():
        page.page.evaluate(
            "([status, name]) => { explorer.shown = {...explorer.shown, section: {},"
            " label: {...explorer.shown.label, status, name}}; explorer.panels.section(); }", [status, name]
        )  # fmt: skip
        assert page.page.inner_text("#section") == f"no section: {words}"
    assert page.read("explorer.tickTexts([0.5, 0.5000002, 0.5000004])") == ["0.5", "0.5000002", "0.5000004"]
    assert page.read("explorer.tickTexts([0, 0.2, 0.4], 1000)") == ["0", "200", "400"]
    page.page.evaluate("() => { explorer.shown = window.kept; explorer.panels.section(); }")


@pytest.mark.parametrize("width", [1440, 390])
@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_every_control_has_a_name_and_nothing_is_cut(browser: Any, server: Server, width: int, scheme: Any) -> None:
    found = Page(browser.new_context(viewport={"width": width, "height": 844}, color_scheme=scheme), server.address)
    unnamed = found.read(
        "[...document.querySelectorAll('button, select, input')].filter((e) => !(e.ariaLabel || e.labels?.length"
        " || e.textContent.trim())).map((e) => e.outerHTML)"
    )
    assert unnamed == []
    assert found.read("document.documentElement.scrollWidth") <= width
    assert found.read("document.documentElement.dataset.theme") == scheme
    assert found.wrong == []


def test_nothing_was_asked_of_anyone_else(page: Page, server: Server) -> None:
    assert page.wrong == []
    assert {url for url in page.asked if not url.startswith((server.address, "data:", "blob:"))} == set()


def test_a_server_that_was_ended_and_started_again_goes_on(browser: Any, exploration: Exploration) -> None:
    def started(made: Server) -> threading.Thread:
        thread = threading.Thread(target=made.serve_forever, kwargs={"poll_interval": 0.05})
        thread.start()
        return thread

    with Session(exploration) as session:
        with Server(session) as first:
            thread = started(first)
            page = Page(browser.new_context(), first.address)
            first.shutdown()
            thread.join()
        page.page.focus("#overview")
        page.page.keyboard.press("ArrowRight")
        page.until("explorer.$('status').textContent.includes('does not answer')")
        with Server(session, first.port, first.token) as second:
            thread = started(second)
            page.then(lambda: page.page.keyboard.press("ArrowRight"))
            assert page.read("explorer.$('status').textContent") == ""
            second.shutdown()
            thread.join()
