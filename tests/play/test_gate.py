"""Who is let in."""

import pytest

from dynastar.play import gate
from dynastar.play.gate import Allowance, Gate, is_loopback


@pytest.mark.parametrize("host", ["127.0.0.1:80", "localhost:80", "[::1]:80", "127.0.0.2:80"])
def test_a_page_of_this_machine_gets_in(host):
    door = Gate("127.0.0.1", 80)
    assert door.token == ""
    assert door.refusal({"host": host}, "") == ""
    assert door.refusal({"host": host, "origin": f"http://{host}"}, "") == ""


@pytest.mark.parametrize(
    "headers",
    [
        {"host": "evil.example:80"},  # a name that was made to lead here
        {"host": "127.0.0.1.evil.example:80"},
        {"host": "127.0.0.1:81"},
        {"host": ""},
        {"host": "[::1"},
        {"host": "127.0.0.1:notaport"},
        {"host": "127.0.0.1:80", "origin": "http://evil.example"},
        {"host": "127.0.0.1:80", "origin": "null"},
        {"host": "127.0.0.1:80", "origin": "http://["},
        {"host": "127.0.0.1:80", "origin": "http://127.0.0.1:9999"},
        {},
    ],
)
def test_others_do_not(headers):
    assert Gate("127.0.0.1", 80).refusal(headers, "")


def test_elsewhere_the_token_opens():
    door = Gate("0.0.0.0", 80)
    assert len(door.token) >= 20
    assert door.refusal({"host": "robot.local:80"}, door.token) == ""
    for wrong in ("", door.token[:-1], "\udcff", "é" * 24):
        assert "token" in door.refusal({"host": "robot.local:80"}, wrong)
    assert door.refusal({"host": "robot.local:80", "origin": "http://evil"}, door.token)
    assert Gate("0.0.0.0", 80).token != door.token


@pytest.mark.parametrize(
    ("host", "expected"),
    [("127.0.0.1", True), ("::1", True), ("localhost", True), ("0.0.0.0", False), ("::", False),
     ("192.168.1.5", False), ("robot", False), ("", False)],
)  # fmt: skip
def test_loopback(host, expected):
    assert is_loopback(host) is expected


def test_an_allowance_runs_out_and_comes_back(monkeypatch):
    now = [10.0]
    monkeypatch.setattr(gate.time, "monotonic", lambda: now[0])
    allowance = Allowance()
    assert sum(allowance.take() for _ in range(1000)) == gate.BURST
    now[0] += 1.0
    assert sum(allowance.take() for _ in range(1000)) == gate.RATE
