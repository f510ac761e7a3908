"""A report in a real browser: scrubbed, played, by the keyboard, with the numbers of the episode."""

from dataclasses import replace
from pathlib import Path

import pytest

from browsing import fading, hidden_by_its_box, too_small
from dynastar import io
from dynastar.page import write_report

EXAMPLES = Path(__file__).parents[2] / "examples"


@pytest.fixture(scope="module")
def report(tmp_path_factory):
    folder = tmp_path_factory.mktemp("report")
    scenario = replace(io.load_scenario(EXAMPLES / "features" / "movers.toml"), time_limit=10.0)
    episode = io.run(scenario, trace=True)
    other = io.run(replace(scenario, preset="paper"))
    write_report([episode], folder / "one.html")
    write_report([episode, other], folder / "two.html")
    return folder, episode


def opened(page, path):
    page.goto(path.as_uri())
    page.wait_for_function("window.dynastar")


def test_it_is_scrubbed(page, report):
    folder, episode = report
    opened(page, folder / "one.html")
    page.locator("#time").fill("4.03")
    frame = page.evaluate("dynastar.frame()")
    assert frame["tick"] == 40
    x, y, _ = episode.trajectory.poses[40]
    assert frame["pose"][:2] == pytest.approx((x, y), abs=0.03)
    assert frame["state"] == episode.states[40]
    assert page.locator(".words b").inner_text() == episode.states[40]
    assert len(frame["candidates"]) == episode.trace.candidate_rows[40]
    assert "4.0 of" in page.locator("#clock").inner_text()
    assert page.locator("canvas.map").screenshot() != blank(page)


def blank(page):
    """The map's canvas with nothing on it."""
    page.evaluate("document.querySelector('canvas.map').width = 10")
    return page.locator("canvas.map").screenshot()


def test_it_is_played_and_answers_the_keyboard(page, report):
    opened(page, report[0] / "one.html")
    page.keyboard.press("End")
    assert page.evaluate("dynastar.time() === dynastar.end")
    page.keyboard.press("Home")
    for _ in range(3):
        page.keyboard.press("ArrowRight")
    assert page.evaluate("dynastar.frame().tick") == 3
    page.keyboard.press("ArrowLeft")
    assert page.evaluate("dynastar.frame().tick") == 2
    page.locator("#speed").select_option("10")
    page.locator("h1").first.click()
    page.keyboard.press(" ")
    page.wait_for_function("dynastar.time() > 3")
    page.keyboard.press(" ")
    stopped = page.evaluate("dynastar.time()")
    page.wait_for_timeout(200)
    assert page.evaluate("dynastar.time()") == stopped


def test_a_candidate_says_why(page, report):
    opened(page, report[0] / "one.html")
    page.evaluate("dynastar.seek(2)")
    box = page.locator("canvas.window").bounding_box()
    for x, y, _ in page.evaluate("dynastar.panels()[0].candidates.dots"):
        assert y > 20  # below the line that names the axes
        page.mouse.move(box["x"] + x, box["y"] + y)
        words = page.locator(".hint").inner_text()
        assert "score" in words or "refused:" in words, words


def test_an_episode_without_candidates_says_how_they_are_recorded(page, report):
    opened(page, report[0] / "two.html")
    said = [hint.inner_text() for hint in page.locator(".hint").all()]
    assert ["trace=True" in words for words in said] == [False, True], said


def test_it_is_said_while_it_plays(page, report):
    opened(page, report[0] / "one.html")
    page.evaluate("dynastar.seek(2)")
    x, y, _ = page.evaluate("dynastar.panels()[0].candidates.dots[5]")
    box = page.locator("canvas.window").bounding_box()
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.keyboard.press(" ")
    page.wait_for_function("dynastar.time() > 3")
    assert "Point at one" not in page.locator(".hint").inner_text()


def test_controls_fit_a_finger_and_the_legend_hides_layers(page, report):
    opened(page, report[0] / "one.html")
    page.evaluate("dynastar.seek(4)")
    assert too_small(page) == []
    assert page.locator("#legend label").count() == 8
    assert all(hidden_by_its_box(page, layer) for layer in ("plans", "driven", "candidates"))
    assert fading(page) == pytest.approx([1.0, 0.5, 0.1, 0.0])


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("name", ["one.html", "two.html"])
def test_axe_finds_nothing_serious(page, report, complaints, name, scheme):
    page.emulate_media(color_scheme=scheme)
    opened(page, report[0] / name)
    page.evaluate("dynastar.seek(4)")
    assert complaints(page) == {}


def test_two_episodes_share_the_clock_and_a_phone_shows_them_below_each_other(page, report):
    page.set_viewport_size({"width": 390, "height": 800})
    opened(page, report[0] / "two.html")
    page.evaluate("dynastar.seek(5)")
    views = page.locator(".view")
    assert views.count() == 2
    first, second = (views.nth(k).bounding_box() for k in range(2))
    assert second["y"] >= first["y"] + first["height"]
    assert page.evaluate("document.documentElement.scrollWidth <= innerWidth")
    page.set_viewport_size({"width": 1400, "height": 800})
    assert views.nth(0).bounding_box()["y"] == views.nth(1).bounding_box()["y"]


def test_it_draws_more_than_twenty_frames_a_second_beside_other_tests(page, report):
    opened(page, report[0] / "two.html")
    drawn = page.evaluate(
        """async () => {
            document.getElementById("speed").value = "5";
            document.getElementById("play").click();
            const begin = performance.now();
            let frames = 0;
            await new Promise((done) => {
                const count = () => {
                    frames += 1;
                    if (performance.now() - begin < 1500) requestAnimationFrame(count);
                    else done();
                };
                requestAnimationFrame(count);
            });
            return frames / 1.5;
        }"""
    )
    print(f"{drawn:.0f} frames a second")
    assert drawn > 20.0
