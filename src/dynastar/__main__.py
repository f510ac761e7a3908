"""``python -m dynastar``."""

import sys

from dynastar.cli import main

if __name__ == "__main__":
    sys.exit(main())
