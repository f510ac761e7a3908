"""The playground in a real browser: sent, blocked, crossed, saved; on a desk, a phone, by the keyboard."""

import re

import pytest

from browsing import fading, hidden_by_its_box, too_small
from playing import ended, started

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")

STATE = "dynastar.frame().state"


@pytest.fixture(scope="module")
def address():
    process, line = started(scene="u_trap")
    yield line
    ended(process)


@pytest.fixture
def live(page, address):
    """The page with a hall whose robot stands at (1.5, 5); there is nothing in its west."""
    page.goto(address)
    page.wait_for_function("window.dynastar && dynastar.frame()")
    page.keyboard.press("r")
    page.wait_for_function("dynastar.page.live.waiting")
    return page


def place(page, x, y):
    """Where a place of the world is on the page."""
    return page.evaluate(
        """([x, y]) => {
            const view = dynastar.page.panel.view, box = view.canvas.getBoundingClientRect();
            return [box.left + view.width / 2 + (x - view.centre[0]) * view.scale,
                box.top + view.height / 2 - (y - view.centre[1]) * view.scale];
        }""",
        [x, y],
    )


def click(page, x, y, modifiers=()):
    for key in modifiers:
        page.keyboard.down(key)
    page.mouse.click(*place(page, x, y))
    for key in modifiers:
        page.keyboard.up(key)


def stroke(page, tool, *places):
    page.keyboard.press(tool)
    page.mouse.move(*place(page, *places[0]))
    page.mouse.down()
    for at in places[1:]:
        page.mouse.move(*place(page, *at), steps=8)
    page.mouse.up()


def touched(page):
    return page.evaluate("dynastar.frame().touched")


def keep(page, name, folder):
    path = folder / f"{name}.png"
    page.screenshot(path=path)
    assert path.stat().st_size > 20_000


def test_a_click_sends_the_robot_and_it_arrives(live, tmp_path):
    live.keyboard.press("g")
    click(live, 3.0, 8.0)
    click(live, 1.5, 8.0, ["Shift"])
    live.wait_for_function("dynastar.frame().goals.length === 2")
    keep(live, "sent", tmp_path)
    live.wait_for_function(f"{STATE} === 'arrived'", timeout=60_000)
    x, y, _ = live.evaluate("dynastar.frame().pose")
    assert (x, y) == pytest.approx((1.5, 8.0), abs=0.3)
    assert touched(live) == {"moving": 0, "resting": 0}


def test_it_draws_under_its_content_security_policy(chromium, address):
    page, errors = chromium.new_page(), []
    page.on("console", lambda said: errors.append(said.text) if said.type == "error" else None)
    page.goto(address)
    drawn = [page.evaluate("dynastar.page.drawn || 0")]
    while drawn[-1] < 10 and len(drawn) < 100:
        page.wait_for_timeout(100)
        drawn.append(page.evaluate("dynastar.page.drawn || 0"))
    page.close()
    assert drawn[-1] >= 10
    assert errors == []


def test_a_scene_waits_for_the_first_goal(live, tmp_path):
    assert live.locator("#pause").inner_text() == "Start"
    assert live.locator(".words").inner_text().startswith("ready\nClick on the map")
    keep(live, "waiting", tmp_path)
    live.evaluate("drawCallout = (view, words) => { window.said = words; }")
    live.wait_for_function("window.said === 'click to send me'")
    live.wait_for_timeout(300)
    assert live.evaluate("dynastar.frame().time") == 0.0
    live.keyboard.press("g")
    click(live, 3.0, 8.0)
    live.wait_for_function("dynastar.frame().time > 0.3")
    assert live.locator("#pause").inner_text() == "Pause"


def test_goals_and_walkers_set_while_it_is_paused_are_drawn(live):
    live.keyboard.press("g")
    click(live, 4.0, 8.5)
    live.wait_for_function("dynastar.frame().time > 0.3")
    live.locator("#pause").click()
    live.wait_for_function("dynastar.page.paused")
    time, before = live.evaluate("dynastar.frame().time"), live.locator("canvas.map").screenshot()
    click(live, 3.0, 3.0)
    live.wait_for_function("Math.abs(dynastar.page.live.scene.goals[0][1] - 3) < 0.05")
    stroke(live, "w", (4.5, 7.5), (4.5, 7.5))
    live.wait_for_function("dynastar.page.live.frame().movers.length === 1")
    live.wait_for_timeout(100)
    assert live.locator("canvas.map").screenshot() != before
    assert live.evaluate("dynastar.frame().time") == time


