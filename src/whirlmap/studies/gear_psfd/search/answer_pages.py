"""The answer of a search as Markdown tables, pictures and cases."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from whirlmap.errors import OutputError
from whirlmap.plot.common.save import encode
from whirlmap.results.files import replace_file
from whirlmap.studies.gear_psfd.claims.labelled import PSI
from whirlmap.studies.gear_psfd.search.answer import (
    ENOUGH,
    EXPECTED,
    Answer,
    Best,
    contact_by_psi,
    edition_share,
    exclusions,
    pinned,
    pooled,
    regimes,
    shares,
    together,
)
from whirlmap.studies.gear_psfd.search.variants import MEANINGLESS

#: What is between these two lines of a page is replaced.
BEGIN, END = "<!-- begin: whirlmap identify -->", "<!-- end: whirlmap identify -->"
#: Of the pictures.
DPI = 110
#: Bins of each group's range in the picture of marginals.
BINS = 8


def page(answer: Answer, pictures: Mapping[str, str]) -> str:
    """All tables, and where the pictures are: name of the picture -> path as the page says it."""
    parts = [_variants(answer)]
    for edition in answer.editions:
        parts += [f"### Edition {edition}", _shares(answer, edition), _exclusions(answer, edition)]
        parts += [f"![{alt}]({pictures[name]})" for name, alt in picture_names(edition).items() if name in pictures]
    parts += ["### Best sets", *(_best(edition, b) for edition, b in answer.best.items()), _bests(answer)]
    return "\n\n".join(parts) + "\n"


def picture_names(edition: str) -> dict[str, str]:
    """Stems of the pictures of an edition, and what they show."""
    return {
        f"shares-{edition}": f"Share of sets under which each claim holds, with its 95 % interval; {edition}",
        f"together-{edition}": f"How often two claims hold together, compared with independent ones; {edition}",
        f"marginals-{edition}": f"Where in its range each group lies when a claim holds; {edition}",
    }


def _row(*cells: str) -> str:
    return f"| {' | '.join(cells)} |"


def _table(head: tuple[str, ...], rows: list[tuple[str, ...]]) -> str:
    return "\n".join([_row(*head), _row("---", *["---:"] * (len(head) - 1)), *(_row(*r) for r in rows)])


def _percent(x: float) -> str:
    digits = 0 if x == 0 or x >= 0.1 else 1 if x >= 0.001 else 2
    return f"{100 * x:.{digits}f}"


def _variants(answer: Answer) -> str:
    kinds = list(regimes(answer.judged[0]))
    rows = [
        (f"`{j.variant.name}`", str(j.values.shape[1]), *(_percent(v) for v in regimes(j).values()),
         " / ".join(_percent(v) for v in contact_by_psi(j).values()))
        for j in answer.judged
    ]  # fmt: skip
    at = " / ".join(f"{psi:g}" for psi in PSI)
    left_out = "\n".join(f"- {name}: {why}" for name, why in MEANINGLESS)
    missing = f"\n\nNo set finished yet: {', '.join(f'`{name}`' for name in answer.missing)}." if answer.missing else ""
    return (
        "Operating points of each kind, in percent of all sets, permeabilities and speeds:\n\n"
        + _table(("variant", "sets", *kinds, f"contact at ψ = {at}"), rows)
        + missing
        + f"\n\nNot searched, for it means nothing:\n\n{left_out}"
    )


def _shares(answer: Answer, edition: str) -> str:
    found = answer.of(edition)
    rows = []
    for claim in answer.claims:
        cells = [
            f"{_percent(share)} ({_percent(low)}–{_percent(high)})"
            for share, low, high in (edition_share(answer, edition, claim), *(shares(j, claim) for j in found))
        ]
        rows.append((f"`{claim}`", *cells))
    names = tuple(j.variant.name.removeprefix(f"{edition}-") for j in found)
    return (
        "Sets under which a claim holds, in percent, with the 95 % interval; *all* counts every reading alike:\n\n"
        + _table(("claim", "all", *names), rows)
    )


def _exclusions(answer: Answer, edition: str) -> str:
    never = [c for c in answer.claims if all(shares(j, c)[0] == 0 for j in answer.of(edition))]
    text = f"Claims that hold nowhere: {', '.join(f'`{c}`' for c in never) or 'none'}.\n\n"
    pairs = exclusions(answer, edition)
    if not pairs:
        return text + "No two claims that hold often enough to tell exclude each other."
    lines = [f"- `{p['claims'][0]}` and `{p['claims'][1]}` ({p['expected']:.0f} sets expected)" for p in pairs]
    head = "Claims that never hold together, with the sets that independent claims would share:\n\n"
    return text + head + "\n".join(lines)


def _best(edition: str, best: Best) -> str:
    missed = ", ".join(f"`{c}` ({w})" for c, w in best.missed.items()) or "none"
    values = ", ".join(f"{name} = {value:.4g}" for name, value in best.values.items())
    return (
        f"**{edition}**: `{best.variant.name}`, {len(best.met)} of {len(best.words)} claims, mean score {best.score:.3f},"
        f" from the {'refinement' if best.refined else 'design'}. Missed: {missed}. Values: {values}."
    )


def _bests(answer: Answer) -> str:
    rows: list[tuple[str, ...]] = [
        (f"`{b.variant.name}`", f"{len(b.met)} of {len(b.words)}", f"{b.score:.3f}", "refined" if b.refined else "design",
         ", ".join(f"`{c}`" for c in b.met))
        for b in answer.bests
    ]  # fmt: skip
    return "The best set of each reading:\n\n" + _table(("variant", "claims", "mean score", "from", "which"), rows)


def fill(page_path: Path, text: str) -> None:
    """Put the tables between the two marks of a page.

    Raises
    ------
    OutputError
        Where the page has no such marks.
    """
    before, after = around(page_path)
    new = f"{before}{BEGIN}\n\n{text}\n{END}{after}"
    replace_file(page_path, lambda trial: trial.write_text(new, encoding="utf-8"), force=True)


def around(page_path: Path) -> tuple[str, str]:
    """What stands before and behind the two marks of a page, which `fill` leaves alone; raises what `fill` does."""
    old = page_path.read_text(encoding="utf-8") if page_path.is_file() else ""
    before, begin, rest = old.partition(BEGIN)
    _, end, after = rest.partition(END)
    if not (begin and end):
        raise OutputError(f"{page_path}: expected a page with the lines {BEGIN} and, below it, {END}")
    return before, after


def draw_shares(answer: Answer, edition: str) -> Figure:
    """Draw the share of sets under which each claim holds, for every variant of an edition."""
    found, claims = answer.of(edition), answer.claims
    figure = Figure(figsize=(9, 0.32 * len(claims) * max(len(found) / 3, 1) + 1.6 + 0.12 * len(found)), layout="constrained")
    axes = figure.subplots()
    rows = {f"{j.variant.name.removeprefix(f'{edition}-')} ({j.values.shape[1]} sets)": [shares(j, c) for c in claims]
            for j in found}  # fmt: skip
    rows["all readings, counted alike"] = [edition_share(answer, edition, c) for c in claims]
    for k, (label, triples) in enumerate(rows.items()):
        each = np.array(triples)
        y = np.arange(len(claims)) + (k - (len(rows) - 1) / 2) * 0.8 / len(rows)
        error = np.abs(each[:, 1:].T - each[:, 0])
        axes.errorbar(each[:, 0], y, xerr=error, fmt="o", ms=3.5, lw=1.2, color=f"C{k}" if k < len(found) else "black",
                      label=label)  # fmt: skip
    for y in np.arange(len(claims) + 1) - 0.5:
        axes.axhline(y, color="0.9", lw=0.8, zorder=0)
    axes.set(xlim=(-0.02, 1.02), ylim=(len(claims) - 0.5, -0.5), xlabel="share of sets under which the claim holds")
    axes.set_yticks(range(len(claims)), claims)
    figure.legend(fontsize=8, loc="outside lower center", ncols=2)
    axes.set_title(f"Edition {edition}: how often each claim holds", loc="left", fontsize=11)
    return figure


def draw_together(answer: Answer, edition: str) -> Figure:
    """Draw how often each pair of claims holds together, over what independent claims would do."""
    counts, expected = together(answer, edition)
    claims = answer.claims
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = np.where(expected >= EXPECTED, np.log2(counts / expected), np.nan)
    figure = Figure(figsize=(9, 7.6), layout="constrained")
    axes = figure.subplots()
    np.fill_diagonal(ratio, np.nan)
    image = axes.imshow(np.clip(ratio, -4, 4), cmap="PuOr", vmin=-4, vmax=4)
    for a in range(len(claims)):
        for b in range(len(claims)):
            ink = "white" if abs(np.nan_to_num(ratio[a, b], posinf=0, neginf=-9)) > 2.5 else "black"
            axes.text(b, a, str(counts[a, b]), ha="center", va="center", fontsize=7, color=ink)
    axes.set_xticks(range(len(claims)), claims, rotation=60, ha="right", rotation_mode="anchor")
    axes.set_yticks(range(len(claims)), claims)
    figure.colorbar(image, ax=axes, shrink=0.8, label="log2 of sets with both over independent claims")
    axes.set_title(
        f"Edition {edition}: sets with both claims (diagonal: with the one)\n"
        f"No colour: fewer than {EXPECTED:g} sets expected of independent claims",
        loc="left", fontsize=10,
    )  # fmt: skip
    return figure


def draw_marginals(answer: Answer, edition: str) -> Figure:
    """Draw, for each claim and group, where in its range the group lies when the claim holds."""
    holds, values = pooled(answer, edition)
    read = set.union(*(set(j.variant.system().parameters) for j in answer.of(edition)))
    kept = [k for k, r in enumerate(answer.settings.ranges) if r.name in read]
    ranges = tuple(answer.settings.ranges[k] for k in kept)
    values = values[kept]
    distance, limit = pinned(holds, values, ranges)
    image = np.full((len(holds), len(ranges) * BINS), np.nan)
    for c, row in enumerate(holds):
        if np.isfinite(limit[c]):
            for g, r in enumerate(ranges):
                found = np.histogram(r.place(values[g, row]), BINS, (0, 1))[0]
                image[c, g * BINS : (g + 1) * BINS] = found / found.sum() * BINS
    figure = Figure(figsize=(16, 6.2), layout="constrained")
    axes = figure.subplots()
    with np.errstate(divide="ignore"):
        density = np.clip(np.log2(image), -3, 3)
    shown = axes.imshow(density, cmap="PuOr_r", vmin=-3, vmax=3, aspect="auto", interpolation="none")
    for g in range(1, len(ranges)):
        axes.axvline(g * BINS - 0.5, color="white", lw=2)
    for c in range(len(holds)):
        for g in np.flatnonzero(distance[c] > limit[c]).tolist():
            axes.text((g + 0.5) * BINS - 0.5, c, f"{distance[c, g]:.2f}", ha="center", va="center", fontsize=6.5)
    labels = [f"{r.name}\n{r.low:g}\n–{r.high:g}" for r in ranges]
    axes.set_xticks([(g + 0.5) * BINS - 0.5 for g in range(len(ranges))], labels, fontsize=7)
    axes.set_yticks(range(len(holds)), [f"{c} ({int(h.sum())})" for c, h in zip(answer.claims, holds, strict=True)])
    figure.colorbar(shown, ax=axes, shrink=0.8, label="log2 of density over the design's")
    axes.set_title(
        f"Edition {edition}: where in its range each group lies when a claim holds, as often as in brackets\n"
        "Number: a group that is pinned down, by its Kolmogorov-Smirnov distance from the design"
        " (by chance once in 100 pictures)."
        f" No colour: fewer than {ENOUGH} sets",
        loc="left", fontsize=10,
    )  # fmt: skip
    return figure


DRAW = {"shares": draw_shares, "together": draw_together, "marginals": draw_marginals}


def case_text(edition: str, best: Best, answer: Answer) -> str:
    """Write the case of a best set, as TOML."""
    v = best.variant
    sets = next(j.values.shape[1] for j in answer.judged if j.variant == v)
    origin = "refined from" if best.refined else "one of"
    why = f"whirlmap identify, seed {answer.settings.seed}, {origin} {sets} sets of {v.name}"
    missed = ", ".join(best.missed) or "none"
    lines = [
        f"# Written by `whirlmap identify`: the best set of the edition {edition}. Do not edit; run the search again.",
        'extends = "gear-psfd/machine"',
        'description = """',
        f"The set of the unpublished groups under which most of the paper's claims come true in the edition {edition}:",
        f"{len(best.met)} of the {len(best.words)} that a labelled diagram decides, mean score {best.score:.3f}. Missed:",
        f"{missed}.",
        "Not the paper's own numbers, which it does not give: the best of a search (docs/identification.md).",
        '"""',
        *(f'{name} = "{value}"' for name, value in _switches(best).items()),
        "",
        's = { value = 3.27, source = "changjian-psfd, Figures 6 and 7" }',
        'psi = { value = 1e-3, source = "changjian-psfd, Figures 2 to 5, one of 0, 1e-4, 1e-3 and 0.1" }',
        *(f'{name} = {{ value = {value!r}, assumed = "{why}" }}' for name, value in _numbers(best).items()),
    ]
    return "\n".join(lines) + "\n"


