"""The playground under load: rate of the robot's loop and of the page's drawing.

Serves the office with 25 x 41 samples in the window, one page in chromium and some more without drawing,
and says how often the loop ticked and the page drew, and how long commands took.

    python benchmarks/play.py --pages 4 --seconds 60
"""

import argparse
import json
import shutil
import statistics
import subprocess
import sys
import threading
import time
from itertools import pairwise

from playwright.sync_api import sync_playwright
from websockets.sync.client import connect

SAMPLES = {"dwa.v_samples": 25, "dwa.omega_samples": 41}
WARM = 5.0  # s


def listen(address: str, over: threading.Event) -> None:
    """A page that takes all it is sent and draws nothing."""
    with connect(address.replace("http", "ws", 1) + "socket", max_size=None) as socket:
        while not over.is_set():
            socket.recv(timeout=10.0)


def watch(address: str, seconds: float) -> dict[str, float]:
    """A page with 1025 samples: its figures over some seconds."""
    ticks: list[tuple[float, int]] = []
    milliseconds: list[float] = []
    with connect(address.replace("http", "ws", 1) + "socket", max_size=None) as socket:
        for name, value in SAMPLES.items():
            socket.send(json.dumps({"type": "set", "name": name, "value": value}))
        socket.send(json.dumps({"type": "pause", "paused": False}))
        begin = time.monotonic() + WARM
        samples = 0
        while time.monotonic() < begin + seconds:
            for message in json.loads(socket.recv(timeout=10.0)):
                if time.monotonic() < begin:
                    continue
                if message["type"] == "loop":
                    ticks.append((time.monotonic(), message["ticks"]))
                elif message["type"] == "frame":
                    milliseconds.append(message["commandMs"])
                    samples = max(samples, len(message["candidates"]["data"]) * 3 // 64)
    gaps = [b[0] - a[0] for a, b in pairwise(ticks)]
    return {
        "loop_hz": (ticks[-1][1] - ticks[0][1]) / (ticks[-1][0] - ticks[0][0]),
        "longest_gap_ms": 1e3 * max(gaps),
        "samples": samples,
        "command_ms_median": statistics.median(milliseconds),
        "command_ms_max": max(milliseconds),
    }


def main() -> None:
    """Serves, watches and prints."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--pages", type=int, default=4)
    parser.add_argument("--seconds", type=float, default=60.0)
    options = parser.parse_args()
    words = [sys.executable, "-m", "dynastar", "play", "office", "--port", "0"]
    server = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
    assert server.stdout is not None
    address, over = server.stdout.readline().strip(), threading.Event()
    threads = [
        threading.Thread(target=listen, args=(address, over)) for _ in range(options.pages - 2)
    ]
    for thread in threads:
        thread.start()
    try:
        with sync_playwright() as playwright:
            chromium = shutil.which("chromium") or shutil.which("chromium-browser")
            browser = playwright.chromium.launch(executable_path=chromium, args=["--no-sandbox"])
            page = browser.new_page(viewport={"width": 1280, "height": 900})
            page.goto(address)
            found: dict[str, float] = {}
            watcher = threading.Thread(target=lambda: found.update(watch(address, options.seconds)))
            watcher.start()
            page.wait_for_timeout(1000.0 * WARM)
            drawn, began = page.evaluate("dynastar.page.drawn"), time.monotonic()
            page.wait_for_timeout(1000.0 * options.seconds)
            frames = page.evaluate("dynastar.page.drawn") - drawn
            found["drawn_hz"] = frames / (time.monotonic() - began)
            watcher.join()
            browser.close()
    finally:
        over.set()
        for thread in threads:
            thread.join()
        server.terminate()
    for name, value in found.items():
        print(f"{name:18} {value:8.1f}")


if __name__ == "__main__":
    main()
