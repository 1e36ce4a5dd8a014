"""Surfaces against SciPy and mpmath, files, modeling."""

import json
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import palpate as pp

from .conftest import ROOT

RNG = np.random.default_rng(11)


def wavy(rational: bool = False) -> pp.Surface:
    """A sheet of degrees 3 and 2 with uneven knots."""
    nu, nv = 7, 6
    knots_u = [0.0] * 4 + [0.2, 0.25, 0.7] + [1.0] * 4
    knots_v = [-1.0] * 3 + [0.0, 0.5, 1.1] + [2.0] * 3
    x, y = np.meshgrid(np.linspace(0.0, 0.1, nu), np.linspace(0.0, 0.08, nv), indexing="ij")
    points = np.stack([x, y, 0.01 * RNG.standard_normal((nu, nv))], axis=-1)
    weights = RNG.uniform(0.5, 2.0, (nu, nv)) if rational else None
    return pp.Surface((3, 2), (knots_u, knots_v), points, weights)


def scipy_point(surface: pp.Surface, u: Any, v: Any, du: int = 0, dv: int = 0) -> Any:
    """A derivative of a surface without weights, by scipy.interpolate.BSpline."""
    interpolate = pytest.importorskip("scipy.interpolate")
    basis = [
        interpolate.BSpline(knots, np.eye(count), degree)
        for knots, count, degree in zip(surface.knots, surface.points.shape, surface.degree)
    ]
    return np.einsum("...i,...j,ijk->...k", basis[0](u, du), basis[1](v, dv), surface.points)


def test_points_and_derivatives_are_those_of_scipy() -> None:
    surface = wavy()
    (a, b), (c, d) = surface.domain
    u, v = RNG.uniform(a, b, (20, 1)), RNG.uniform(c, d, 15)
    found = surface.evaluate(u, v, derivatives=2)
    orders = {"point": (0, 0), "du": (1, 0), "dv": (0, 1), "duu": (2, 0), "duv": (1, 1), "dvv": (0, 2)}
    for name, (du, dv) in orders.items():
        expected = scipy_point(surface, np.broadcast_to(u, (20, 15)), np.broadcast_to(v, (20, 15)), du, dv)
        values = getattr(found, name)
        assert values.shape == (20, 15, 3)
        np.testing.assert_allclose(values, expected, rtol=1e-11, atol=1e-12 * 10 ** (3 * (du + dv)), err_msg=name)
    np.testing.assert_allclose(surface.evaluate(u, v), found.point, rtol=1e-12, atol=1e-16)
    assert surface.evaluate(u, v, derivatives=1).duu is None
    assert surface.evaluate(0.3, 0.5).shape == (3,)


def test_a_rational_point_is_that_of_mpmath() -> None:
    mpmath = pytest.importorskip("mpmath")
    surface = wavy(rational=True)

    def basis(knots: Any, degree: int, k: int, t: Any) -> Any:
        # The recursion of Cox and de Boor with 40 digits.
        if degree == 0:
            return mpmath.mpf(1 if knots[k] <= t < knots[k + 1] else 0)
        left, right = knots[k + degree] - knots[k], knots[k + degree + 1] - knots[k + 1]
        total = mpmath.mpf(0)
        if left:
            total += (t - knots[k]) / left * basis(knots, degree - 1, k, t)
        if right:
            total += (knots[k + degree + 1] - t) / right * basis(knots, degree - 1, k + 1, t)
        return total

    with mpmath.workdps(40):
        knots = [[mpmath.mpf(float(x)) for x in knots] for knots in surface.knots]
        for u, v in ((0.1, -0.7), (0.25, 0.5), (0.93, 1.9)):
            total, weight = [mpmath.mpf(0)] * 3, mpmath.mpf(0)
            for i in range(surface.points.shape[0]):
                for j in range(surface.points.shape[1]):
                    part = basis(knots[0], 3, i, mpmath.mpf(u)) * basis(knots[1], 2, j, mpmath.mpf(v))
                    part *= mpmath.mpf(float(surface.weights[i, j]))
                    weight += part
                    total = [t + part * mpmath.mpf(float(p)) for t, p in zip(total, surface.points[i, j])]
            expected = [float(t / weight) for t in total]
            np.testing.assert_allclose(surface.evaluate(u, v), expected, rtol=1e-14, atol=1e-16)


