"""pytest --validation PAGE: run the tests that record rows, and write the page of what they checked.

Without the option the fixture compares and asserts all the same.
"""

import platform
import subprocess
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path

import pytest
from tests.validation.page import Checked, page
from tests.validation.rows import Validation


@pytest.fixture
def validate(request):
    """Compare with a known answer, and record the row of the validation page."""
    return Validation(request)


def pytest_addoption(parser):
    parser.addoption("--validation", metavar="PAGE", help="Run the tests that record known answers, and write their page.")


def pytest_configure(config):
    if config.getoption("validation"):
        config.pluginmanager.register(Collector(config), "validation-page")


class Collector:
    """Rows of a run, and the page that they become at its end."""

    def __init__(self, config):
        self.file, self.tests = config.invocation_params.dir / config.getoption("validation"), []
        self.worker = hasattr(config, "workerinput")

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, config, items):
        """Only tests that record are run."""
        chosen = [item for item in items if "validate" in getattr(item, "fixturenames", ())]
        config.hook.pytest_deselected(items=[item for item in items if item not in set(chosen)])
        items[:] = chosen

    def pytest_runtest_logreport(self, report):
        """Take the rows of a test that ran, or the news that it could not."""
        expected = getattr(report, "wasxfail", None)
        ran = report.when == "call" and (report.outcome != "skipped" or expected is not None)
        if ran or report.failed:
            rows = [row for name, row in report.user_properties if name == "validation"] if report.when == "call" else []
            outcome = "xfailed" if expected is not None and report.outcome == "skipped" else report.outcome
            file, line, _ = report.location
            self.tests.append(((file, line or 0, report.nodeid), Checked(report.nodeid, rows, outcome, expected)))

    def pytest_sessionfinish(self, session, exitstatus):
        """Write the page, of a run that was not interrupted."""
        if not self.worker and exitstatus in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
            tests = [test for _, test in sorted(self.tests, key=lambda one: one[0])]  # in the order of the files
            self.file.write_text(page(tests, provenance(session.config.rootpath)), encoding="utf-8")


def provenance(root: Path) -> str:
    """When, with which version, and on what."""
    asked = ["git", "-C", str(root), "describe", "--always", "--dirty"]
    found = subprocess.run(asked, capture_output=True, text=True, check=False).stdout.strip()
    numerical = ", ".join(f"{name} {version(name)}" for name in ("numpy", "scipy", "numba", "llvmlite"))
    return (
        f"Run on {datetime.now(UTC):%Y-%m-%d} with whirlmap {version('whirlmap')}{f' ({found})' if found else ''},"
        f" Python {platform.python_version()}, {numerical}; {platform.system()} {platform.machine()}."
    )
