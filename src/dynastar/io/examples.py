"""The examples that come with dynastar: beside the package as installed, or in the clone."""

from pathlib import Path


def examples_folder() -> Path:
    """The folder of examples."""
    package = Path(__file__).parents[1]
    shipped, clone = package / "examples", package.parents[1] / "examples"
    return shipped if shipped.is_dir() else clone


def example_scenarios() -> dict[str, Path]:
    """The examples' scenario files by name."""
    return {file.stem: file for file in sorted(examples_folder().rglob("*.toml"))}
