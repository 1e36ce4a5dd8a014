"""OpenCASCADE beside us: evaluates the surfaces of files, and writes files with surfaces of its own.

    kernel.py points DIRECTORY    points of the first face of each file that parameters.json names, to points.json
    kernel.py parts DIRECTORY     what it makes of each STEP or IGES file of a part, to parts.json
    kernel.py write DIRECTORY     files of every kind of surface, and expected.json

`parameters.json` has a list of [u, v] for each file, `points.json` one of [x, y, z], in metres; `expected.json` both.
"""

import json
import math
import random
import sys
from pathlib import Path

from OCP.BRep import BRep_Tool
from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace
from OCP.BRepCheck import BRepCheck_Analyzer
from OCP.BRepGProp import BRepGProp
from OCP.Geom import Geom_BSplineSurface
from OCP.gp import gp_Pnt
from OCP.GProp import GProp_GProps
from OCP.IFSelect import IFSelect_RetDone
from OCP.IGESControl import IGESControl_Controller, IGESControl_Reader, IGESControl_Writer
from OCP.Interface import Interface_Static
from OCP.STEPControl import STEPControl_AsIs, STEPControl_Controller, STEPControl_Reader, STEPControl_Writer
from OCP.TopAbs import TopAbs_FACE, TopAbs_SOLID
from OCP.TopExp import TopExp_Explorer
from OCP.TopoDS import TopoDS

try:  # The containers were renamed in OCCT 8.
    from OCP.collections import Array1_double as Reals
    from OCP.collections import Array1_int as Integers
    from OCP.collections import Array2_double as Weights
    from OCP.collections import Array2_gp_Pnt as Points
except ImportError:
    from OCP.TColgp import TColgp_Array2OfPnt as Points
    from OCP.TColStd import TColStd_Array1OfInteger as Integers
    from OCP.TColStd import TColStd_Array1OfReal as Reals
    from OCP.TColStd import TColStd_Array2OfReal as Weights


def surface_of(path):
    """The surface of the first face, its coordinates in millimetres."""
    step = Path(path).suffix in (".step", ".stp")
    reader = STEPControl_Reader() if step else IGESControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise SystemExit(f"{path}: OpenCASCADE does not read it")
    reader.TransferRoots()
    faces = TopExp_Explorer(reader.OneShape(), TopAbs_FACE)
    if not faces.More():
        raise SystemExit(f"{path}: OpenCASCADE finds no face in it")
    face = getattr(TopoDS, "Face_s", None) or TopoDS.Face
    return BRep_Tool.Surface_s(face(faces.Current()))


def evaluate(surface, parameters, per_unit):
    out = []
    for u, v in parameters:
        p = surface.Value(u, v)
        out.append([p.X() * per_unit, p.Y() * per_unit, p.Z() * per_unit])
    return out


def part_of(path):
    """Whether it is valid, its faces and solids, and its volume (mm^3) and area (mm^2)."""
    reader = STEPControl_Reader() if path.suffix == ".step" else IGESControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone:
        raise SystemExit(f"{path}: OpenCASCADE does not read it")
    reader.TransferRoots()
    shape = reader.OneShape()

    def count(kind):
        explorer, found = TopExp_Explorer(shape, kind), 0
        while explorer.More():
            found += 1
            explorer.Next()
        return found

    volume, area = GProp_GProps(), GProp_GProps()
    # The quadrature without a tolerance is off by a hundredth on lofts.
    BRepGProp.VolumeProperties_s(shape, volume, 1e-9, False, False)
    BRepGProp.SurfaceProperties_s(shape, area, 1e-9, False)
    return {
        "valid": BRepCheck_Analyzer(shape).IsValid(),
        "faces": count(TopAbs_FACE),
        "solids": count(TopAbs_SOLID),
        "volume": volume.Mass(),
        "area": area.Mass(),
    }


def made(degrees, knots, multiplicities, rows, columns, periodic, rational, seed, closed=(False, False)):
    """A bumpy surface, about 100 mm across; closed directions run round a torus or a tube."""
    poles = Points(1, rows, 1, columns)
    weights = Weights(1, rows, 1, columns)
    for i in range(rows):
        for j in range(columns):
            # A clamped closed direction ends where it begins.
            a = i % (rows - 1) if closed[0] else i
            b = j % (columns - 1) if closed[1] else j
            local = random.Random(seed * 1000003 + a * 1009 + b)
            around = 2 * math.pi * a / (rows - 1 if closed[0] else rows)
            small = 2 * math.pi * b / (columns - 1 if closed[1] else columns)
            reach = 50 + (20 * math.cos(small) if periodic[1] or closed[1] else 0) + local.uniform(-3, 3)
            height = 20 * math.sin(small) if periodic[1] or closed[1] else 80 * j / columns
            if periodic[0] or closed[0]:
                point = gp_Pnt(reach * math.cos(around), reach * math.sin(around), height)
            else:
                point = gp_Pnt(100 * i / rows, 100 * j / columns, local.uniform(-8, 8))
            poles.SetValue(i + 1, j + 1, point)
            weights.SetValue(i + 1, j + 1, local.uniform(0.6, 1.6))

    def reals(values):
        array = Reals(1, len(values))
        for k, value in enumerate(values):
            array.SetValue(k + 1, value)
        return array

    def integers(values):
        array = Integers(1, len(values))
        for k, value in enumerate(values):
            array.SetValue(k + 1, value)
        return array

    shape = [reals(knots[0]), reals(knots[1]), integers(multiplicities[0]), integers(multiplicities[1])]
    if rational:
        return Geom_BSplineSurface(poles, weights, *shape, *degrees, *periodic)
    return Geom_BSplineSurface(poles, *shape, *degrees, *periodic)


