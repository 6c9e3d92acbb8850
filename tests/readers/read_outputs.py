"""Read a model's files with programs that are too heavy for the test environment: `make test-readers`.

    PYTHONPATH=tests:workflow/scripts python tests/readers/read_outputs.py [FOLDER]

Makes three small models, an environment in FOLDER (.readers) for each program, unless it is there with these
versions, and has each read what is made for it. Each holds what it reads against what the tables say, and tells its
version. Takes node with npm for graphology, for Boost g++ and apt-get of Debian 12, and for ParaView pvpython (its
packages paraview and python3-paraview); what is missing is said.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import networkx as nx
import pyarrow.parquet as pq

import certify
import export_model
import solids
import view
from corpus.storage import content_key
from pipeline import OPTIONS, run_stages
from reebslice.schemas import GRAPHS

HERE = Path(__file__).parent
PACKAGES = {
    "networkit": ("networkit==11.3",),
    "torch": ("torch==2.13.0", "torch_geometric==2.8.1", "networkx==3.6.1"),
    "vtk": ("pyvista==0.49.1", "vtk==9.7.2"),
    "duckdb": ("duckdb==2.0.1",),
    "swc": ("navis==1.12.0", "morphio==3.5.0"),
}
NODE = ("graphology@0.26.0", "graphology-graphml@0.5.2", "@xmldom/xmldom@0.9.12")
BOOST = "1.81.0-5+deb12u1"


def make_models(folder):
    """Write models with what is expected of them, `expected.json`, and return their folders."""
    shapes = {"plate": solids.plate(2, upright=True), "nested": solids.nested_shells(3), "torus": solids.torus()}
    for name, solid in shapes.items():
        place = folder / name
        place.mkdir()
        with content_key("key", model=name):
            run_stages(solid, place, levels={"distance": 0.1}, tilt={"mode": "auto"}, nodes={"sampler": "inscribed"})
            certify.main(place, place, OPTIONS["levels"] | {"distance": 0.1})
            export_model.main(place, place, {"method": "exact"})
            view.main(place, place, {"faces": 50000})
        (place / "expected.json").write_text(json.dumps(describe(place)))
    return [folder / name for name in shapes]


def describe(folder):
    """What the tables and networkx say of a model."""
    told = {"model": folder.name, "graphs": {}}
    for name in GRAPHS:
        graph = nx.read_graphml(folder / f"{name}.graphml", force_multigraph=True)
        place = {node: k for k, node in enumerate(graph)}
        told["graphs"][name] = {
            "ids": list(graph),
            "heights": [row["height"] for row in graph.nodes.values()],
            "branches": [row["branches"] for row in graph.nodes.values()],
            "labels": [row["label"] for row in graph.nodes.values()],
            "edges": sorted([*sorted((place[a], place[b])), key] for a, b, key in graph.edges(keys=True)),
        }
    tables = {
        name: pq.read_table(folder / f"{name}.parquet") for name in ("nodes", "contours", "faces", "shells", "arcs")
    }
    told["radius"] = max(tables["nodes"]["inscribed_radius"].to_pylist())
    told["points"] = len(told["graphs"]["augmented"]["ids"])
    told["trees"] = nx.number_connected_components(nx.read_graphml(folder / "augmented.graphml"))
    told["perimeter"] = sum(tables["contours"]["perimeter"].to_pylist())
    told["volume"] = sum(tables["shells"]["volume"].to_pylist())
    told["length"] = sum(row["length"] for row in tables["arcs"].to_pylist() if row["graph"] == "solid")
    told["n_faces"], told["n_contours"] = tables["faces"].num_rows, tables["contours"].num_rows
    return told


def make_python(place, packages):
    """Return the interpreter of an environment with these packages."""
    stamp = place / "packages.txt"
    if not stamp.exists() or stamp.read_text() != "\n".join(packages):
        shutil.rmtree(place, ignore_errors=True)
        subprocess.run([sys.executable, "-m", "venv", str(place)], check=True)
        subprocess.run([str(place / "bin" / "python"), "-m", "pip", "install", "--quiet", *packages], check=True)
        stamp.write_text("\n".join(packages))
    return str(place / "bin" / "python")


def make_node(place):
    """Install the packages of node, and return the command that reads."""
    place.mkdir(parents=True, exist_ok=True)
    shutil.copy(HERE / "read_graphology.mjs", place)
    if not (place / "node_modules" / "graphology-graphml").exists():
        (place / "package.json").write_text("{}")
        subprocess.run(["npm", "install", "--silent", "--no-audit", "--no-fund", *NODE], cwd=place, check=True)
    return ["node", str(place / "read_graphology.mjs")]


def make_boost(place):
    """Compile the reader by Boost, whose packages are unpacked and not installed."""
    place.mkdir(parents=True, exist_ok=True)
    if not (place / "root").exists():
        packages = [f"libboost1.81-dev={BOOST}", f"libboost-graph1.81-dev={BOOST}"]
        subprocess.run(["apt-get", "download", *packages], cwd=place, check=True, stderr=subprocess.DEVNULL)
        for package in place.glob("*.deb"):
            subprocess.run(["dpkg", "-x", str(package), str(place / "root")], check=True)
    (library,) = place.glob("root/usr/lib/*/libboost_graph.a")
    paths = ["-I", str(place / "root/usr/include"), str(HERE / "read_boost.cpp"), str(library)]
    subprocess.run(["g++", "-w", "-std=c++17", *paths, "-o", str(place / "read_boost")], check=True)
    return [str(place / "read_boost")]


def make_reader(name, place):
    """Make the reader of this name in a folder, and return the command that reads."""
    if name in PACKAGES:
        return [make_python(place, PACKAGES[name]), str(HERE / f"read_{name}.py")]
    if name == "paraview":
        return ["pvpython", str(HERE / "read_paraview.py")]
    return {"node": make_node, "boost": make_boost}[name](place)


def main(place=".readers"):
    """Have each program read; return how many did not."""
    place, failed = Path(place).absolute(), 0
    with TemporaryDirectory() as folder:
        models = make_models(Path(folder))
        for name in (*PACKAGES, "node", "boost", "paraview"):
            try:
                command = [*make_reader(name, place / name), *models]
                done = subprocess.run(command, capture_output=True, text=True, check=False)
            except (OSError, subprocess.CalledProcessError) as fault:
                failed += 1
                print(f"{name}: not there: {fault}")
                continue
            failed += done.returncode != 0
            print(f"{name}: {'read' if not done.returncode else done.stderr.strip()[-800:]} {done.stdout.strip()}")
    return failed


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