def test_pointing_at_a_candidate_says_why_while_it_drives(live):
    live.keyboard.press("g")
    click(live, 4.0, 8.5)
    live.wait_for_function("dynastar.frame().candidates.length > 20")
    x, y, _ = live.evaluate("dynastar.page.panel.candidates.dots[5]")
    box = live.locator("canvas.window").bounding_box()
    live.mouse.move(box["x"] + x, box["y"] + y)
    live.wait_for_function("dynastar.page.panel.candidates.hint.textContent.includes('score')")
    time, said = live.evaluate("dynastar.frame().time"), set()
    while live.evaluate("dynastar.frame().time") < time + 0.5:
        said.add(live.locator(".hint").inner_text())
    assert said
    assert not any("Point at one" in words for words in said)


def test_the_settings_are_beside_the_map_and_controls_fit_a_finger(live):
    here, there = (live.locator(k).bounding_box() for k in ("canvas.map", "#sliders"))
    assert there["x"] >= here["x"] + here["width"]
    assert there["y"] < here["y"] + 0.5 * here["height"]
    assert too_small(live) == []
    live.set_viewport_size({"width": 390, "height": 800})
    assert too_small(live) == []


def test_the_legend_hides_layers_and_old_paths_fade(live):
    assert live.locator("#legend label").count() == 8
    assert live.locator("#legend .sign").count() == 14
    live.keyboard.press("g")
    click(live, 4.5, 8.5)
    live.wait_for_function("dynastar.page.live.end > 1")
    live.locator("#pause").click()
    live.wait_for_function("dynastar.page.paused")
    assert all(hidden_by_its_box(live, layer) for layer in ("plans", "driven", "candidates"))
    assert fading(live) == pytest.approx([1.0, 0.5, 0.1, 0.0])


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_axe_finds_nothing_serious(live, complaints, scheme):
    live.emulate_media(color_scheme=scheme)
    live.keyboard.press("g")
    click(live, 0.1, 0.1)
    click(live, 4.0, 8.5)
    live.wait_for_function("dynastar.frame().candidates.length > 20")
    assert live.locator("#message").is_visible()
    assert complaints(live) == {}


def test_a_drag_sets_the_heading(live):
    stroke(live, "g", (3.0, 6.0), (3.0, 7.0))
    live.wait_for_function("dynastar.frame().goals[0][2] !== null")
    live.wait_for_function(f"{STATE} === 'arrived'", timeout=60_000)
    assert live.evaluate("dynastar.frame().pose[2]") == pytest.approx(1.571, abs=0.15)


def test_a_wall_that_is_painted_across_the_way_is_driven_round(live, tmp_path):
    live.keyboard.press("g")
    click(live, 4.5, 8.5)
    live.wait_for_function("dynastar.page.live.plans.length >= 1")
    stroke(live, "p", (2.0, 7.5), (3.0, 6.5), (4.5, 6.2))
    live.wait_for_function("dynastar.page.live.scene.obstacles.length > 3")
    plans = live.evaluate("dynastar.page.live.plans.length")
    live.wait_for_function(f"{STATE} === 'arrived'", timeout=60_000)
    keep(live, "painted", tmp_path)
    assert live.evaluate("dynastar.page.live.plans.length") > plans
    assert live.evaluate("dynastar.page.live.known.size") > 10
    assert touched(live) == {"moving": 0, "resting": 0}


def test_a_walker_is_put_in_its_way_pushed_and_never_run_into(live, tmp_path):
    live.keyboard.press("g")
    click(live, 4.0, 8.5)
    stroke(live, "w", (4.5, 7.5), (4.2, 7.2))
    live.wait_for_function("dynastar.frame().movers.length === 1")
    live.wait_for_function("dynastar.frame().tracks.length >= 1", timeout=20_000)
    keep(live, "walker", tmp_path)
    _, x, y, _ = live.evaluate("dynastar.frame().movers[0]")
    stroke(live, "w", (x, y), (x, y + 0.6))
    live.wait_for_function(f"{STATE} === 'arrived'", timeout=90_000)
    assert touched(live)["moving"] == 0


