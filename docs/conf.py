"""Sphinx settings of the documentation: `make docs` builds it into out/docs without network."""

import dataclasses
import re
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

import reference_pages
from docutils import nodes
from sphinx import addnodes

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
autodoc_preserve_defaults = True
autodoc_class_signature = "mixed"
python_maximum_signature_line_length = 100

html_theme = "furo"
html_title = f"dynastar {release}"
html_static_path: list[str] = []


SHORTER = (  # of what a signature shows, and how it is written in code
    (
        r"~?numpy\.ndarray\[tuple\[[^\]]*\], ~?numpy\.dtype\[([^\]]*)\]\]",
        r"~numpy.typing.NDArray[\1]",
    ),
    (
        r"~?[\w.]*_Buffer \| .*?_NestedSequence\[complex \| bytes \| str\]",
        "~numpy.typing.ArrayLike",
    ),
    (r"= <factory>", "= ..."),
)


def shorten_signature(app, what, name, object_, options, signature, annotation):
    """Shows arrays and defaults of a signature as they are written in code."""
    texts = [signature or "", annotation or ""]
    for long, short in SHORTER:
        texts = [re.sub(long, short, text) for text in texts]
    for field in dataclasses.fields(object_) if dataclasses.is_dataclass(object_) else ():
        if hasattr(field.default, "_fields"):
            texts[0] = texts[0].replace(tuple.__repr__(field.default), repr(field.default))
    return texts[0] or None, texts[1] or None


def shorten_properties(app, doctree):
    """Shows the arrays that properties return as they are written in code."""
    for node in doctree.findall(addnodes.desc_annotation):
        text = re.sub(
            r"ndarray\[tuple\[[^\]]*\], dtype\[([^\]]*)\]\]", r"NDArray[\1]", node.astext()
        )
        if text != node.astext():
            node.children = [nodes.Text(text)]


def setup(app):
    """Writes the reference pages from the definitions before anything is read."""
    app.connect("autodoc-process-signature", shorten_signature)
    app.connect("doctree-read", shorten_properties)
    reference_pages.write(Path(__file__).parent / "reference")
