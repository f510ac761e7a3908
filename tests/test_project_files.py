"""Files for those who carry the project on agree with each other."""

import re
from pathlib import Path

import yaml

import dynastar

ROOT = Path(__file__).parents[1]


def test_the_citation_has_the_version():
    [cited] = re.findall(r"^version: (.*)$", (ROOT / "CITATION.cff").read_text("utf-8"), re.M)
    assert cited == dynastar.__version__


def test_the_workflow_runs_the_check_on_the_supported_pythons():
    workflow = yaml.safe_load((ROOT / ".github" / "workflows" / "check.yml").read_text("utf-8"))
    [job] = workflow["jobs"].values()
    supported = re.search(r"^PYTHONS := (.*)$", (ROOT / "Makefile").read_text("utf-8"), re.M)
    assert job["strategy"]["matrix"]["python"] == supported.group(1).split()
    assert job["steps"][-1]["run"] == ".ci/run"


def test_the_hooks_before_a_commit_are_those_of_make_check():
    hooks = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text("utf-8"))["repos"][0]
    recipe = (ROOT / "Makefile").read_text("utf-8").partition("\ncheck: setup\n")[2]
    tools = re.findall(r"^\t\$\(BIN\)/([\w-]+(?: \w+)?)", recipe.partition("\n\n")[0], re.M)
    assert len(tools) == len(hooks["hooks"]) == 4
    for tool, hook in zip(tools, hooks["hooks"], strict=True):
        assert hook["entry"].startswith(f".venv/bin/{tool}")
