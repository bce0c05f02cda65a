"""The report in a real browser, opened as a file: a click on a diagram shows the motion of that speed."""

from dataclasses import replace

import pytest

sync_api = pytest.importorskip("playwright.sync_api", reason="the browser tests need playwright: pip install '.[browser]'")
from tests.explorer.test_browser import ARGUMENTS, CHROMIUM  # noqa: E402 (it needs playwright)

from whirlmap.results.regime import Regime  # noqa: E402
from whirlmap.studies.gear_psfd.reproduction.report import write_report  # noqa: E402

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="the browser tests need chromium: apt-get install chromium")

OTHER = "other & <more>"


@pytest.fixture(scope="module")
def address(finished, tmp_path_factory):
    """A report of two editions."""
    path = tmp_path_factory.mktemp("report") / "report.html"
    other = replace(finished, evidence=replace(finished.evidence, edition=replace(finished.evidence.edition, name=OTHER)))
    write_report(path, [finished, other], quality="quick")
    return path.as_uri()


@pytest.fixture(scope="module")
def browser():
    with sync_api.sync_playwright() as playwright:
        made = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        yield made
        made.close()


class Report:
    """The report in a browser without a network, with all that it asked for and complained of."""

    def __init__(self, browser, address, *, width=1440, scheme="light"):
        context = browser.new_context(viewport={"width": width, "height": 900}, color_scheme=scheme)
        context.set_offline(True)
        self.page, self.asked, self.wrong = context.new_page(), [], []
        self.page.on("request", lambda request: self.asked.append(request.url))
        self.page.on("console", lambda m: self.wrong.append(m.text) if m.type in ("error", "warning") else None)
        self.page.on("pageerror", lambda error: self.wrong.append(str(error)))
        self.page.goto(address)

    def diagram(self, figure, edition="intended"):
        """The frame of a figure's diagram, with its first motion shown."""
        self.page.locator(f"#figure-{figure}").scroll_into_view_if_needed()
        element = self.page.locator(f'iframe[title^="Figure {figure}, {edition}"]').element_handle(timeout=20_000)
        frame = element.content_frame()
        until(frame, "typeof explorer !== 'undefined' && explorer.shown !== null")
        return frame


def until(frame, condition, seconds=60):
    """Wait for a condition; the report's content policy leaves `wait_for_function` no way to ask for it."""
    for _ in range(int(seconds / 0.02)):
        if frame.evaluate(condition):
            return
        frame.wait_for_timeout(20)
    raise AssertionError(f"{condition} did not come")


def chosen(frame, action, s):
    """Label that is shown after an action that chooses a speed."""
    before = frame.evaluate("explorer.timing.asked")
    action()
    until(frame, f"Math.abs(explorer.value('s') - {s}) < 1e-9 && explorer.timing.asked > {before}")
    return frame.inner_text("#label")


@pytest.fixture(scope="module")
def report(browser, address):
    return Report(browser, address)


def test_a_click_on_a_point_of_figure_2_shows_its_motion(report, finished):
    ds = finished.evidence.diagrams[0.0]
    at = next(k for k, r in enumerate(ds["regime"].values) if r == Regime.periodic and ds["s"].values[k] > 1)
    s, period = float(ds["s"][at]), int(ds["period_T"][at])
    frame = report.diagram(2)
    assert frame.inner_text("#where") == "s = 3.27"
    over = frame.locator("#overview .u-over")
    box, (low, high) = over.bounding_box(), frame.evaluate("explorer.overview.ranges().x")
    place = {"x": box["width"] * (s - low) / (high - low), "y": box["height"] * 0.3}
    assert chosen(frame, lambda: over.click(position=place), s) == f"periodic, {period}T"
    assert frame.evaluate("explorer.shown.label.text") == f"periodic, {period}T"  # of the computed motion itself
    assert frame.evaluate("explorer.shown.clusters") == period == 8
    assert "label in the diagram" in frame.inner_text("#votes") + frame.inner_text("#numbers")
    for panel in ("orbit", "section", "series", "spectrum"):
        assert frame.locator(f"#{panel} canvas").count() == 1, panel
    earlier = float(ds["s"][at - 1])
    assert chosen(frame, lambda: frame.locator("#overview").press("ArrowLeft"), earlier).startswith("periodic")


def test_editions_are_chosen_by_keyboard(report):
    shown = report.page.locator("[data-shown]:visible")
    assert {one.get_attribute("data-shown") for one in shown.all()} == {"intended"}
    report.page.get_by_role("radio", name="intended").focus()
    report.page.keyboard.press("ArrowRight")
    assert {one.get_attribute("data-shown") for one in shown.all()} == {OTHER}
    assert report.diagram(3, OTHER).inner_text("#where") == "s = 3.27"
    report.page.get_by_role("radio", name="intended").check()


def test_every_control_has_a_name(report):
    nameless = """() => [...document.querySelectorAll("a, button, input, select, summary, iframe, [tabindex]")]
      .filter((e) => e.checkVisibility())
      .filter((e) => !(e.getAttribute("aria-label") || e.title || e.labels?.[0]?.textContent || e.textContent).trim())
      .map((e) => e.outerHTML)"""
    assert report.page.evaluate(nameless) == []
    assert report.diagram(2).evaluate(nameless) == []


@pytest.mark.parametrize(("width", "scheme"), [(390, "dark"), (1440, "light")])
def test_it_fits_the_window_and_follows_the_theme(browser, address, width, scheme):
    report = Report(browser, address, width=width, scheme=scheme)
    frame = report.diagram(2)
    for place in (report.page.main_frame, frame):
        assert place.evaluate("document.documentElement.scrollWidth <= innerWidth")
    assert frame.evaluate("document.documentElement.dataset.theme") == scheme
    light = report.page.evaluate("Number(getComputedStyle(document.body).backgroundColor.match(/[0-9]+/)[0]) > 128")
    assert light == (scheme == "light")
    high = report.page.locator('iframe[title^="Figure 2"]:visible').bounding_box()["height"]
    assert high == pytest.approx(frame.evaluate("document.body.getBoundingClientRect().height"), abs=2)
    assert report.asked == [address]
    assert report.wrong == []


def test_nothing_was_asked_for(report, address):
    assert report.asked == [address]
    assert report.wrong == []
