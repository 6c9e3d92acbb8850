"""Run `snakemake --lint` and tell what it finds, but for what is excused here with a reason.

    python .ci/lint_workflow.py

The exit code says whether anything is left. Snakemake itself can excuse nothing.
"""

import re
import subprocess
import sys

EXCUSED = {
    # All rules run in the one environment that runs Snakemake (requirements.lock, environment.yml).
    "Specify a conda environment or container for each rule",
}


def main():
    """Print the lints that are not excused; return the exit code."""
    done = subprocess.run([sys.executable, "-m", "snakemake", "--lint"], capture_output=True, text=True, check=False)
    said = done.stdout + done.stderr
    found = [title for title in re.findall(r"^ +\* (.*?)\.?:$", said, re.MULTILINE) if title not in EXCUSED]
    looked = "Lints for" in said or "Congratulations" in said
    if found or not looked:
        print(said)
    return int(bool(found) or not looked)


if __name__ == "__main__":
    sys.exit(main())