def kinds():
    """Name, surface: plain, rational, periodic in one direction and in both, closed but clamped."""
    clamped = ([0.0, 0.3, 0.7, 1.0], [4, 1, 2, 4])  # 7 poles of degree 3
    quadratic = ([-1.0, 0.5, 2.0], [3, 1, 3])  # 4 poles of degree 2
    period = ([0.0, 0.2, 0.4, 0.6, 0.8, 1.0], [1, 1, 1, 1, 1, 1])  # 5 poles
    double = ([0.0, 1.0, 2.5, 3.0], [2, 1, 2, 2])  # 5 poles of degree 3
    few = ([0.0, 1.0, 2.0, 3.0], [1, 1, 1, 1])  # 3 poles of degree 3
    thirds = ([0.0, 1 / 3, 2 / 3, 1.0], [1, 1, 1, 1])  # 3 poles of degree 2

    def of(u, v, counts, degrees=(3, 3), periodic=(False, False), rational=False, closed=(False, False), seed=1):
        return made(degrees, (u[0], v[0]), (u[1], v[1]), *counts, periodic, rational, seed, closed)

    yield "plain", of(clamped, quadratic, (7, 4), (3, 2))
    yield "rational", of(clamped, quadratic, (7, 4), (3, 2), rational=True, seed=2)
    yield "periodic", of(period, clamped, (5, 7), periodic=(True, False), seed=3)
    yield "periodic_twice", of(period, double, (5, 5), periodic=(True, True), seed=4)
    yield "periodic_rational", of(double, clamped, (5, 7), periodic=(True, False), rational=True, seed=5)
    yield "periodic_few", of(few, clamped, (3, 7), periodic=(True, False), seed=6)
    yield "periodic_thirds", of(thirds, clamped, (3, 7), (2, 3), periodic=(True, False), seed=8)
    yield "clamped_closed", of(clamped, clamped, (7, 7), closed=(True, False), seed=7)


def write(directory):
    directory = Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    STEPControl_Controller.Init_s()
    IGESControl_Controller.Init_s()
    expected = {}
    for name, surface in kinds():
        face = BRepBuilderAPI_MakeFace(surface, 1e-7).Face()
        for unit in ("MM", "INCH", "M"):
            if unit != "MM" and name not in ("plain", "rational"):
                continue
            suffix = "" if unit == "MM" else f"_{unit.lower()}"
            Interface_Static.SetCVal_s("write.step.unit", unit)
            Interface_Static.SetIVal_s("write.step.schema", {"MM": 4, "INCH": 3, "M": 5}[unit])
            writer = STEPControl_Writer()
            writer.Transfer(face, STEPControl_AsIs)
            writer.Write(str(directory / f"{name}{suffix}.step"))
            # 5.3 has surfaces as entity 128 in faces (BRep mode) and bare.
            writer = IGESControl_Writer(unit, 1 if name == "rational" else 0)
            writer.AddShape(face)
            writer.ComputeModel()
            writer.Write(str(directory / f"{name}{suffix}.igs"))
            b = surface.Bounds()
            pick = random.Random(99)
            parameters = [[pick.uniform(b[0], b[1]), pick.uniform(b[2], b[3])] for _ in range(40)]
            expected[name + suffix] = {"parameters": parameters, "points": evaluate(surface, parameters, 1e-3)}
    (directory / "expected.json").write_text(json.dumps(expected))


def main():
    if sys.argv[1] == "points":
        directory = Path(sys.argv[2])
        parameters = json.loads((directory / "parameters.json").read_text())
        points = {name: evaluate(surface_of(directory / name), pairs, 1e-3) for name, pairs in parameters.items()}
        (directory / "points.json").write_text(json.dumps(points))
    elif sys.argv[1] == "parts":
        directory = Path(sys.argv[2])
        parts = {path.stem: part_of(path) for path in sorted(directory.glob("*.*")) if path.suffix in (".step", ".igs")}
        (directory / "parts.json").write_text(json.dumps(parts))
    else:
        write(sys.argv[2])


main()
