"""``python -m dynastar.ros``: the navigator's node."""

import sys

from dynastar.ros.main import navigate

if __name__ == "__main__":
    sys.exit(navigate(sys.argv))
