"""A saved page in a real browser, opened as a file: no request, no complaint, and the motion that a click chooses."""

import numpy as np
import pytest

import whirlmap

sync_api = pytest.importorskip("playwright.sync_api", reason="the browser tests need playwright: pip install '.[browser]'")
from tests.explorer.test_browser import ARGUMENTS, CHROMIUM, Page  # noqa: E402 (it needs playwright)

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="the browser tests need chromium: apt-get install chromium")


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pages")
    ds = whirlmap.bifurcation_diagram(whirlmap.load("duffing"), "gamma", [0.2, 0.24, 0.28, 0.285, 0.29], lyapunov=0)
    page = whirlmap.explore(ds)
    frame = folder / "notebook.html"
    frame.write_text(f"<!doctype html><title>notebook</title>{page._repr_html_()}", encoding="utf-8")
    return page.save(folder / "page.html"), frame


@pytest.fixture(scope="module")
def context():
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=ARGUMENTS)
        made = browser.new_context(viewport={"width": 1400, "height": 1100})
        made.set_offline(True)
        yield made
        browser.close()


def test_a_click_shows_the_motion_without_any_network(context, files):
    page = Page(context, files[0].as_uri())
    for gamma, places in ((0.29, 4), (0.28, 2), (0.2, 1)):
        page.then(lambda at=gamma: page.page.mouse.click(*page.place(at)))
        assert page.read("explorer.shown.label.text") == f"periodic, {places}T"
        assert page.read("explorer.shown.clusters") == places
        assert page.read("explorer.state.values.gamma") == gamma
    assert page.wrong == []
    assert page.asked == [files[0].as_uri()]
    for hidden in ("finer", "branch", "ask-votes"):
        assert page.read(f"explorer.$('{hidden}').hidden")
    limits = page.page.inner_text("#limits")
    assert "the export of data, commands and scripts need the program: whirlmap explore" in limits
    page.page.click("#ask-coexisting")
    page.until("explorer.$('coexisting').textContent.startsWith('up: ')")
    assert page.read("explorer.$('coexisting').textContent") == "up: the same motion; down: the same motion"
    assert page.wrong == []


def test_what_lies_between_or_beyond_the_points_of_the_file_becomes_the_nearest_point_and_is_said(context, files):
    page = Page(context, f"{files[0].as_uri()}#v.gamma=0.2551")

    def shown():
        written, heading = page.page.input_value("#v-gamma"), page.page.inner_text("#where")
        return page.read("explorer.state.values.gamma"), written, heading, page.page.inner_text("#status")

    said = "{} lies {} of this file: shown is the nearest of them, γ = {}"
    assert shown() == (0.24, "0.24", "γ = 0.24", said.format("γ = 0.2551", "between the points", "0.24"))
    beyond = ("9", 0.29, "beyond the points")
    for value, near, where in (beyond, beyond, ("0.27", 0.28, "between the points")):
        page.page.fill("#v-gamma", value)
        page.page.keyboard.press("Enter")
        page.until(f"explorer.shown.values.gamma === {near}")
        page.page.wait_for_timeout(100)
        assert shown() == (near, str(near), f"γ = {near}", said.format(f"γ = {value}", where, near))
    slider = page.page.get_by_label("γ, forcing")
    page.then(lambda: slider.focus() or page.page.keyboard.press("ArrowRight"))
    assert shown() == (0.285, "0.285", "γ = 0.285", "")
    assert page.read("explorer.shown.values.gamma") == 0.285
    assert page.wrong == []


def test_series_in_the_browser_are_those_of_python(context, files):
    page = Page(context, f"{files[0].as_uri()}#v.gamma=0.29")
    found = page.read("explorer.source.computed({gamma: 0.29}).then((m) => ({x: [...m.x], steps: m.steps}))")
    x = np.array(found["x"]).reshape(-1, 2)
    system = whirlmap.load("duffing", gamma=0.29, start={"x": x[0, 0], "v": x[0, 1]})
    series = whirlmap.simulate(system, periods=20, steps=found["steps"])["x"].values
    assert np.max(np.abs(x[: len(series)] - series) / np.ptp(series, axis=0)) < 1e-9


def test_a_notebook_shows_it_in_a_frame(context, files):
    page = context.new_page()
    wrong = []
    page.on("console", lambda m: wrong.append(m.text) if m.type == "error" else None)
    page.on("pageerror", lambda error: wrong.append(str(error)))
    page.goto(files[1].as_uri())
    frame = page.frames[1]
    frame.wait_for_function("explorer.shown !== null", timeout=60_000)
    assert frame.evaluate("explorer.shown.label.period") in (1, 2, 4)
    frame.evaluate("explorer.change({gamma: 0.2})")  # a change of state writes no address there
    frame.wait_for_function("explorer.shown.label.period === 1", timeout=60_000)
    assert frame.evaluate("document.getElementById('link').hidden")
    assert wrong == []
