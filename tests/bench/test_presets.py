"""The table of what the presets differ in."""

from dynastar.bench import presets
from dynastar.bench.tables import as_markdown, as_text
from dynastar.navigator import PRESETS, configured


def test_the_table_has_every_setting_that_differs_and_no_other():
    assert set(presets.ORDER) == set(PRESETS)
    table = presets.table()
    shown = {row[0].strip("`"): row[1:3] for row in table.rows}
    by_preset = {
        preset: {name: value for name, _, value in presets.settings_of(PRESETS[preset])}
        for preset in presets.ORDER
    }
    names = set(by_preset["default"])
    differing = {n for n in names if len({repr(by_preset[p][n]) for p in presets.ORDER}) > 1}
    assert set(shown) == differing
    assert shown["reverse"] == ("no", "yes")


def test_the_settings_it_lists_make_one_preset_of_another():
    """With what the table says of it over the default, the default is the preset paper."""
    overrides = {}
    for name, _, value in presets.settings_of(PRESETS["paper"]):
        *path, last = name.split(".")
        table = overrides
        for part in path:
            table = table.setdefault(part, {})
        table[last] = value
    assert configured("default", overrides) == PRESETS["paper"]


def test_words_stand_at_the_left():
    lines = as_text(presets.table()).splitlines()
    column = lines[2].index("what it is")
    assert all(line[column] != " " for line in lines[4:])
    assert as_markdown(presets.table()).splitlines()[3].endswith("| :-- |")
