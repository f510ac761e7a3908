"""``dynastar play`` as a process, for the tests of the server and of the page."""

import os
import subprocess
import sys


def started(*options, scene="u_trap"):
    """``dynastar play`` on a free port, and the address that it prints."""
    process = subprocess.Popen(
        [sys.executable, "-m", "dynastar", "play", str(scene), "--port", "0", *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env={**os.environ, "PYTHONUNBUFFERED": "1"},
    )
    line = process.stdout.readline().strip()
    assert line.startswith("http://"), process.stderr.read()
    return process, line


def ended(process):
    """Interrupts it; it has to end well and without a traceback."""
    process.send_signal(2)
    _, errors = process.communicate(timeout=120)
    assert process.returncode == 0, errors
    assert "Traceback" not in errors, errors
