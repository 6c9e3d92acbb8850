"""pyproject.toml, environment.yml and requirements.lock state the same dependencies."""

import ast
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import yaml
from packaging.requirements import Requirement

ROOT = Path(__file__).parent.parent
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
EXTRAS = {
    name: [line for line in lines if not line.startswith(PROJECT["name"])]
    for name, lines in PROJECT["optional-dependencies"].items()
}
OF_RUNS = PROJECT["dependencies"] + EXTRAS["formats"] + EXTRAS["workflow"]
# Conda has some packages under other names.
CONDA_NAMES = {"matplotlib-base": "matplotlib", "python-igraph": "igraph", "snakemake-minimal": "snakemake"}


def canonical(name):
    return re.sub(r"[-_.]+", "-", name).lower()


def stated(lines):
    """{name: specifier} of requirement lines."""
    requirements = [Requirement(line) for line in lines]
    return {canonical(requirement.name): str(requirement.specifier) for requirement in requirements}


def pins():
    lines = (ROOT / "requirements.lock").read_text().splitlines()
    return dict(line.split("==") for line in lines if line and not line.startswith("#"))


def imported(folder):
    """Top-level names that the Python files of a folder import."""
    names = set()
    for path in (ROOT / folder).glob("**/*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Import):
                names |= {alias.name.split(".")[0] for alias in node.names}
            elif isinstance(node, ast.ImportFrom) and not node.level:
                names.add(node.module.split(".")[0])
    return names


def test_conda_states_the_same():
    given = yaml.safe_load((ROOT / "environment.yml").read_text())["dependencies"]
    lines = [line for line in given if isinstance(line, str)] + next(g["pip"] for g in given if isinstance(g, dict))
    conda = {CONDA_NAMES.get(name, name): specifier for name, specifier in stated(lines).items()}
    assert conda.pop("python") == PROJECT["requires-python"]
    conda.pop("pip")
    assert conda == stated(OF_RUNS + EXTRAS["test"])


def test_lock_pins_what_is_asked_for():
    for line in OF_RUNS + EXTRAS["test"]:
        requirement = Requirement(line)
        assert requirement.specifier.contains(pins()[canonical(requirement.name)]), line


def test_lock_is_complete():
    """Whatever a locked package requires here is locked as well."""
    for name in pins():
        for line in metadata.distribution(name).requires or ():
            requirement = Requirement(line)
            if requirement.marker is None or requirement.marker.evaluate({"extra": ""}):
                assert canonical(requirement.name) in pins(), f"{name} requires {line}"


def test_everything_imported_is_stated():
    provider = metadata.packages_distributions()
    stated_for_runs = set(stated(OF_RUNS))
    for folder, allowed in (("workflow", stated_for_runs), ("tests", stated_for_runs | set(stated(EXTRAS["test"])))):
        own = {path.stem for path in ROOT.glob("workflow/scripts/*")} | {path.stem for path in ROOT.glob("tests/**/*")}
        for name in imported(folder) - own - set(sys.stdlib_module_names):
            found = {canonical(distribution) for distribution in provider.get(name, [name])}
            assert found & allowed, f"{folder} imports {name}, which pyproject.toml does not state"
