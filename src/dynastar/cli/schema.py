"""``dynastar schema``: the JSON Schema of scenario files, for editors."""

import argparse
import json

from dynastar.cli.outputs import check_file
from dynastar.io import write_json
from dynastar.io.scenario_schema import scenario_schema


def execute(arguments: argparse.Namespace) -> int:
    """Prints the schema, or writes it to a file."""
    file = check_file("--out", arguments.out)
    schema = scenario_schema()
    if file is None:
        print(json.dumps(schema, indent=2, ensure_ascii=False))
    else:
        write_json(file, schema)
    return 0
