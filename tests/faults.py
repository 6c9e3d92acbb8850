"""Rounds of faults: a run of the workflow is disturbed, others follow until one is through, and results are compared.

    python tests/faults.py ROUNDS [SEED]

In every round some stages of a small corpus have to be computed again. While
they are, something happens: processes are killed, the disk is full, files are
edited, a mesh is replaced, a second run begins. Then runs follow as a user
would start them, by the hints that the runs give, and at the end every result
has to be that of a run which nothing disturbed, byte for byte but for what
tells seconds, memory and times. The exit code says whether all were.
"""

import shutil
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "workflow" / "scripts"))
sys.path.insert(0, str(Path(__file__).parent / "cluster"))

from disturbances import FAULTS, Round
from small_corpus import compare, fingerprint, make_corpus, settle


def play(base, expected, fault, seed, first=None):
    """Play one round, from some stage on or the `first` given.

    Return what was done, and the paths of results that are not as in the undisturbed run.
    """
    folder = Path(tempfile.mkdtemp(prefix="faults-"))
    shutil.copytree(base, folder, dirs_exist_ok=True)
    round = Round(folder, seed, first)
    round.undo()
    begun = time.time()
    try:
        fault(round)
        count, hints = settle(folder)
        differences = compare(expected, fingerprint(folder))
    except Exception as error:  # a round that breaks counts as one that differs
        count, hints, differences = 0, [], [f"{type(error).__name__}: {error}"]
    if not differences:
        shutil.rmtree(folder)
    settled = " ".join([f"{count} runs", *hints])
    return f"{fault.__name__} (seed {seed}):{round.note}; {settled}, {time.time() - begun:.1f} s in all", differences


def main(rounds, seed=0):
    """Play rounds, each fault in turn; return how many left other results than the undisturbed run."""
    with tempfile.TemporaryDirectory(prefix="faults-base-") as base:
        base = Path(base)
        make_corpus(base)
        expected, played, bad = fingerprint(base), Counter(), 0
        for number in range(rounds):
            fault = FAULTS[number % len(FAULTS)]
            told, differences = play(base, expected, fault, seed + number)
            played[fault.__name__] += 1
            bad += bool(differences)
            print(
                f"{number + 1}: {told}: {'DIFFERENT: ' + ', '.join(differences[:5]) if differences else 'the same'}",
                flush=True,
            )
    print(f"{rounds} rounds, {bad} with differences: {dict(played)}; {len(expected)} files compared in each")
    return bad


if __name__ == "__main__":
    sys.exit(bool(main(int(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) > 2 else 0)))
