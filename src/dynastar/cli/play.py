"""``dynastar play``: a simulated world to drive in and to change, live in the browser."""

import argparse
import sys

from dynastar import io
from dynastar.cli.parsing import path, port
from dynastar.config import choose
from dynastar.extras import how_to_install, require

DESCRIPTION = (
    "Serves a page that drives a scene live: set goals by clicks, paint obstacles, "
    "put walkers in its way, change weights, and see what it considers."
)

EXAMPLES = f"""\
examples:
  dynastar play
  dynastar play crowd --open
  dynastar play my_scene.toml --port 9000
  dynastar play --host 0.0.0.0        # for others, too: the address that is printed has a token

Needs {how_to_install("play")}.
The page saves the scene as a scenario file and the drive as an episode, for dynastar run and dynastar
view."""

SCENES = ("office", "twenty", "field", "crowd", "u_trap")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "scenario",
        nargs="?",
        metavar="SCENARIO",
        type=path,
        default="office",
        help="office, twenty, field, crowd, u_trap, or a scenario file (default office)",
    )
    parser.add_argument(
        "--host", default="127.0.0.1", metavar="H", help="address to serve at (default 127.0.0.1)"
    )
    parser.add_argument(
        "--port", type=port, default=8642, metavar="N", help="0: any free one (default 8642)"
    )
    parser.add_argument("--open", action="store_true", help="open it in the browser")


def execute(arguments: argparse.Namespace) -> int:
    """Serves the page until it is interrupted."""
    import webbrowser

    from dynastar.cli.compiling import prepare
    from dynastar.io.examples import example_scenarios

    scenes = {name: file for name, file in example_scenarios().items() if name in SCENES}
    scenes = {name: scenes[name] for name in SCENES}
    given = arguments.scenario
    named = given.suffix == "" and not given.is_file()
    scenario = io.load_scenario(choose(str(given), scenes, "scene") if named else given)
    require("play", "the playground needs")
    prepare()
    from dynastar.play.server import serve
    from dynastar.play.session import Session
    from dynastar.simulation import warm_up

    warm_up()

    def ready(address: str) -> None:
        print(address, flush=True)
        print("open it in a browser; Ctrl-C ends it", file=sys.stderr)
        if arguments.open and not webbrowser.open(address):
            print("no browser was found", file=sys.stderr)

    serve(Session(scenario, scenes), arguments.host, arguments.port, ready)
    return 0
