"""Print requirements.lock: what is installed of pyproject.toml's dependencies, extras included, and of theirs."""

import re
import tomllib
from importlib import metadata
from pathlib import Path

from packaging.requirements import Requirement


def pin_closure(requirements):
    """Return {name: version} of the requirements, and of all that they require here."""
    pins, waiting = {}, [(Requirement(text), ("",)) for text in requirements]
    seen = set()
    while waiting:
        requirement, extras = waiting.pop()
        if requirement.marker and not any(requirement.marker.evaluate({"extra": extra}) for extra in extras):
            continue
        wanted = ("", *sorted(requirement.extras))
        name = re.sub(r"[-_.]+", "-", requirement.name).lower()
        if (name, wanted) in seen:
            continue
        seen.add((name, wanted))
        distribution = metadata.distribution(name)
        pins[name] = distribution.version
        waiting += [(Requirement(text), wanted) for text in distribution.requires or ()]
    return dict(sorted(pins.items()))


if __name__ == "__main__":
    project = tomllib.loads((Path(__file__).parent.parent / "pyproject.toml").read_text())["project"]
    print("# Every package of the environment that `make` creates, pinned. Made by `make lock`; do not edit.")
    extras = project["optional-dependencies"].values()
    stated = [line for lines in (project["dependencies"], *extras) for line in lines]
    for name, version in pin_closure([line for line in stated if not line.startswith(project["name"])]).items():
        print(f"{name}=={version}")
