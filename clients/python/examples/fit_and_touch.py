#!/usr/bin/env python3
"""From triangles to touch: fits a closed surface to an STL, makes it a soft body, and presses it.

python3 fit_and_touch.py scan.stl      (without a file: an ellipsoid is tessellated first)
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

import palpate as pp


def main() -> None:
    parser = argparse.ArgumentParser(description="Fit an STL and touch it.")
    parser.add_argument("file", nargs="?", type=Path, help="STL or OBJ, m")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        scan, organ = args.file or Path(directory) / "scan.stl", Path(directory) / "organ.json"
        if args.file is None:
            ball = pp.Surface.builtin("sphere", size=0.03)
            ball.transformed(matrix=[[1.3, 0, 0], [0, 1.0, 0], [0, 0, 0.8]]).save_mesh(scan, cells=5)
        fitted = pp.fit(scan, net=(8, 8), closed=True)
        fitted.surface.save(organ)
        # Where a probe from above touches it first.
        size = fitted.surface.size
        top = fitted.surface.closest(np.array(fitted.surface.centroid()) + [0.0, 0.0, size])["point"]
        scene = pp.Scene(
            {
                "name": "organ",
                "body": [
                    {
                        "id": "organ",
                        "surface": {"file": organ},
                        "model": "lattice",
                        "material": {"young_pa": 15e3, "density_kg_m3": 1000.0, "damping_s": 3e-3},
                        "lattice": {"layers": 3, "refine": "none"},
                        "fixed": [{"point": [0.0, 0.0, float(top[2]) - 1.2 * 0.03], "normal": [0.0, 0.0, 1.0]}],
                    }
                ],
                "tool": [
                    {
                        "id": "finger",
                        "shape": {"sphere": {"radius_m": 0.005}},
                        "pose": {"position": [float(top[0]), float(top[1]), float(top[2]) + 0.007]},
                    }
                ],
            }
        )
        sim, ticks = scene.simulate(), 300
        down = 0.006 * np.minimum(np.arange(ticks) / 200, 1.0)
        places = np.column_stack([np.full(ticks, top[0]), np.full(ticks, top[1]), top[2] + 0.007 - down])
        force = np.linalg.norm(sim.run({"finger": places}).contact_force["finger"], axis=1)
        print(f"fitted to {fitted.max_error:.1e} m, touched with {force.max():.3f} N")


if __name__ == "__main__":
    main()
