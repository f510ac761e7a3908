"""``python -m dynastar``, and the command ``dynastar``."""

import sys

from dynastar.interrupt import interrupt_cleanly


def start() -> int:
    """Runs a command and returns its exit status."""
    interrupt_cleanly()
    from dynastar.cli import main

    return main()


if __name__ == "__main__":
    sys.exit(start())
