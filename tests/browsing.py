"""What the tests of both pages look for in the browser."""

TOUCHED = "button, select, summary, label, a, input[type=range]"  # what a finger has to hit


def too_small(page, side=44):
    """The controls that are smaller than ``side`` pixels, with their sizes."""
    return page.evaluate(
        """([controls, side]) => [...document.querySelectorAll(controls)]
            .map((one) => [one.outerHTML.slice(0, 80), one.getBoundingClientRect()])
            .filter(([, box]) => box.width > 0 && (box.width < side || box.height < side))
            .map(([words, box]) => `${words}: ${box.width} x ${box.height}`)""",
        [TOUCHED, side],
    )


def fading(page):
    """How visible a path is that was replaced 0, 5, 9 and 11 s ago."""
    return page.evaluate(
        """() => [0, 5, 9, 11].map((age) => olderPaths([{ time: 100, points: [] }], 100 + age))
            .map((found) => found.length ? found[0].alpha : 0)"""
    )


def hidden_by_its_box(page, layer):
    """Whether the map is drawn without a layer once its box in the legend is cleared."""
    box = page.locator(f"#legend input[name={layer}]")
    before = page.locator("canvas.map").screenshot()
    box.uncheck()
    page.wait_for_timeout(200)
    after = page.locator("canvas.map").screenshot()
    box.check()
    return before != after
