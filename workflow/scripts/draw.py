"""Draw every model's still picture: its solid Reeb graph in the body, and flat by height.

After figure 6 of Pareja-Corcho et al. (see reebslice.pictures). The bytes of
the picture depend on the results alone: no dates, no program versions.
"""

import networkx as nx
import numpy as np
import shapely

from batches import run_batch
from reebslice.pictures import draw_model
from storage import read_json, read_table

OUTPUTS = ("picture.png",)
CURVES = 14  # levels whose contours are drawn faintly


def main(source, target, options):
    """Write `picture.png` of the model in the folder `source` into `target`."""
    rotation = np.array(read_json(source / "tilt.json")["rotation"], float)
    certificate = read_json(source / "certificate.json")
    vertices, faces = read_table(source / "vertices.parquet", "vertices"), read_table(source / "faces.parquet", "faces")
    levels = read_table(source / "levels.parquet", "levels")
    graph = nx.MultiGraph(nx.read_graphml(source / "solid.graphml", force_multigraph=True))
    figure = draw_model(
        name=source.name,
        facts=list_facts(certificate, faces.num_rows, levels.num_rows),
        verdict=certificate["verdict"],
        points=tilt_points(stack_columns(vertices, "xyz"), rotation),
        faces=stack_columns(faces, "abc"),
        rotation=rotation,
        graph=graph,
        paths=trace_solid_arcs(
            read_table(source / "arcs.parquet", "arcs"), read_table(source / "nodes.parquet", "nodes")
        ),
        curves=pick_curves(levels, read_table(source / "contours.parquet", "contours")),
        options=options,
    )
    figure.savefig(target / "picture.png", format="png", metadata={"Software": None})


def list_facts(certificate, n_faces, n_levels):
    """The statements below the title: faces, genus, loops, voids, levels, and what is not shown."""
    counts = [
        (n_faces, "face", "faces"),
        (n_levels, "level", "levels"),
        (certificate.get("loops_solid"), "loop", "loops"),
        (certificate.get("voids") or None, "void", "voids"),
        (certificate.get("hidden_genus") or None, "hidden loop", "hidden loops"),
        (certificate.get("suppressed_loops") or None, "suppressed loop", "suppressed loops"),
    ]
    facts = [f"{count:,} {one if count == 1 else many}" for count, one, many in counts if isinstance(count, int)]
    genus = certificate.get("genus")
    return facts[:1] + ([f"genus {genus}"] if genus is not None else []) + facts[1:]


def tilt_points(points, rotation):
    """Points (n, 3) in the tilted frame."""
    return points @ rotation.T


def stack_columns(table, names):
    """The columns `names` of a table as one array (rows, columns)."""
    return np.column_stack([table[name].to_numpy() for name in names])


def trace_solid_arcs(arcs, nodes):
    """For every arc of the solid graph its material points (k, 3), upward, in the model frame."""
    place = dict(zip(nodes["node"].to_pylist(), stack_columns(nodes, "xyz"), strict=True))
    rows = zip(arcs["graph"].to_pylist(), arcs["arc"].to_pylist(), arcs["nodes"].to_pylist(), strict=True)
    return {arc: np.array([place[node] for node in chain]) for graph, arc, chain in rows if graph == "solid"}


def pick_curves(levels, contours):
    """The contours (k, 3), tilted frame, of some levels spread evenly over the heights."""
    heights = levels["height"].to_numpy()
    if len(heights) == 0:
        return []
    wanted = np.linspace(heights.min(), heights.max(), CURVES + 2)[1:-1]
    chosen = levels["level"].to_numpy()[np.unique(np.abs(heights[:, None] - wanted).argmin(axis=0))]
    rows = np.isin(contours["level"].to_numpy(), chosen)
    lines = shapely.from_wkb(np.array(contours["geometry"].filter(rows).to_pylist(), dtype=object))
    tops = contours["height"].to_numpy()[rows]
    flat = [shapely.get_coordinates(line) for line in lines]
    return [np.column_stack([line, np.full(len(line), top)]) for line, top in zip(flat, tops, strict=True)]


if "snakemake" in globals():
    run_batch(snakemake, main, OUTPUTS)  # noqa: F821
