"""Remakes the pictures of the README and the guides; needs chromium and playwright.

    make pictures

The replay and the animation are of ``dynastar demo``; the playground's picture and the close-up among
walkers are of the scene crowd; the planners are compared on the map of the office.
"""

import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import close_up
import planners_compared
from playwright.sync_api import Browser, Page, sync_playwright

MEDIA = Path(__file__).parent / "media"
REPLAY_AT = 27.5  # s, before the walker of the open-plan office
PLAY_AT = 6.0  # s


def main() -> None:
    """Runs the demo, and takes both pages' pictures."""
    close_up.draw(MEDIA / "among-people.webp")
    planners_compared.draw(MEDIA / "planners.png")
    chromium = shutil.which("chromium") or shutil.which("chromium-browser")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as playwright:
        demo = Path(folder, "demo")
        subprocess.run([sys.executable, "-m", "dynastar", "demo", "--out", demo], check=True)
        shutil.copy(demo / "animation.gif", MEDIA / "office.gif")
        browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
        page = opened(browser)
        replay(page, demo / "report.html")
        playground(page)
        browser.close()


def opened(browser: Browser) -> Page:
    """A tab that shows all charts; the pages forbid eval, which wait_for_function needs."""
    return browser.new_page(viewport={"width": 1200, "height": 1176}, bypass_csp=True)


def replay(page: Page, report: Path) -> None:
    """The demo's replay, at a moment that has something to see."""
    page.goto(report.as_uri())
    page.wait_for_function("window.dynastar")
    page.evaluate(f"dynastar.seek({REPLAY_AT})")
    page.locator("#legend input[name=follow]").check()
    page.evaluate("scrollTo(0, 0)")
    page.wait_for_timeout(500)
    page.screenshot(path=MEDIA / "replay.png")


def playground(page: Page) -> None:
    """The crowd's hall, live."""
    words = [sys.executable, "-m", "dynastar", "play", "crowd", "--port", "0"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as server:
        try:
            assert server.stdout is not None
            page.goto(server.stdout.readline().strip())
            page.locator("#pause").click()  # the scene waits to be started
            page.wait_for_function(f"dynastar.frame().time > {PLAY_AT}")
            page.screenshot(path=MEDIA / "play.png")
        finally:
            server.send_signal(signal.SIGINT)


if __name__ == "__main__":
    main()