def test_closest_points_of_a_sphere_have_a_closed_form() -> None:
    radius = 0.05
    sphere = pp.Surface.builtin("sphere", size=radius)
    queries = RNG.standard_normal((4, 50, 3)) * 0.06
    found = sphere.closest(queries)
    assert found.shape == (4, 50) and found.dtype == pp.CLOSEST
    length = np.linalg.norm(queries, axis=-1)
    np.testing.assert_allclose(found["signed_distance"], length - radius, atol=1e-12)
    np.testing.assert_allclose(found["point"], queries / length[..., None] * radius, atol=1e-11)
    np.testing.assert_allclose(found["normal"], queries / length[..., None], atol=1e-9)
    np.testing.assert_allclose(found["curvature"], np.full((4, 50, 2), 1.0 / radius), rtol=1e-6)
    np.testing.assert_array_equal(found["distance"], np.abs(found["signed_distance"]))
    np.testing.assert_array_equal(found, sphere.closest(queries, workers=1), "threads change nothing")
    assert sphere.closest(np.zeros((0, 3))).shape == (0,)
    assert np.isnan(sphere.closest(queries, curvature=False)["curvature"]).all()


def test_no_sample_is_nearer_than_the_closest_point() -> None:
    surface = wavy(rational=True)
    (a, b), (c, d) = surface.domain
    grid = surface.evaluate(np.linspace(a, b, 200)[:, None], np.linspace(c, d, 200)).reshape(-1, 3)
    queries = RNG.uniform([-0.02, -0.02, -0.05], [0.12, 0.1, 0.05], (60, 3))
    found = surface.closest(queries)
    sampled = np.linalg.norm(grid[None] - queries[:, None], axis=-1).min(axis=1)
    assert (found["distance"] <= sampled + 1e-12).all()
    np.testing.assert_allclose(surface.evaluate(found["u"], found["v"]), found["point"], atol=1e-14)


def test_measures_of_a_sphere() -> None:
    sphere = pp.Surface.builtin("sphere", size=0.1)
    assert sphere.closed and not wavy().closed
    assert sphere.area() == pytest.approx(4.0 * np.pi * 0.01, rel=1e-6)
    assert sphere.volume() == pytest.approx(4.0 / 3.0 * np.pi * 1e-3, rel=1e-6)
    np.testing.assert_allclose(sphere.centroid(), 0.0, atol=1e-12)
    moved = sphere.transformed(translation=(0.1, 0.2, 0.3))
    np.testing.assert_allclose(moved.centroid(), [0.1, 0.2, 0.3], atol=1e-12)
    half = sphere.transformed(matrix=[[0.5, 0, 0], [0, 0.5, 0], [0, 0, 0.5]])
    assert half.volume() == pytest.approx(sphere.volume() / 8)
    (a, b), (c, d) = sphere.domain
    np.testing.assert_allclose(np.linalg.norm(sphere.normal(np.linspace(a, b, 9), 0.5 * (c + d)), axis=-1), 1.0)
    mesh = sphere.tessellate(tolerance=1e-4)
    assert np.abs(np.linalg.norm(mesh.points, axis=1) - 0.1).max() < 1e-4
    assert mesh.triangles.max() < len(mesh.points) and mesh.normals.shape == mesh.points.shape


def test_the_same_surface_by_other_means() -> None:
    surface = wavy()
    (a, b), (c, d) = surface.domain
    u, v = np.linspace(a, b, 13)[:, None], np.linspace(c, d, 11)
    for same in (surface.refined(12, 14), surface.elevated("u"), surface.elevated("v")):
        np.testing.assert_allclose(same.evaluate(u, v), surface.evaluate(u, v), atol=1e-15)
    part = surface.part([0.3, 0.6], [0.0, 1.0])
    np.testing.assert_allclose(part.evaluate(0.4, 0.2), surface.evaluate(0.4, 0.2), atol=1e-15)
    with pytest.raises(ValueError, match='"u" or "v"'):
        surface.elevated("w")


