"""Take graphs into PyTorch Geometric: the arrays, and GraphML by way of networkx."""

import json
import sys
from pathlib import Path

import networkx as nx
import numpy as np
import torch
import torch_geometric
from torch_geometric.data import Data
from torch_geometric.utils import from_networkx, is_undirected

for folder in sys.argv[1:]:
    for name in ("solid", "surface"):
        told = json.loads(Path(folder, "expected.json").read_text())["graphs"][name]
        arrays = np.load(f"{folder}/{name}.npz")
        data = Data(**{key: torch.from_numpy(arrays[key]) for key in ("x", "pos", "edge_index", "edge_attr")})
        known = torch.nan_to_num(data.edge_attr)  # what is unknown equals nothing
        assert data.validate(raise_on_error=True) and is_undirected(data.edge_index, known)
        assert data.num_nodes == len(told["ids"]) and data.num_edges == 2 * len(told["edges"])
        half = data.edge_index[:, : data.num_edges // 2].T.tolist()
        assert sorted(sorted(edge) for edge in half) == [edge[:2] for edge in told["edges"]]
        names = arrays["x_names"].tolist()
        assert data.x[:, names.index("height")].tolist() == told["heights"]
        layer = torch_geometric.nn.GraphConv(data.x.shape[1], 4)
        assert torch.isfinite(layer(data.x.float(), data.edge_index)).all()
        read = from_networkx(nx.read_graphml(f"{folder}/{name}.graphml", force_multigraph=True))
        assert read.num_nodes == len(told["ids"]) and read.num_edges == 2 * len(told["edges"])
        assert torch.allclose(read.height.double(), torch.tensor(told["heights"], dtype=torch.float64), atol=1e-6)
print("torch", torch.__version__, "torch_geometric", torch_geometric.__version__)
