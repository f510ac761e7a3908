"""Options that several commands take."""

import argparse

PRESETS = ("default", "paper")  # those of dynastar.navigator
ATTENTIONS = ("late", "none")  # those of dynastar.simulation


def add_json(parser: argparse.ArgumentParser) -> None:
    """Add ``--json``."""
    parser.add_argument("--json", action="store_true", help="JSON on stdout instead of a table")


def add_no_gif(parser: argparse.ArgumentParser) -> None:
    """Add ``--no-gif``."""
    parser.add_argument("--no-gif", action="store_true", help="leave out the animation")


def add_set(parser: argparse.ArgumentParser) -> None:
    """Add ``--set``, settings of the navigator."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="KEY=VALUE",
        help="a setting of the navigator, as dwa.horizon=2; repeatable",
    )


def add_robot(parser: argparse._ActionsContainer) -> None:
    """Add ``--robot``, a name or a file, for ``robots.named_robot``."""
    parser.add_argument(
        "--robot", metavar="ROBOT", help="a robot that comes with dynastar, or a TOML file"
    )
