"""Ask whether a package of requirements.lock is known to be vulnerable, and tell.

    python .ci/audit.py [LOCK]

The exit code says whether one is. Where the service that knows is not reached, that is told and is no failure: CI has
to give the same verdict without a network. What is not known there is told by name.
"""

import json
import subprocess
import sys


def judge(report):
    """Return what to print of pip-audit's report, parsed, and the exit code."""
    found = [one for one in report["dependencies"] if one.get("vulns")]
    skipped = [one["name"] for one in report["dependencies"] if "skip_reason" in one]
    lines = [
        f"{one['name']} {one['version']}: {vuln['id']} ({', '.join(vuln['aliases']) or 'no other name'}), mended in"
        f" {', '.join(vuln['fix_versions']) or 'no version'}: {vuln['description'][:300]}"
        for one in found
        for vuln in one["vulns"]
    ]
    asked = len(report["dependencies"]) - len(skipped)
    if not asked:
        return ["audit skipped: the service knows none of the packages, that is, it was not reached"], 0
    lines.append(f"audit: {asked} packages looked up, {len(found)} of them vulnerable")
    if skipped:
        lines.append(f"not known to the service: {', '.join(skipped)}")
    return lines, int(bool(found))


def main(lock="requirements.lock"):
    """Audit a lock; return the exit code."""
    options = ["--requirement", lock, "--require-hashes", "--disable-pip", "--format", "json", "--timeout", "10"]
    command = [sys.executable, "-m", "pip_audit", "--progress-spinner", "off", *options]
    done = subprocess.run(command, capture_output=True, text=True, check=False)  # noqa: S603, of words that stand here
    try:
        lines, code = judge(json.loads(done.stdout))
    except ValueError:  # no report: the service could not be asked
        reason = done.stderr.strip().splitlines()[-1:] or [f"exit code {done.returncode}"]
        lines, code = [f"audit skipped: {reason[0][:300]}"], 0
    print("\n".join(lines))
    return code


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