def _switches(best: Best) -> dict[str, str]:
    v = best.variant
    return {"edition": v.edition, "film": v.film, "arc": v.arc, "contact": v.contact}


def _numbers(best: Best) -> dict[str, float]:
    spins = {name: best.variant.changes[name] for name in ("j_p", "j_g")}
    return {**spins, **best.values}


def write_answer(answer: Answer, folder: Path, *, more: str = "", force: bool = False) -> list[Path]:
    """Write tables, pictures and cases to a folder; ``more`` goes below the tables. Returns the files."""
    folder.mkdir(exist_ok=True)
    written = []
    for edition in answer.editions:
        for stem in picture_names(edition):
            figure = DRAW[stem.partition("-")[0]](answer, edition)
            written.append(write_picture(figure, folder / f"{stem}.png", force=force))
    texts = {f"{edition}-best.toml": case_text(edition, best, answer) for edition, best in answer.best.items()}
    texts["answer.json"] = json.dumps(answer.summary(), indent=1)
    texts["answer.md"] = page(answer, {path.stem: path.name for path in written}) + more
    for name, text in texts.items():
        fill_file = lambda trial, text=text: trial.write_text(text, encoding="utf-8")  # noqa: E731
        written.append(replace_file(folder / name, fill_file, force=force))
    return written


def write_picture(figure: Figure, path: Path, *, force: bool) -> Path:
    """Write one picture."""
    return replace_file(path, lambda trial: trial.write_bytes(encode(figure, "png", dpi=DPI)), force=force)
