"""Messages: what may be asked for, and that nothing else gets through."""

import contextlib
import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.errors import InputError
from dynastar.play import messages as ask

anything = st.recursive(
    st.none() | st.booleans() | st.floats() | st.integers() | st.text(max_size=8),
    lambda inner: st.lists(inner, max_size=4) | st.dictionaries(st.text(max_size=6), inner, max_size=4),
    max_leaves=12,
)  # fmt: skip


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('{"type": "goals", "goals": [[1, 2, null], [3, 4, 0.5]]}', ((1.0, 2.0, None), (3.0, 4.0, 0.5))),
        ('{"type": "goals", "goals": []}', ()),
    ],
)  # fmt: skip
def test_goals(text, expected):
    assert ask.read_message(text).goals == expected


def test_each_kind_is_read():
    for text in (
        '{"type": "stroke", "points": [[1, 2]], "erase": true}',
        '{"type": "walker", "x": 1, "y": 2, "vx": 0.5, "vy": -0.5}',
        '{"type": "push", "mover": 0, "vx": 0.5, "vy": 0}',
        '{"type": "set", "name": "dwa.horizon", "value": 2}',
        '{"type": "preset", "preset": "paper"}',
        '{"type": "pause", "paused": true}',
        '{"type": "step"}',
        '{"type": "reset"}',
        '{"type": "scene", "scene": "crowd"}',
    ):
        assert type(ask.read_message(text)) is ask.KINDS[json.loads(text)["type"]]


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "not JSON"),
        ("[" * 100000, "not JSON"),
        ("1" * 10000, "not JSON|expected an object"),
        ("{}", "expected an object with a type"),
        ('{"type": 3}', "expected an object with a type"),
        ('{"type": "goal", "goals": []}', "did you mean 'goals'"),
        ('{"type": "goals"}', "missing key 'goals.goals'"),
        ('{"type": "goals", "goals": [[1, NaN, null]]}', "expected a number|legal is"),
        ('{"type": "goals", "goals": [[1, 1e400, null]]}', "legal is"),
        ('{"type": "goals", "goals": [[1, 2]]}', "has 2 values: expected 3"),
        ('{"type": "goals", "goals": [' + "[1, 2, 3]," * 30 + "[1, 2, 3]]}", "at most 20"),
        ('{"type": "stroke", "points": []}', "1 to 200"),
        ('{"type": "stroke", "points": [[1, 2]], "radius": 100}', "legal is"),
        ('{"type": "walker", "x": 1, "y": 2, "vx": 50, "vy": 0}', "legal is"),
        ('{"type": "push", "mover": -1, "vx": 0, "vy": 0}', "legal is"),
        ('{"type": "pause", "paused": 1}', "expected true or false"),
        ('{"type": "step", "much": 1}', "unknown key"),
    ],
)
def test_what_is_wrong_is_said(text, says):
    with pytest.raises(InputError, match=says):
        ask.read_message(text)


@given(
    st.sampled_from(sorted(ask.KINDS)), st.dictionaries(st.text(max_size=8), anything, max_size=4)
)
def test_anything_else_is_an_input_error(kind, fields):
    with contextlib.suppress(InputError):
        ask.read_message(json.dumps({**fields, "type": kind}))