@pytest.mark.parametrize("ending", [".json", ".step", ".iges"])
def test_files_and_pickles_keep_every_bit(ending: str, tmp_path: Path) -> None:
    for surface in (wavy(), wavy(rational=True), pp.Surface.builtin("torus")):
        assert pickle.loads(pickle.dumps(surface)) == surface
        if ending != ".json" and any(surface.periodic):
            continue
        path = tmp_path / f"surface{ending}"
        surface.save(path)
        (back,) = pp.Surface.load(path)
        np.testing.assert_array_equal(back.points, surface.points)
        assert back == surface or ending != ".json"
    with pytest.raises(pp.SurfaceError, match="extension"):
        wavy().save(tmp_path / "surface.txt2")
    with pytest.raises(FileNotFoundError):
        pp.Surface.load(tmp_path / f"none{ending}")
    (tmp_path / f"broken{ending}").write_text("{")
    with pytest.raises(pp.SurfaceError, match="broken"):
        pp.Surface.load(tmp_path / f"broken{ending}")


PARTS = ROOT / "crates" / "geometry" / "tests" / "data" / "parts"


def test_a_part_has_its_faces_distances_and_triangles() -> None:
    part = pp.Part.load(PARTS / "filleted_box.step")
    data = json.loads((PARTS / "filleted_box.json").read_text())
    assert part.closed and part.left_out == "" and part.gap < 1e-15
    assert [name for name, _ in part.faces].count("sphere") == 8
    np.testing.assert_allclose([area for _, area in part.faces], [f["area"] * 1e-6 for f in data["faces"]], rtol=1e-9)
    assert part.volume == pytest.approx(data["volume"] * 1e-9, rel=1e-9)
    queries = data["queries"]
    feet = part.closest(np.array([q[:3] for q in queries]) * 1e-3)
    assert feet.dtype == pp.PART_CLOSEST
    np.testing.assert_allclose(feet["distance"], [q[4] * 1e-3 for q in queries], atol=1e-10)
    np.testing.assert_array_equal(feet, part.closest(np.array([q[:3] for q in queries]) * 1e-3, workers=1))
    outside = np.array([q[10] == "out" and q[4] > 1e-6 for q in queries])
    assert (feet["signed_distance"][outside] > 0).all()
    mesh = part.tessellate(1e-4)
    a, b, c = (mesh.points[mesh.triangles[:, k]] for k in range(3))
    assert np.einsum("ij,ij->", a, np.cross(b, c)) / 6 == pytest.approx(part.volume, rel=0.02)
    with pytest.raises(pp.SurfaceError, match="no B-spline|Part.load"):
        pp.Surface.load(PARTS / "filleted_box.step")
    with pytest.raises(pp.SurfaceError, match="Part.load"):
        pp.Surface.load(PARTS / "loft.step")


def test_what_is_no_surface_says_why() -> None:
    points = np.zeros((4, 4, 3))
    knots = [0.0] * 4 + [1.0] * 4
    cases: list[tuple[type[Exception], str, tuple[Any, ...], dict[str, Any]]] = [
        (pp.SurfaceError, "knots", ((3, 3), ([0.0] * 4 + [1.0] * 3, knots), points), {}),
        (pp.SurfaceError, "knots in v", ((3, 3), (knots, [1.0] * 4 + [0.0] * 4), points), {}),
        (pp.SurfaceError, "points in u", ((3, 3), (knots, knots), np.zeros((5, 4, 3))), {}),
        (ValueError, r"\(nu, nv, 3\)", ((3, 3), (knots, knots), np.zeros((4, 3))), {}),
        (ValueError, r"\(…, 3\)", ((3, 3), (knots, knots), np.zeros((4, 4, 2))), {}),
        (ValueError, "finite", ((3, 3), (knots, knots), np.full((4, 4, 3), np.nan)), {}),
        (ValueError, r"\(4, 4\) is needed", ((3, 3), (knots, knots), points), {"weights": np.ones(16)}),
        (pp.SurfaceError, "weight", ((3, 3), (knots, knots), points), {"weights": np.zeros((4, 4))}),
        (pp.SurfaceError, "degree", ((0, 3), (knots, knots), points), {}),
    ]
    for kind, words, arguments, named in cases:
        with pytest.raises(kind, match=words):
            pp.Surface(*arguments, **named)
    surface = wavy()
    with pytest.raises(pp.SurfaceError, match=r"u\[1\]"):
        surface.evaluate([0.5, 1.5], 0.0)
    with pytest.raises(ValueError, match="finite"):
        surface.evaluate(np.nan, 0.0)
    with pytest.raises(ValueError, match="broadcast"):
        surface.evaluate(np.zeros(2), np.zeros(3))
    with pytest.raises(ValueError, match="0, 1 or 2"):
        surface.evaluate(0.0, 0.0, derivatives=3)
    for query in (np.zeros(2), np.zeros((3, 4))):
        with pytest.raises(ValueError, match=r"\(…, 3\)"):
            surface.closest(query)
    with pytest.raises(ValueError, match="finite"):
        surface.closest([[0.0, np.nan, 0.0]])
    with pytest.raises(TypeError, match="real numbers"):
        surface.closest(np.zeros((2, 3), complex))
    with pytest.raises(pp.SurfaceError, match="banana"):
        pp.Surface.builtin("banana")


