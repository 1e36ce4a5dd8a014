"""Surfaces from surfaces, curves, trees and points; arguments broadcast, results with names."""

import json
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, Optional, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import Part, Surface
from .errors import SurfaceError

Floats = NDArray[np.float64]
PathLike = Union[str, "os.PathLike[str]"]


class Derivatives(NamedTuple):
    """Points and derivatives of a surface, each (…, 3); m per unit of parameter. None: not asked for."""

    point: Floats
    du: Floats
    dv: Floats
    duu: Optional[Floats] = None
    duv: Optional[Floats] = None
    dvv: Optional[Floats] = None


class Mesh(NamedTuple):
    """Triangles."""

    points: Floats
    """(n, 3) m."""
    normals: Floats
    """(n, 3) outward unit normals; corners of a crease are doubled."""
    triangles: NDArray[np.uint32]
    """(m, 3) indices, counter-clockwise seen from outside."""


@dataclass(frozen=True)
class Merged:
    """Patches that became one surface."""

    surface: Surface
    deviation: "dict[str, float]"
    """Distances of the patches' points from it: average_m, median_m, maximum_m…"""
    seams: "list[dict[str, Any]]"
    """Where patches meet, with the continuity measured there."""
    before: "dict[str, float]"
    """The patches where they met before."""
    within_tolerance: Optional[bool]
    """Whether the tolerance was reached, when there was one."""
    hidden: Optional[str] = None
    """Where patches cross: ``rows`` or ``lines``, whichever was taken."""
    readings: "list[dict[str, Any]]" = field(default_factory=list)
    """What was tried there: ``hidden``, ``deviation`` of all visible points and ``lost_share``, or why it was ``refused``."""


@dataclass(frozen=True)
class Isolation:
    """Bodies moved apart."""

    translations: Floats
    """(bodies, 3) what to move each body by, m."""
    surfaces: "list[Surface]"
    """The bodies, moved."""
    report: "dict[str, Any]"
    """What was moved, in order, with gap and method."""

    @property
    def translation(self) -> Floats:
        """Of the first body, (3,) m."""
        first: Floats = self.translations[0]
        return first


@dataclass(frozen=True)
class Pipe:
    """A pipe around a curve."""

    surface: Optional[Surface]
    """The pipe of the radius asked for; None where no radius was given."""
    r_max: Optional[float]
    """Largest radius without self-intersection, m; None where nothing limits it."""
    limit: Optional[str]
    """What limits it."""
    free: Optional[bool]
    """Whether the pipe of the radius asked for is free of self-intersection; None: unknown, or no radius."""
    report: "dict[str, Any]"
    """All bounds, m."""


@dataclass(frozen=True)
class Branch:
    """One surface for a tree of tubes."""

    surface: Surface
    patches: "list[dict[str, Any]]"
    """Table of patches: node, part, ranges of u and v, what each is equal to."""
    ties: "list[list[int]]"
    """Control points that move together."""


@dataclass(frozen=True)
class Fit:
    """A surface near points."""

    surface: Surface
    rms_error: float
    """Root of the mean square distance of the points, m."""
    max_error: float
    """Largest distance, m."""


def _pair(u: ArrayLike, v: ArrayLike) -> "tuple[Any, Any]":
    try:
        first, second = np.broadcast_arrays(u, v)
        return first, second
    except ValueError as error:
        raise ValueError(f"u has the shape {np.shape(u)} and v {np.shape(v)}; they do not broadcast") from error


def _evaluate(surface: Surface, u: ArrayLike, v: ArrayLike, derivatives: int) -> "Union[Floats, Derivatives]":
    arrays = surface._evaluate(*_pair(u, v), derivatives)
    return arrays[0] if derivatives == 0 else Derivatives(*arrays)


def _normal(surface: Surface, u: ArrayLike, v: ArrayLike) -> Floats:
    return surface._normal(*_pair(u, v))


def _curvature(surface: Surface, u: ArrayLike, v: ArrayLike) -> Floats:
    return surface._curvature(*_pair(u, v))


def _tessellate(surface: Surface, tolerance: Optional[float], cells: Optional[int]) -> Mesh:
    return Mesh(*surface._tessellate(tolerance, cells))


def _part_mesh(part: Part, tolerance: Optional[float]) -> Mesh:
    return Mesh(*part._tessellate(tolerance))


def merge(
    surfaces: Sequence[Surface],
    *,
    continuity: int = 2,
    method: str = "constrained",
    degree: str = "raise",
    grid: "Optional[tuple[int, int]]" = None,
    edges: "Optional[tuple[str, str]]" = None,
    hide: "Sequence[tuple[int, str, tuple[float, float]]]" = (),
    find_overlap: bool = True,
    tolerance: Optional[float] = None,
    hidden: Optional[str] = None,
) -> Merged:
    """Joins patches into one surface.

    Parameters
    ----------
    surfaces
        Two patches, joined at their closest edges; more in a row, or in a ``grid`` of rows and columns.
    continuity
        c of the C^c at the seams.
    method
        ``constrained``, ``seed`` or ``exact``.
    edges
        Of two patches: which edges meet, among u0, u1, v0, v1.
    hide
        Parts to leave out: number of the patch, direction, range.
    tolerance
        Knots are inserted until no point is farther off, m.
    hidden
        Where two patches cross: ``rows`` of points with a hidden one are dropped, or ``lines`` across the seam end on the
        curve; by default the one that deviates less.

    Raises
    ------
    SurfaceError
        Patches that cannot be joined, with what would help.
    """
    options = {
        "continuity": continuity,
        "method": method,
        "degree": degree,
        "grid": grid,
        "edges": edges,
        "hide": list(hide),
        "find_overlap": find_overlap,
        "tolerance": tolerance,
        "hidden": hidden,
    }
    surface, report = _native.merge(list(surfaces), options)
    return Merged(surface, **json.loads(report))


