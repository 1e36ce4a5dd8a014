#!/usr/bin/env python3
"""Stiffness map of a palpated phantom: a soft sheet with a stiff region, pressed at a grid of places at once."""

import argparse

import numpy as np

import palpate as pp

SCENE = {
    "name": "phantom",
    "body": [
        {
            "id": "sheet",
            "surface": {"builtin": "sheet", "net": [8, 8], "size": 0.1},
            "model": "lattice",
            "material": {"young_pa": 20e3, "density_kg_m3": 1000.0, "damping_s": 5e-3},
            "lattice": {"layers": 3, "thickness_m": 0.01, "refine": [12, 12]},
            "fixed": [
                {"point": [-0.048, 0.0, 0.0], "normal": [1.0, 0.0, 0.0]},
                {"point": [0.048, 0.0, 0.0], "normal": [-1.0, 0.0, 0.0]},
            ],
        }
    ],
    "tool": [{"id": "finger", "shape": {"sphere": {"radius_m": 0.006}}, "pose": {"position": [0.0, 0.0, 0.03]}}],
}


def main() -> None:
    parser = argparse.ArgumentParser(description="Map the stiffness of a phantom.")
    parser.add_argument("--grid", type=int, default=9, help="places along each side")
    parser.add_argument("--depth", type=float, default=0.003, help="how far to press, m")
    parser.add_argument("-o", "--output", default="stiffness.csv", help="table x, y, N/m")
    args = parser.parse_args()

    scene = pp.Scene(SCENE)
    side = np.linspace(-0.03, 0.03, args.grid)
    x, y = (values.ravel() for values in np.meshgrid(side, side, indexing="ij"))
    # Where a vertical line meets the sheet: the closest point of a point far above, then above it.
    top = scene.surface("sheet").closest(np.column_stack([x, y, np.full_like(x, 0.01)]))["point"][:, 2]
    batch = pp.Batch(scene, n=len(x))
    pose, force = batch.pose("finger"), batch.contact_force("finger")
    pose[:, 0], pose[:, 1] = x, y
    for way in np.linspace(-0.002, args.depth, 60):
        pose[:, 2] = top + 0.006 - way
        batch.step(2)
    batch.step(60)  # until it rests
    stiffness = force[:, 2] / args.depth
    np.savetxt(args.output, np.column_stack([x, y, stiffness]), delimiter=",", header="x_m,y_m,n_per_m", comments="")
    print(f"{len(x)} places in {args.output}: stiffest {stiffness.max():.1f} N/m, softest {stiffness.min():.1f} N/m")


if __name__ == "__main__":
    main()
