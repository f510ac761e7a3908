"""``dynastar play``: a simulated world to drive in and to change, live in the browser."""

import argparse
import sys
import webbrowser

from dynastar import io
from dynastar.cli.compiling import prepare
from dynastar.config import choose
from dynastar.extras import require
from dynastar.io.examples import example_scenarios

SCENES = ("office", "twenty", "field", "crowd", "u_trap")


def execute(arguments: argparse.Namespace) -> int:
    """Serves the page until it is interrupted."""
    scenes = {name: file for name, file in example_scenarios().items() if name in SCENES}
    scenes = {name: scenes[name] for name in SCENES}
    given = arguments.scenario
    named = given.suffix == "" and not given.exists()
    scenario = io.load_scenario(choose(str(given), scenes, "scene") if named else given)
    require("play", "the playground needs")
    prepare()
    from dynastar.play.server import serve
    from dynastar.play.session import Session

    def ready(address: str) -> None:
        print(address, flush=True)
        print("open it in a browser; Ctrl-C ends it", file=sys.stderr)
        if arguments.open and not webbrowser.open(address):
            print("no browser was found", file=sys.stderr)

    serve(Session(scenario, scenes), arguments.host, arguments.port, ready)
    return 0