def test_float32_and_strided_arrays_give_what_their_values_give() -> None:
    surface = wavy()
    queries = RNG.uniform(0.0, 0.1, (30, 6))
    strided = queries[::3, ::2]
    np.testing.assert_array_equal(surface.closest(strided), surface.closest(strided.copy()))
    single = strided.astype(np.float32)
    np.testing.assert_array_equal(surface.closest(single), surface.closest(single.astype(np.float64)))
    np.testing.assert_array_equal(surface.evaluate(np.array([0, 1]), 0), surface.evaluate([0.0, 1.0], 0.0))
    fortran = np.asfortranarray(surface.points)
    assert pp.Surface(surface.degree, surface.knots, fortran) == surface


def test_patches_merge_with_the_continuity_asked_for() -> None:
    left = pp.Surface.builtin("sheet", size=0.1)
    right = left.transformed(translation=(np.ptp(left.points[..., 0]), 0.0, 0.0))
    merged = left.merge(right, continuity=2, tolerance=1e-9)
    assert merged.within_tolerance and merged.deviation["maximum_m"] < 1e-9
    (seam,) = merged.seams
    assert seam["continuity"]["second_jump"] < 1e-6
    assert pp.merge([left, right]).surface.degree == left.degree
    with pytest.raises(pp.SurfaceError):
        pp.merge([left])
    with pytest.raises(ValueError, match="constrained, seed, exact"):
        pp.merge([left, right], method="glue")


def test_patches_that_cross_are_merged_by_rows_or_by_lines() -> None:
    left = pp.Surface.builtin("sheet", size=0.1)
    x, y = left.points[..., 0], left.points[..., 1]
    tilted = left.points + np.stack([np.full_like(x, 0.08), 0 * x, 0.3 * (x + 0.04 - 0.1 * y)], axis=-1)
    right = pp.Surface(left.degree, left.knots, tilted)
    merged = left.merge(right, edges=("u1", "u0"), continuity=0)
    assert [reading["hidden"] for reading in merged.readings] == ["rows", "lines"]
    assert merged.hidden == "lines" and merged.readings[1]["lost_share"] == 0.0
    assert left.merge(right, edges=("u1", "u0"), hidden="rows").hidden == "rows"
    with pytest.raises(ValueError, match="rows, lines"):
        left.merge(right, hidden="columns")


def test_overlapping_spheres_move_apart_by_what_is_missing() -> None:
    fixed = pp.Surface.builtin("sphere", size=0.05)
    moving = fixed.transformed(translation=(0.08, 0.0, 0.0))
    apart = pp.isolate(moving, fixed, gap=1e-4)
    np.testing.assert_allclose(apart.translation, [0.02, 0.0, 0.0], atol=2e-4)
    np.testing.assert_allclose(apart.surfaces[0].centroid(), [0.1, 0.0, 0.0], atol=2e-4)
    three = pp.isolate(fixed, moving, fixed.transformed(translation=(0.16, 0.0, 0.0)), gap=1e-4)
    assert three.translations.shape == (3, 3)
    with pytest.raises(pp.SurfaceError, match="open"):
        pp.isolate(wavy(), fixed)


