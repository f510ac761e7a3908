"""``dynastar warmup``: compile everything before it is needed."""

import argparse
import sys

DESCRIPTION = "Compiles the kernels of planning, sensing and driving into the cache."

EXAMPLES = """\
examples:
  dynastar warmup
  dynastar warmup --clear

The kernels lie in ~/.cache/dynastar (or $XDG_CACHE_HOME/dynastar), a folder for each version of
their sources; $NUMBA_CACHE_DIR, if it is set, is where they lie instead and is not cleared."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "--clear", action="store_true", help="delete the compiled kernels of all versions instead"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Compiles what the cache lacks, or deletes the cache."""
    from dynastar import compiled
    from dynastar.cli.compiling import prepare

    if arguments.clear:
        kept = compiled.caches()
        print(f"{compiled.clear() / 1e6:.0f} MB deleted from {kept}", file=sys.stderr)
    elif prepare() == 0.0:
        print(f"all kernels of this version are in {compiled.folder()}", file=sys.stderr)
    return 0
