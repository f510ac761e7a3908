"""What all tests share: kernels that can be called, the public data sets, and a real browser."""

import os
import shutil
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

# No test may depend on how fast the machine is.
settings.register_profile(
    "patient",
    deadline=None,
    suppress_health_check=[HealthCheck.too_slow],
    derandomize="CI" in os.environ,  # the same examples on every machine that judges a change
)
settings.load_profile("patient")

ROOT = Path(__file__).parents[1]
os.environ["DYNASTAR_CALLABLE_KERNELS"] = "1"  # before dynastar is imported: tests call kernels


def pytest_sessionstart(session: pytest.Session) -> None:
    """Compiles the kernels once, side by side, and not in each of the test processes."""
    if not hasattr(session.config, "workerinput"):
        from dynastar.cli.compiling import prepare

        prepare()


@pytest.fixture(scope="session")
def data_dir() -> Path:
    """The public data sets, by default of a folder beside the clone; without them, skip."""
    named = os.environ.get("DYNASTAR_DATA")
    folder = Path(named) if named else ROOT.parent / "shared" / "data"
    if named and not folder.is_dir():
        pytest.fail(f"DYNASTAR_DATA is {named}, which is no folder")
    if not folder.is_dir():
        pytest.skip(
            f"the public data sets are not in {folder}: set DYNASTAR_DATA to have them read"
        )
    return folder.resolve()


@pytest.fixture(scope="session")
def chromium():
    """Debian's chromium, driven by playwright; skipped where it is not there."""
    api = pytest.importorskip("playwright.sync_api")
    binary = shutil.which("chromium") or shutil.which("chromium-browser")
    if binary is None:
        pytest.skip("no chromium here: apt-get install chromium")
    with api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=binary, args=["--no-sandbox"])
        yield browser
        browser.close()


@pytest.fixture(scope="session")
def complaints():
    """What axe-core finds on a page that is serious or critical: elements by rule."""
    axe = pytest.importorskip("axe_playwright_python.sync_playwright").Axe()

    def found(page) -> dict[str, list]:
        return {
            rule["id"]: [node["html"][:120] for node in rule["nodes"]]
            for rule in axe.run(page).response["violations"]
            if rule["impact"] in ("serious", "critical")
        }

    return found


@pytest.fixture
def page(chromium):
    """A page whose errors fail the test."""
    # The content security policy would keep playwright's wait_for_function from evaluating words.
    made = chromium.new_page(viewport={"width": 1280, "height": 900}, bypass_csp=True)
    errors = []
    made.on("pageerror", lambda error: errors.append(str(error)))
    made.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    yield made
    made.close()
    assert errors == []