def test_a_pipe_around_an_arc_is_bounded_by_its_radius() -> None:
    arc = {
        "degree": 2,
        "knots": [0, 0, 0, 1, 1, 1],
        "points": [[0.1, 0.0, 0.0], [0.1, 0.1, 0.0], [0.0, 0.1, 0.0]],
        "weights": [1.0, np.sqrt(0.5), 1.0],
    }
    assert pp.pipe(arc).r_max == pytest.approx(0.1, rel=1e-6)
    pipe = pp.pipe(arc, radius=0.02)
    assert pipe.free is True and pipe.surface is not None
    (a, b), (c, d) = pipe.surface.domain
    points = pipe.surface.evaluate(np.linspace(a, b, 20)[:, None], np.linspace(c, d, 20)).reshape(-1, 3)
    ring = np.hypot(np.hypot(points[:, 0], points[:, 1]) - 0.1, points[:, 2])
    np.testing.assert_allclose(ring, 0.02, atol=1e-7)
    with pytest.raises(pp.SurfaceError, match="intersects itself"):
        pp.pipe(arc, radius=0.15)
    assert pp.pipe(arc, radius=0.12, force=True).free is False
    with pytest.raises(ValueError, match="missing .*knots"):
        pp.pipe({"degree": 2, "points": []})


def test_a_tree_becomes_one_surface() -> None:
    path = ROOT / "crates" / "modeling" / "src" / "branch" / "data" / "y.toml"
    grown = pp.branch(path)
    assert grown.surface == pp.branch(path.read_text("utf-8")).surface
    assert len(grown.patches) == 8 and grown.ties


def test_fits_come_near_their_points(tmp_path: Path) -> None:
    directions = RNG.standard_normal((1200, 3))
    points = 0.05 * directions / np.linalg.norm(directions, axis=1)[:, None]
    fitted = pp.fit(points, net=(12, 12), closed=True)
    assert fitted.surface.closed and fitted.max_error < 1e-4
    found = fitted.surface.closest(points)
    assert found["distance"].max() == pytest.approx(fitted.max_error, rel=0.2)
    pp.Surface.builtin("sphere", size=0.05).save_mesh(tmp_path / "ball.stl", cells=4)
    assert pp.fit(tmp_path / "ball.stl", net=(10, 10), closed=True).max_error < 1e-3
    x, y = np.meshgrid(np.linspace(0, 0.1, 20), np.linspace(0, 0.1, 25), indexing="ij")
    grid = np.stack([x, y, 0.01 * np.sin(40 * x)], axis=-1)
    assert pp.fit(grid, grid=True).max_error < 1e-12
    with pytest.raises(pp.SurfaceError, match="too few"):
        pp.fit(points[:5])
    with pytest.raises(FileNotFoundError):
        pp.fit(tmp_path / "none.stl")


@pytest.mark.parametrize("bad", [np.nan, np.inf, -1e308, 1e155])
def test_numbers_that_overflow_make_no_surface(bad: float) -> None:
    sheet = wavy()
    points = np.array(sheet.points)
    points[2, 3, 1] = bad
    with pytest.raises((pp.SurfaceError, ValueError), match="finite"):
        pp.Surface(sheet.degree, sheet.knots, points)
    with pytest.raises((pp.SurfaceError, ValueError), match="finite"):
        sheet.transformed(translation=(bad, 0.0, 0.0))
    with pytest.raises(ValueError, match="finite"):
        sheet.closest([[bad, 0.0, 0.0]])


@pytest.mark.parametrize(
    ("call", "name"),
    [
        (lambda sheet: pp.merge([sheet, sheet], continuity="two"), "continuity"),
        (lambda sheet: pp.merge([sheet, sheet], tolerance="small"), "tolerance"),
        (lambda sheet: pp.fit([[0.0, 0.0, 0.0]], degree="three"), "degree"),
        (lambda sheet: pp.pipe({"degree": "three", "knots": [0.0, 1.0], "points": [[0.0, 0.0, 0.0]]}), "degree"),
    ],
)
def test_an_argument_of_another_type_is_named(call: Any, name: str) -> None:
    with pytest.raises(TypeError, match=f"argument '{name}'"):
        call(pp.Surface.builtin("sheet"))
