"""Every block of code on the pages, run as a reader would run it: Python, and the commands of shells.

What takes more than about 10 s is marked slow; what cannot be run here is listed with the reason.
"""

import re
import shlex
from itertools import pairwise
from pathlib import Path

import pytest
from typer.testing import CliRunner

from whirlmap.cli.main import app

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
FENCE = re.compile(r"^```(\w*)\n(.*?)^```", re.MULTILINE | re.DOTALL)

#: Start of a command or of a Python block -> why it is not run.
NOT_RUN = {
    "whirlmap identify": "a search of hours; tests/cli/test_cli_identify.py runs a small one",
    "whirlmap reproduce": "minutes of full quality; tests/studies runs a small one",
    "whirlmap map gear-psfd/machine": "120 000 points: an hour on 16 cores",
    "whirlmap map duffing --vary gamma=0.1:0.7:400": "120 000 points",
    "whirlmap map duffing --vary gamma=0.2:0.6:80": "a job array of SLURM",
    "whirlmap map --status": "the store of that job array",
    "whirlmap explore": "serves a page until Ctrl-C; tests/cli/test_cli_explore.py and tests/explorer run it",
    "import whirlmap\nimport xarray as xr\n\n\ndef drawn(name": "draws what three long commands write",
    "with SLURMCluster": "needs a cluster",
}  # fmt: skip
#: Start of a command or of a Python block that takes more than about 10 s.
SLOW = (
    "whirlmap bifurcation gear-psfd/intended", "whirlmap speeds", "whirlmap improve",
    "whirlmap bifurcation machines/aero-damper", "whirlmap bifurcation machines/flexible-on-dampers",
    "whirlmap show machines/geared-turbo-set", "whirlmap linear machines/geared-turbo-set",
    "whirlmap bifurcation my_case.toml", "whirlmap bifurcation duffing --set",
    "whirlmap bifurcation rub.toml", "whirlmap continue machines/turbo-gearbox", "whirlmap map duffing --set delta=0.05",
    "whirlmap diagnose --series my_signal.csv", "whirlmap diagnose --series recording.csv --column x --window",
    "whirlmap diagnose gear-psfd/machine", "whirlmap diagnose duffing --set gamma=0.29 --out", "whirlmap attractors",
    "whirlmap simulate machines/jeffcott-rig", "whirlmap show my_train.toml", "whirlmap linear my_train.toml",
    "whirlmap show machines/two-shaft-gearbox", "whirlmap show machines/integrally-geared-compressor",
    "whirlmap bifurcation machines/integrally-geared-compressor",
    "import numpy as np", 'import whirlmap\n\nsystem = whirlmap.load("machines/turbo-gearbox"',
    'import whirlmap\n\nsystem = whirlmap.load("duffing", alpha=1',
)  # fmt: skip

#: Page -> files of models and of cases that it tells the reader to make, in the order of its blocks.
FILES = {
    "your_own_model.md": (("loose_pedestal.py", "spool.py"), ("my_case.toml", "spool.toml")),
    "tutorials/equations-to-diagram.md": (("rub.py",), ("rub.toml",)),
}
#: File that a command reads -> command of the same page that writes it.
WRITTEN = {
    "my_gearbox.toml": ["new", "my_gearbox.toml"],
    "my_train.toml": ["new", "my_train.toml", "--parts"],
    "my_rig.toml": ["new", "my_rig.toml", "--like", "machines/jeffcott-rig"],
    "recording.csv": ["simulate", "duffing", "--set", "gamma=0.29", "--periods", "100", "--out", "recording.csv"],
}
#: The file of the tutorial on signals, which a block of Python there writes.
SIGNAL = "my_signal.csv"


def marked(page, line, code):
    """A block as a parameter of a test: where it stands, and its marks."""
    why = [reason for start, reason in NOT_RUN.items() if code.startswith(start)]
    slow = [pytest.mark.slow, pytest.mark.timeout(3000)] if code.startswith(SLOW) else []
    marks = [pytest.mark.skip(reason=why[0])] if why else slow
    return pytest.param(code, id=f"{page.relative_to(ROOT).as_posix()}:{line}", marks=marks)


def python_blocks():
    for page in PAGES:
        text = page.read_text(encoding="utf-8")
        for found in FENCE.finditer(text):
            if found[1] == "python" and "from whirlmap.equations import" not in found[2]:
                yield marked(page, text[: found.start()].count("\n") + 2, found[2])


def commands():
    """Lines that begin with whirlmap, in fenced blocks of a shell (after a prompt) and in indented ones."""
    for page in PAGES:
        language = None
        for number, line in enumerate(page.read_text(encoding="utf-8").splitlines(), start=1):
            if line.startswith("```"):
                language = None if language is not None else line[3:]
            elif found := re.match(r"(?:    |\$ |exec |)(whirlmap [a-z].*)$", line):
                indented = language is None and line.startswith("    ")
                if indented or (language in ("console", "sh", "") and line[0] != " "):
                    yield marked(page, number, re.sub(r"\s+# .*$", "", found[1]).strip())


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """An empty folder, with the files that pages tell the reader to make, as the current one."""
    for page, (models, cases) in FILES.items():
        text = (ROOT / "docs" / page).read_text(encoding="utf-8")
        found = [
            block for kind, block in FENCE.findall(text) if kind == "python" and "from whirlmap.equations import" in block
        ]
        files = [block for kind, block in FENCE.findall(text) if kind == "toml"]
        for names, texts in ((models, found), (cases, files)):
            for name, block in zip(names, texts, strict=True):
                (tmp_path / name).write_text(block, encoding="utf-8")
    (tmp_path / "docs").mkdir()
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("code", list(python_blocks()))
def test_python(code, folder):
    exec(compile(code, "block", "exec"), {})


@pytest.mark.parametrize("line", list(commands()))
def test_commands(line, folder):
    words = shlex.split(line)[1:]
    for word in words[1:]:
        if word in WRITTEN and WRITTEN[word] != words:
            CliRunner().invoke(app, WRITTEN[word])
    if SIGNAL in words:
        page = (ROOT / "docs" / "tutorials" / "recorded-signal.md").read_text(encoding="utf-8")
        exec(compile(FENCE.search(page)[2], "block", "exec"), {})
    done = CliRunner(env={"COLUMNS": "160"}).invoke(app, words)
    assert done.exit_code == 0, done.output
    written = [w for flag, w in pairwise(words) if flag in ("--out", "--animate")]
    assert all(Path(w).exists() for w in written) and (written or done.output.strip())


def test_what_is_not_run_stands_on_a_page():
    """Of the lists above nothing is left over when a page changes."""
    found = [p.values[0] for p in (*python_blocks(), *commands())]
    assert len(found) > 40
    for start in (*NOT_RUN, *SLOW):
        assert any(code.startswith(start) for code in found), start
