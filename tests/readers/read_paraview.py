"""Read poly data with ParaView itself, by its interpreter pvpython, and integrate over it with its own filter."""

import json
import math
import sys
from pathlib import Path

from paraview import servermanager, simple
from vtkmodules.vtkFiltersCore import vtkMassProperties


def integrate(reader, name):
    """The length or area of all cells, as ParaView integrates it."""
    summed = servermanager.Fetch(simple.IntegrateVariables(Input=reader))
    return summed.GetCellData().GetArray(name).GetValue(0)


def list_parts(reader):
    """The data sets of a scene."""
    parts, at = [], servermanager.Fetch(reader).NewIterator()
    at.InitTraversal()
    while not at.IsDoneWithTraversal():
        parts.append(at.GetCurrentDataObject())
        at.GoToNextItem()
    return parts


for folder in sys.argv[1:]:
    told = json.loads(Path(folder, "expected.json").read_text())
    solid, contours, surface = (
        simple.OpenDataFile(f"{folder}/{name}.vtp") for name in ("solid", "contours", "surface")
    )
    for reader in (solid, contours, surface):
        fields = servermanager.Fetch(reader).GetFieldData()
        words = {name: fields.GetAbstractArray(name).GetValue(0) for name in ("model", "verdict")}
        assert words == {"model": told["model"], "verdict": "exact"}
    read = servermanager.Fetch(solid)
    assert read.GetNumberOfLines() == len(told["graphs"]["solid"]["edges"])
    assert math.isclose(integrate(solid, "Length"), told["length"], rel_tol=1e-6)
    radius = solid.PointData["MaximumInscribedSphereRadius"]
    assert math.isclose(radius.GetRange()[1], told["radius"])
    tube = simple.Tube(Input=solid, Scalars=["POINTS", "MaximumInscribedSphereRadius"])
    tube.VaryRadius = "By Absolute Scalar"
    assert servermanager.Fetch(tube).GetNumberOfCells() > read.GetNumberOfLines()
    assert servermanager.Fetch(contours).GetNumberOfLines() == told["n_contours"]
    assert math.isclose(integrate(contours, "Length"), told["perimeter"], rel_tol=1e-6)
    shell = servermanager.Fetch(surface)
    assert shell.GetNumberOfPolys() == told["n_faces"]
    assert {"surface_arc", "solid_arc"} <= set(surface.CellData.keys())
    mass = vtkMassProperties()
    mass.SetInputData(shell)
    assert math.isclose(mass.GetVolume(), abs(told["volume"]), rel_tol=1e-6)
    parts = list_parts(simple.OpenDataFile(f"{folder}/model.glb"))
    arcs, contours = ([part for part in parts if part.GetPointData().HasArray(name)] for name in ("_ARC", "_CONTOUR"))
    assert sum(part.GetNumberOfPolys() for part in arcs) == told["n_faces"]
    assert sum(part.GetNumberOfLines() for part in contours) > told["n_contours"]
print("ParaView", simple.GetParaViewVersion(), "by pvpython")
