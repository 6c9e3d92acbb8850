"""pyproject.toml, environment.yml and requirements.lock state the same dependencies."""

import ast
import importlib.util
import re
import sys
import tomllib
from importlib import metadata
from pathlib import Path

import pytest
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


def locked():
    """Requirement lines of the lock, each with its hashes."""
    text = (ROOT / "requirements.lock").read_text().replace("\\\n", " ")
    lines = [line.split("--hash=") for line in text.splitlines() if line and not line.startswith("#")]
    return {Requirement(first): [word.strip() for word in hashes] for first, *hashes in lines}


def pins():
    """{name: version} of what the lock has for this system."""
    here = [one for one in locked() if one.marker is None or one.marker.evaluate()]
    return {canonical(one.name): str(one.specifier).removeprefix("==") for one in here}


def imported(folder):
    """Top-level names that the Python files of a folder import, but for those that run in environments of their own."""
    names = set()
    for path in set((ROOT / folder).glob("**/*.py")) - set(ROOT.glob("tests/readers/read_*.py")):
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
    assert conda == stated(OF_RUNS + EXTRAS["docs"] + EXTRAS["test"])


def test_lock_pins_what_is_asked_for():
    for line in OF_RUNS + EXTRAS["docs"] + EXTRAS["test"]:
        requirement = Requirement(line)
        assert requirement.specifier.contains(pins()[canonical(requirement.name)]), line


def test_every_locked_package_has_the_hashes_of_its_files_and_is_installed_by_them():
    for one, hashes in locked().items():
        assert str(one.specifier).startswith("==") and hashes, one
        assert all(re.fullmatch(r"sha256:[0-9a-f]{64}", word) for word in hashes), one
    assert "--require-hashes -r requirements.lock" in (ROOT / "Makefile").read_text()


def test_lock_is_for_other_systems_too():
    windows = {"sys_platform": "win32", "platform_system": "Windows", "os_name": "nt", "platform_machine": "AMD64"}
    there = {canonical(one.name) for one in locked() if one.marker is None or one.marker.evaluate(windows)}
    assert there > {"colorama", "numba", "snakemake"} and "colorama" not in pins()


AUDITED = {"name": "a", "version": "1", "vulns": []}
KNOWN = {"id": "X-1", "aliases": ["C-2"], "fix_versions": ["2"], "description": "reads too much"}


@pytest.mark.parametrize(
    "dependencies, code, told",
    [
        ([AUDITED], 0, "1 packages looked up, 0 of them vulnerable"),
        ([AUDITED, AUDITED | {"vulns": [KNOWN]}], 1, "a 1: X-1 (C-2), mended in 2: reads too much"),
        ([AUDITED, {"name": "b", "skip_reason": "not found"}], 0, "not known to the service: b"),
        ([{"name": "b", "skip_reason": "not found"}], 0, "audit skipped"),
    ],
)
def test_an_audit_fails_on_what_is_known_and_tells_what_was_not_looked_up(dependencies, code, told):
    spec = importlib.util.spec_from_file_location("audit", ROOT / ".ci" / "audit.py")
    audit = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(audit)
    lines, found = audit.judge({"dependencies": dependencies})
    assert found == code and any(told in line for line in lines)


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
