"""What a search writes: tuned.toml to use, and report.html with what mattered."""

import html
import io as text_io
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from dynastar.bench.settings import merged
from dynastar.tune.sampler import importances
from dynastar.tune.space import Parameter, limit_fractions, settings_table
from dynastar.tune.state import State, Trial
from dynastar.tune.toml import rounded, toml_text
from dynastar.tune.verdict import Verdict
from dynastar.writing import written_aside

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TUNED, REPORT = "tuned.toml", "report.html"
STYLE = """
body { font: 15px/1.5 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; padding: 0 1rem }
table { border-collapse: collapse; font-size: 13px } th, td { padding: 2px 8px; text-align: right }
th { border-bottom: 1px solid } tr.best { font-weight: bold } td.words { text-align: left }
.scroll { overflow-x: auto } svg { max-width: 100%; height: auto }
"""


def tuned_toml(state: State, found: Verdict, declared: Mapping[str, Any] | None) -> str:
    """The settings to use: the best setting where it is better than the default, else the default.

    ``declared`` is the file of the robot that was tuned, if one was; then the text is such a file.
    """
    best = state.best if found.better else None
    chosen = best or state.trials[0]
    values = rounded(chosen.values)
    head = [
        f"The {'tuned' if best is not None else 'default'} settings, by dynastar tune.",
        f"Tuned: {found.words}.",
    ]
    if declared is None:
        head.append(
            "Copy the table into your robot's file or a scenario; what is not here stays as it is."
        )
        return toml_text({"navigator": settings_table(values)}, {}, head)
    head.append("A file for --robot: what is not tuned is as declared.")
    own = declared["robot"]["limits"]
    limits = rounded({name: own[name] * part for name, part in limit_fractions(values).items()})
    robot = {**declared["robot"], "limits": {**own, **limits}}
    navigator = merged(declared["navigator"], settings_table(values))
    return toml_text({**declared, "robot": robot, "navigator": navigator}, {}, head)


def report_html(state: State, space: Sequence[Parameter], found: Verdict) -> str:
    """A page, without need of a network: the verdict, what mattered, and every setting."""
    default = state.default
    weights = importances(space, state.finished, default)
    parts = [
        "<!doctype html><html lang=en><head><meta charset=utf-8><title>dynastar tune</title>",
        f"<style>{STYLE}</style></head><body><h1>dynastar tune</h1>",
        f"<p><strong>{html.escape(found.words)}.</strong></p><p>{_counts(state)}</p>",
        "<h2>What mattered</h2>",
    ]
    if weights:
        parts += [
            "<p>Importance by PED-ANOVA: how well each setting alone tells the best tenth from the "
            f"others, as a fraction, over {len(state.finished)} settings. With fewer than about 50 it "
            "is rough.</p>",
            _as_svg(draw_importances(weights, state, space)),
        ]
    else:
        parts.append("<p>Too few settings were tried to say.</p>")
    units = "In SI units; limits are fractions of the robot's own."
    parts += ["<h2>Settings</h2>", f"<p>{units}</p>", _table(state, space), "</body></html>"]
    return "\n".join(parts)


def write_results(
    folder: Path,
    state: State,
    space: Sequence[Parameter],
    found: Verdict,
    declared: Mapping[str, Any] | None,
) -> None:
    """Writes both files; ``declared`` is the file of the robot that was tuned, if one was."""
    texts: Mapping[str, str] = {
        TUNED: tuned_toml(state, found, declared),
        REPORT: report_html(state, space, found),
    }
    for name, text in texts.items():
        with written_aside(folder / name) as aside:
            aside.write_text(text, encoding="utf-8", errors="replace")


def _counts(state: State) -> str:
    driven = sum(len(trial.rows) for trial in state.trials)
    stopped = sum(bool(trial.stopped) for trial in state.finished)
    return (
        f"{len(state.finished)} settings, the default among them; {stopped} were stopped early. "
        f"{driven} missions in {len(state.default)} worlds, and "
        f"{2 * len(state.report_tuned)} for the final comparison, in "
        f"{state.spent_s / 3600:.2f} hours. The loss is relative to the default: 1000 for a failure, "
        "the ratio of the times, and 0.02 times the ratio of the smoothness."
    )


def draw_importances(
    weights: Mapping[str, float], state: State, space: Sequence[Parameter]
) -> "Figure":
    """Draws the importance of each setting, and the losses over the three that mattered most."""
    from dynastar.viewer import palette
    from dynastar.viewer.sheet import PAGE, plain, room, sheet

    figure = sheet(PAGE, 2.6)
    bars = room(figure, 1.5, 0.45, 1.5, 2.0)
    names = list(weights)[::-1]
    bars.barh(range(len(names)), [weights[name] for name in names], color=palette.INK)
    bars.set_yticks(range(len(names)), names)
    bars.set_xlabel("importance")
    plain(bars)
    logs = {parameter.name: parameter.log for parameter in space}
    for place, name in enumerate(list(weights)[:3]):
        axes = room(figure, 3.7 + 1.07 * place, 0.45, 0.95, 2.0)
        finished = state.finished
        axes.scatter(
            [trial.values[name] for trial in finished],
            [min(trial.mean(state.default), 1.5) for trial in finished],
            s=4,
            color=palette.INK,
        )
        if logs[name]:
            axes.set_xscale("log")
        axes.set_xlabel(name)
        if place == 0:
            axes.set_ylabel("loss, at most 1.5")
        plain(axes)
        axes.tick_params(labelleft=place == 0)
    return figure


def _as_svg(figure: "Figure") -> str:
    buffer = text_io.StringIO()
    figure.savefig(buffer, format="svg", metadata={"Date": None})
    _, tag, rest = buffer.getvalue().partition("<svg")
    return f"{tag}{rest}"


def _table(state: State, space: Sequence[Parameter]) -> str:
    names = [parameter.name for parameter in space]
    heads = ("setting", "worlds", "failures", "loss", *names, "end")
    order = sorted(state.finished, key=lambda one: (bool(one.stopped), one.mean(state.default)))
    rows = [_line(state.trials.index(trial), trial, state, names) for trial in order]
    head = "".join(f"<th>{html.escape(name)}</th>" for name in heads)
    return (
        f"<div class=scroll tabindex=0><table><tr>{head}</tr>\n"
        + "\n".join(rows)
        + "</table></div>"
    )


def _line(number: int, trial: Trial, state: State, names: Sequence[str]) -> str:
    cells = (
        "default" if number == 0 else str(number),
        str(len(trial.rows)),
        str(trial.failures(state.default)),
        f"{trial.mean(state.default):.3f}",
        *(f"{trial.values[name]:.3g}" for name in names),
    )
    best = " class=best" if trial is state.best else ""
    shown = "".join(f"<td>{html.escape(cell)}</td>" for cell in cells)
    return f"<tr{best}>{shown}<td class=words>{html.escape(trial.stopped)}</td></tr>"
