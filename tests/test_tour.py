"""The notebook of examples runs from the top, and shows what it promises."""

import ast
import json
from pathlib import Path

import matplotlib
import pytest
from matplotlib import pyplot

NOTEBOOK = Path(__file__).parents[1] / "examples" / "tour.ipynb"


@pytest.fixture
def figures(monkeypatch):
    """Figures as a notebook has them: drawn without a window, closed at the end."""
    before = matplotlib.get_backend()
    pyplot.switch_backend("agg")
    yield pyplot.get_fignums
    pyplot.close("all")
    pyplot.switch_backend(before)


def shown_by(source, names):
    """Run a cell; what its last expression is, as a notebook would show it."""
    body = ast.parse(source).body
    last = body.pop() if body and isinstance(body[-1], ast.Expr) else None
    exec(compile(ast.Module(body, []), "cell", "exec"), names)
    return eval(compile(ast.Expression(last.value), "cell", "eval"), names) if last else None


@pytest.mark.slow
def test_the_tour_runs_from_the_top(figures, capsys, tmp_path, monkeypatch):
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    names, pages = {"__name__": "__main__"}, 0
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            shown = shown_by("".join(cell["source"]), names)
            pages += hasattr(shown, "_repr_html_") and "<iframe" in shown._repr_html_()
    assert len(figures()) == 5
    assert pages == 1
    assert names["navigator"].status.state == "arrived"
    said = capsys.readouterr().out
    for words in ("by improved", "outcome           arrived", "s: arrived"):
        assert words in said


def test_the_tour_is_kept_without_outputs():
    notebook = json.loads(NOTEBOOK.read_text(encoding="utf-8"))
    assert all(not cell.get("outputs") for cell in notebook["cells"])
    assert len({cell["id"] for cell in notebook["cells"]}) == len(notebook["cells"])
