"""Distances of points to a STEP part by OpenCASCADE (BRepExtrema_DistShapeShape), from JSON on standard input:
{"step": text, "points": [[x, y, z] in mm]}; prints {"seconds": [...], "distances": [mm]}."""

import json
import sys
import tempfile
import time

from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeVertex
from OCP.BRepExtrema import BRepExtrema_DistShapeShape
from OCP.gp import gp_Pnt
from OCP.STEPControl import STEPControl_Reader
from OCP.TopAbs import TopAbs_ShapeEnum
from OCP.TopExp import TopExp_Explorer
from OCP.BRep import BRep_Builder
from OCP.TopoDS import TopoDS_Compound

given = json.load(sys.stdin)
with tempfile.NamedTemporaryFile("w", suffix=".step") as file:
    file.write(given["step"])
    file.flush()
    reader = STEPControl_Reader()
    reader.ReadFile(file.name)
    reader.TransferRoots()
    shape = reader.OneShape()
# The skin: a point inside a solid is at distance 0 of it.
skin, builder = TopoDS_Compound(), BRep_Builder()
builder.MakeCompound(skin)
faces = TopExp_Explorer(shape, TopAbs_ShapeEnum.TopAbs_FACE)
while faces.More():
    builder.Add(skin, faces.Current())
    faces.Next()
seconds, distances = [], []
began = time.perf_counter()
for point in given["points"]:
    vertex = BRepBuilderAPI_MakeVertex(gp_Pnt(*point)).Vertex()
    start = time.perf_counter()
    found = BRepExtrema_DistShapeShape(vertex, skin)
    seconds.append(time.perf_counter() - start)
    distances.append(found.Value())
    if time.perf_counter() - began > 5.0:
        break
print(json.dumps({"seconds": seconds, "distances": distances}))