def isolate(
    *surfaces: Surface,
    method: str = "global",
    gap: Optional[float] = None,
    max_turn: Optional[float] = None,
    fall_back: bool = True,
) -> Isolation:
    """Moves overlapping closed bodies apart by short translations.

    Of two bodies the first moves. Of more, of two that overlap the one given first stays.

    Parameters
    ----------
    method
        ``global`` (shortest of several), ``local``, ``thorough``, or 1 to 7 of the guide.
    gap
        Gap to leave, m; by default a thousandth of the diagonal of the box around both.
    max_turn
        Largest turn of the vector between the centres of mass, degrees.
    fall_back
        Where the method has no answer, ask ``global``.

    Raises
    ------
    SurfaceError
        An open body, or no answer, with the reason.
    """
    translations, report = _native.isolate(list(surfaces), str(method), gap, max_turn, fall_back)
    moved = [surface.transformed(translation=by) for surface, by in zip(surfaces, translations)]
    return Isolation(np.array(translations), moved, json.loads(report))


def pipe(
    curve: "Union[Mapping[str, Any], PathLike]",
    radius: Optional[float] = None,
    *,
    tolerance: Optional[float] = None,
    force: bool = False,
) -> Pipe:
    """The largest radius of a pipe around a curve, and the pipe of a given radius.

    Parameters
    ----------
    curve
        A dictionary with ``degree``, ``knots``, ``points`` (n, 3) in m, and optionally ``weights`` and ``periodic``;
        or a file of the format ``palpate.curve.v1``.
    radius
        m.
    tolerance
        Largest distance of the surface from the exact pipe, m; by default a millionth of the radius.
    force
        Return the pipe even if it intersects itself.

    Raises
    ------
    SurfaceError
        A curve that cannot be a spine; or, without ``force``, a pipe that intersects itself, with the largest radius.
    """
    given = dict(curve) if isinstance(curve, Mapping) else _curve_file(curve)
    unknown = set(given) - {"degree", "knots", "points", "weights", "periodic"}
    missing = {"degree", "knots", "points"} - set(given)
    if unknown or missing:
        raise ValueError(f"a curve has degree, knots and points: unknown {sorted(unknown)}, missing {sorted(missing)}")
    surface, text = _native.pipe({"weights": None, "periodic": False, **given}, radius, tolerance)
    report = json.loads(text)
    if radius is not None and report["free"] is not True and not force:
        words = "intersects itself" if report["free"] is False else "may intersect itself"
        raise SurfaceError(f"the pipe of radius {radius} m {words}; at most {report['r_max']} m is free of that")
    return Pipe(surface, report["r_max"], report["limit"], report["free"], report)


def _curve_file(path: PathLike) -> "dict[str, Any]":
    document = json.loads(Path(path).read_text("utf-8"))
    if document.get("format") != "palpate.curve.v1":
        raise SurfaceError(f"{path}: not a curve file (format palpate.curve.v1)")
    scale = {"m": 1.0, "mm": 1e3}.get(document.get("unit", "m"))
    if scale is None:
        raise SurfaceError(f"{path}: unit {document['unit']!r} is not known; use m or mm")
    known = {key: document[key] for key in ("degree", "knots", "points", "weights", "periodic") if key in document}
    known["points"] = np.asarray(known["points"], dtype=float) / scale
    return known


def branch(tree: "Union[Mapping[str, Any], PathLike, str]") -> Branch:
    """One tensor-product surface for a whole tree of tubes.

    Parameters
    ----------
    tree
        A tree file (.toml), its text, or the same as a dictionary (see ``docs/branch.md``).
    """
    if isinstance(tree, Mapping):
        text = _native.toml_text(dict(tree))
    elif isinstance(tree, str) and "\n" in tree:
        text = tree
    else:
        text = Path(tree).read_text("utf-8")
    surface, report = _native.branch(text)
    told = json.loads(report)
    return Branch(surface, told["patches"], told["ties"])


def fit(
    points: "Union[ArrayLike, PathLike, Mesh]",
    *,
    net: "Optional[tuple[int, int]]" = None,
    degree: int = 3,
    closed: bool = False,
    smoothing: Optional[float] = None,
    grid: bool = False,
    periodic: "tuple[bool, bool]" = (False, False),
    unit: str = "m",
) -> Fit:
    """A surface near points.

    Parameters
    ----------
    points
        (n, 3), a :class:`Mesh`, or a file: .xyz, .csv, .txt, .stl, .obj. With ``grid`` (nu, nv, 3).
    net
        Control points in u and v; by default 8 × 8, of a grid one for each point.
    closed
        A closed surface with two poles instead of a sheet.
    smoothing
        Weight of smoothness against the points: 1e-7 follows them, 1e-3 smooths noise.
    periodic
        Of a grid: directions to close.
    unit
        Of the points, ``m`` or ``mm``.
    """
    given = points.points if isinstance(points, Mesh) else points
    if isinstance(given, os.PathLike):
        given = os.fspath(given)
    options = {
        "net": net,
        "degree": degree,
        "closed": closed,
        "smoothing": smoothing,
        "grid": grid,
        "periodic": periodic,
        "unit": unit,
    }
    return Fit(*_native.fit(given, options))
