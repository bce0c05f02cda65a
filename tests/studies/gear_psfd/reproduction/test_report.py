"""The report of a reproduction: what stands in it, in which order, and that it asks for nothing."""

import base64
import re
from dataclasses import replace
from html.parser import HTMLParser
from io import BytesIO

import numpy as np
import pytest
from matplotlib.image import imread

from whirlmap.explorer.saved import saved_page, stored_motions
from whirlmap.kernels.webassembly.browser_kernel import NoBrowserKernelError
from whirlmap.studies.gear_psfd.claims.claims import WORDS, claims
from whirlmap.studies.gear_psfd.reproduction.figures import Studio, plans
from whirlmap.studies.gear_psfd.reproduction.live_diagrams import explored
from whirlmap.studies.gear_psfd.reproduction.report import MEANING, SIGNS, Picture, figures, first_shown, write_report


class Page(HTMLParser):
    """Elements in their order: tag, attributes, and the text up to the next tag."""

    def __init__(self, text):
        super().__init__()
        self.elements = []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.elements.append([tag, dict(attrs), ""])

    def handle_data(self, data):
        if self.elements:
            self.elements[-1][2] += data

    def place(self, identifier):
        return next(k for k, (_, attrs, _) in enumerate(self.elements) if attrs.get("id") == identifier)

    def numbers(self, begin, end):
        """Number of each claim between two elements, with repeated ones."""
        found = self.elements[self.place(begin) : self.place(end)]
        return [(attrs["data-number"], text.strip()) for _, attrs, text in found if "data-number" in attrs]


@pytest.fixture(scope="module")
def text(report):
    return report.read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def page(text):
    return Page(text)


def test_figures_come_first_then_verdicts_then_folded_details(page):
    order = ["summary", *(f"figure-{n}" for n in (2, 3, 4, 5)), "together", "figure-6", "figure-7", "verdicts", "details"]
    places = [page.place(name) for name in order]
    assert places == sorted(places)
    folded = [k for k, (tag, _, _) in enumerate(page.elements) if tag == "details"]
    after = [k for k in folded if k > places[-1]]
    assert len(after) >= 7
    assert [page.elements[k][1].get("id") for k in after if "open" in page.elements[k][1]] == ["reading"]


def test_the_number_under_each_figure_is_that_of_the_verdict_table_and_of_the_run(page, finished):
    measured = {v.claim.id: v.measured.number for v in finished.verdicts}
    table = page.numbers("verdicts", "details")
    assert dict(table) == measured
    assert len(table) == len(measured) == 16
    heads = [f"figure-{n}" for n in (2, 3, 4, 5)] + ["together", "figure-6", "figure-7", "verdicts"]
    for f, begin, end in zip(figures(), heads, heads[1:], strict=False):
        found = page.numbers(begin, end)
        assert [name for name, _ in found] == [c.id for c in f.claims]
        assert dict(found) == {c.id: measured[c.id] for c in f.claims}
    assert {c.id for f in figures() for c in f.claims} == {c.id for c in claims()}


def test_the_summary_counts_every_claim_once(page, finished):
    shown = page.elements[page.place("summary") : page.place("figure-2")]
    links = [attrs["href"] for tag, attrs, _ in shown if tag == "a" and attrs["href"][1:] in {c.id for c in claims()}]
    assert sorted(links) == sorted(f"#{c.id}" for c in claims())
    heads = " ".join(text for _, _, text in shown)
    for word in WORDS:
        assert f"{word}: {len(finished.with_word(word))} of 16" in heads
    assert set(MEANING) == set(SIGNS) == set(WORDS)


def test_it_asks_for_nothing_and_may_not(text, page):
    for tag, attrs, _ in page.elements:
        for name in ("src", "href", "action", "srcset", "data", "poster"):
            value = attrs.get(name, "#")
            assert value.startswith(("#", "data:")), (tag, name, value)
    for asks in ("@import", "url(", "XMLHttpRequest", "WebSocket", "fetch(", "import(", "sendBeacon"):
        assert asks not in text, asks
    policy = next(attrs["content"] for _, attrs, _ in page.elements if attrs.get("http-equiv") == "Content-Security-Policy")
    assert policy.startswith("default-src 'none'; ")
    assert not re.search(r"https?:|\*|connect-src", policy)


def test_every_text_is_escaped(text, page, evidence):
    assert "</script><img" in evidence.edition.says
    assert "<img src=" not in text
    assert any(evidence.edition.says in shown for _, _, shown in page.elements)
    assert not any(attrs.get("src", "").startswith("http") for _, attrs, _ in page.elements)


def test_it_stays_small(text, finished):
    assert len(text.encode()) < 1_000_000, "one edition without a table of a film"
    assert all(len(d.content) < 150_000 for d in finished.diagrams)


def test_a_picture_stands_at_its_figure(finished, tmp_path):
    with Studio(1) as studio:
        (plan, png), *_ = studio.draw([next(plans(finished.evidence))])
    path = tmp_path / "fig2.png"
    path.write_bytes(png)
    shown = replace(finished, pictures=[Picture(path, plan.figure, plan.caption)])
    write_report(tmp_path / "report.html", [shown], quality="quick")
    page = Page((tmp_path / "report.html").read_text(encoding="utf-8"))
    (at,) = [k for k, (tag, _, _) in enumerate(page.elements) if tag == "img"]
    assert page.place("figure-2") < at < page.place("figure-3")
    assert page.elements[at][1]["alt"] == plan.caption
    kind, _, content = page.elements[at][1]["src"].partition(";base64,")
    assert kind == "data:image/webp"
    assert len(content) < 0.6 * len(png)
    kept = imread(BytesIO(base64.b64decode(content)), format="webp")
    np.testing.assert_array_equal(kept[..., :3], np.rint(imread(BytesIO(png)) * 255)[..., :3])


def test_the_edition_with_most_claims_that_hold_is_shown_first(finished):
    worse = replace(
        finished, verdicts=[replace(v, word="fails") for v in finished.verdicts],
        evidence=replace(finished.evidence, edition=replace(finished.evidence.edition, name="worse")),
    )  # fmt: skip
    assert first_shown([worse, finished]) == first_shown([finished, worse]) == "intended"


def test_diagrams_are_in_the_papers_numbers(evidence):
    """Speeds of an edition with another clock are shown as the paper's; nothing has a unit."""
    other = replace(evidence, edition=replace(evidence.edition, scale=4.0))
    found = explored(other, 0.0, evidence.diagrams[0.0])
    page = saved_page.page_data(found)
    (speed,) = [c for c in page["controls"] if c["axis"]]
    assert (speed["name"], speed["unit"], speed["size"]) == ("s", "1", 4.0)
    assert speed["value"] * speed["size"] == pytest.approx(3.27)
    assert set(page["overview"]["units"].values()) == {"1"}


def test_a_model_that_cannot_run_in_a_browser_has_stored_motions_and_says_so(evidence, monkeypatch):
    def refused(*_args, **_options):
        raise NoBrowserKernelError("its rates call erf")

    monkeypatch.setattr(saved_page, "live_points", refused)
    monkeypatch.setattr(stored_motions, "POINTS", 2)
    found = explored(evidence, 0.0, evidence.diagrams[0.0])
    data, packed = saved_page.saved_data(found)
    assert data["note"].startswith("Motions are not computed here, for its rates call erf. The nearest of 2 stored motions")
    assert len(data["stored"]["motions"]) == 2
    assert packed
