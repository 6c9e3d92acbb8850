"""Hold extended persistence against ReebGraphPairing's on random Reeb graphs.

    python benchmarks/check_pairing.py ReebGraphPairingMP.jar [GRAPHS]

The program is of https://github.com/USFDataVisualization/ReebGraphPairing, its archives are in the folder build; it
needs Java. The graphs are of random functions on surfaces of genus up to 40. Values are whole numbers, as the program
computes in single precision. Prints how many graphs, nodes and loops were compared, and the first that differ; the
exit code says whether any did.
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

sys.path[:0] = [str(Path(__file__).parents[1] / folder) for folder in ("workflow/scripts", "tests")]

import solids
from reebslice import surface_reeb_graph, value_mesh
from reebslice.morse.persistence import extended_pairs

AT_ONCE = 50  # files for one start of Java


def random_graph(seed):
    """Nodes' partners (K,) and arcs (A, 2) of a random function on a plate of up to forty holes, in order of values."""
    random = np.random.default_rng(seed)
    solid = solids.plate(int(random.integers(41)))
    graph = surface_reeb_graph(value_mesh(random.permutation(len(solid.points)), solid.points, solid.faces))
    return graph.partner, graph.arcs


def write_graph(path, count, arcs):
    """Write a graph as the program reads it; the value of a node is its place in the order."""
    lines = [f"v {node} {node}" for node in range(count)] + [f"e {low} {high}" for low, high in arcs.tolist()]
    path.write_text("\n".join(lines) + "\n")


def read_pairs(text):
    """Pairs of nodes by the name of the file, from what the program prints."""
    found, pairs = {}, None
    for line in text.splitlines():
        cells = [cell.strip() for cell in line.split(",")]
        if line.endswith(".txt"):
            pairs = found.setdefault(Path(line).name, set())
        elif len(cells) > 1 and cells[0].lstrip("-").replace(".", "").isdigit():
            pairs.add(tuple(sorted(int(float(cell)) for cell in cells[:2])))
    return found


def main(jar, number=1000):
    """Compare; return how many graphs differ."""
    compared, differ, nodes, loops = 0, [], 0, 0
    with tempfile.TemporaryDirectory() as folder:
        for first in range(0, number, AT_ONCE):
            expected = {}
            for seed in range(first, min(first + AT_ONCE, number)):
                partner, arcs = random_graph(seed)
                path = Path(folder, f"{seed}.txt")
                write_graph(path, len(partner), arcs)
                expected[path.name] = {(low, high) for low, high in enumerate(partner.tolist()) if low < high}
                nodes, loops = nodes + len(partner), loops + len(extended_pairs(len(partner), arcs).loops)
            command = [shutil.which("java"), "-jar", jar, *(str(Path(folder, name)) for name in expected)]
            found = read_pairs(subprocess.run(command, capture_output=True, text=True, check=True).stdout)  # noqa: S603, what is asked for
            differ += [name for name in expected if found.get(name) != expected[name]]
            compared += len(expected)
    print(f"{compared} graphs, {nodes} nodes, {loops} loops: {len(differ)} differ")
    print(*differ[:5])
    return len(differ)


if __name__ == "__main__":
    sys.exit(bool(main(sys.argv[1], *map(int, sys.argv[2:3]))))
