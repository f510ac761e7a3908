"""Sphinx settings of the documentation: `make docs` builds it into out/docs without network."""

import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import reference_pages

import dynastar

project = "dynastar"
author = "the dynastar authors"
copyright = "the dynastar authors"
release = dynastar.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx-mathjax-offline"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build"]
myst_enable_extensions = ["dollarmath", "amsmath"]
myst_heading_anchors = 3
suppress_warnings = ["myst.header"]
autodoc_typehints = "signature"
autodoc_member_order = "bysource"
autodoc_class_signature = "mixed"

html_theme = "furo"
html_title = f"dynastar {release}"
html_static_path: list[str] = []


def setup(app):
    """Writes the reference pages from the definitions before anything is read."""
    reference_pages.write(Path(__file__).parent / "reference")
