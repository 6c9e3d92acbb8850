"""Read poly data with VTK, whose reader is that of ParaView, by way of pyvista."""

import json
import sys
from pathlib import Path

import numpy as np
import pyvista
import vtk

for folder in sys.argv[1:]:
    told = json.loads(Path(folder, "expected.json").read_text())
    solid, contours, surface = (pyvista.read(f"{folder}/{name}.vtp") for name in ("solid", "contours", "surface"))
    for data in (solid, contours, surface):
        assert data.field_data["model"].tolist() == [told["model"]]
        assert data.field_data["verdict"].tolist() == ["exact"]
    assert solid.n_lines == len(told["graphs"]["solid"]["edges"])
    assert np.isclose(solid.compute_cell_sizes()["Length"].sum(), told["length"])
    assert solid["MaximumInscribedSphereRadius"].max() == told["radius"]
    assert contours.n_lines == told["n_contours"]
    assert np.isclose(contours.compute_cell_sizes()["Length"].sum(), told["perimeter"])
    assert surface.n_cells == told["n_faces"] and surface.is_manifold
    assert np.isclose(surface.volume, abs(told["volume"]))
    assert len(surface.cell_data["surface_arc"]) == len(surface.cell_data["solid_arc"]) == told["n_faces"]
print("pyvista", pyvista.__version__, "vtk", vtk.vtkVersion().GetVTKVersion())
