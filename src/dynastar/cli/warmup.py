"""``dynastar warmup``: compile everything before it is needed."""

import argparse
import sys

from dynastar import compiled
from dynastar.cli.compiling import prepare


def execute(arguments: argparse.Namespace) -> int:
    """Compiles what the cache lacks, or deletes the cache."""
    if arguments.clear:
        kept = compiled.caches()
        print(f"{compiled.clear() / 1e6:.0f} MB deleted from {kept}", file=sys.stderr)
    elif prepare() == 0.0:
        print(f"all kernels of this version are in {compiled.folder()}", file=sys.stderr)
    return 0