def test_sliders_presets_scenes_and_the_pause(live):
    slider = live.locator("input[name='dwa.v_samples']")
    slider.fill("25")
    live.locator("input[name='dwa.omega_samples']").fill("41")
    live.keyboard.press("g")
    click(live, 3.0, 8.0)
    live.wait_for_function("dynastar.frame().candidates.length > 800")
    live.locator("#presets").select_option("paper")
    live.wait_for_function("dynastar.page.live.last && dynastar.frame().candidates.length < 400")
    live.locator("#pause").click()
    live.wait_for_function("dynastar.page.paused")
    time = live.evaluate("dynastar.frame().time")
    live.locator("#step").click()
    live.wait_for_function(f"dynastar.frame().time > {time} + 0.04")
    assert live.evaluate("dynastar.frame().time") == pytest.approx(time + 0.05)
    live.locator("#pause").click()
    for scene in ("office", "crowd", "u_trap"):
        live.locator("#scenes").select_option(scene)
        live.wait_for_function(f"dynastar.page.live.name === '{scene}' && dynastar.frame()")
    live.locator("#presets").select_option("default")


def test_it_is_worked_by_the_keyboard_alone(live):
    live.locator("canvas.map").focus()
    live.keyboard.press("g")
    for _ in range(2):
        live.keyboard.press("Shift+ArrowUp")
    live.keyboard.press("Enter")
    live.wait_for_function(
        "dynastar.frame().goals.length === 1 && dynastar.frame().goals[0][1] > 6.5"
    )
    live.wait_for_function(f"{STATE} === 'arrived'", timeout=60_000)


def test_what_is_refused_is_said(live):
    live.keyboard.press("g")
    click(live, 0.1, 0.1)
    live.wait_for_function("document.getElementById('notice').textContent.includes('wall')")
    live.locator("#dismiss").click()
    assert not live.locator("#message").is_visible()
    click(live, 0.1, 0.1)
    live.locator("#notice").click()
    assert not live.locator("#message").is_visible()
    click(live, 0.1, 0.1)
    live.locator("#message").wait_for(state="visible")
    live.locator("#message").wait_for(state="hidden")


def test_a_replay_of_what_was_driven_is_scrubbed(live, tmp_path):
    live.keyboard.press("g")
    click(live, 3.0, 8.0)
    live.wait_for_function(f"{STATE} === 'arrived'", timeout=60_000)
    with live.expect_popup() as opened:
        live.locator("#report").click()
    report = opened.value
    report.wait_for_function("window.dynastar && dynastar.end > 3")
    report.locator("#time").fill("2")
    assert report.evaluate("dynastar.frame().tick") == 40
    keep(report, "replay", tmp_path)
    with live.expect_download() as download:
        live.locator("#scene").click()
    assert download.value.suggested_filename == "scene.zip"


def test_it_fits_a_phone_and_the_dark(live, tmp_path):
    live.set_viewport_size({"width": 390, "height": 800})
    live.emulate_media(color_scheme="dark")
    assert live.evaluate("document.documentElement.scrollWidth <= innerWidth")
    keep(live, "phone", tmp_path)
    assert re.match(r"rgb\(2\d,", live.evaluate("getComputedStyle(document.body).backgroundColor"))


def test_it_comes_back_when_the_server_does(chromium):
    process, address = started()
    page = chromium.new_page(bypass_csp=True)  # whose errors are of the connection
    port = address.rstrip("/").rpartition(":")[2]
    page.goto(address)
    page.wait_for_function("window.dynastar && dynastar.frame()")
    ended(process)
    page.wait_for_function("document.getElementById('notice').textContent.includes('lost')")
    process, _ = started("--port", port)
    page.wait_for_function("document.getElementById('notice').textContent === ''", timeout=20_000)
    ended(process)
    page.close()
