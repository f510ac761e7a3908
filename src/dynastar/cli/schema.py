"""``dynastar schema``: the JSON Schema of scenario files, for editors."""

import argparse

from dynastar import io
from dynastar.cli.outputs import check_file
from dynastar.cli.parsing import path

DESCRIPTION = (
    "Prints the JSON Schema of scenario files. Editors complete and check a TOML file by "
    "it where its first line is `#:schema scenario.schema.json`."
)

EXAMPLES = """\
examples:
  dynastar schema --out scenario.schema.json"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument("--out", type=path, metavar="FILE", help="into this file instead")


def execute(arguments: argparse.Namespace) -> int:
    """Prints the schema, or writes it to a file."""
    import json

    from dynastar.io.scenario_schema import scenario_schema

    file = check_file("--out", arguments.out)
    schema = scenario_schema()
    if file is None:
        print(json.dumps(schema, indent=2, ensure_ascii=False))
    else:
        io.write_json(file, schema)
    return 0
