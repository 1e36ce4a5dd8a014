#!/usr/bin/env python3
"""Sweeps Young's modulus over the copies of a batch; prints force, speed and how far each is from rest.

With ``-o`` and matplotlib it also plots the speed of the simulation against the error of a coarser net.
"""

import argparse
import time

import numpy as np

import palpate as pp

SCENE = {
    "name": "sweep",
    "body": [
        {
            "id": "drop",
            "surface": {"builtin": "teardrop", "net": [8, 8]},
            "model": "continuum",
            "material": {"young_pa": 20e3, "poisson": 0.4, "density_kg_m3": 1000.0, "damping_s": 2e-3},
            "lattice": {"layers": 3, "refine": "none"},
            "fixed": [{"point": [0.0, 0.0, 0.015], "normal": [0.0, 0.0, 1.0]}],
        }
    ],
    "tool": [{"id": "ball", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"position": [0.06, 0.003, 0.045]}}],
}


def pressed(batch: pp.Batch, ticks: int) -> "tuple[np.ndarray, float]":
    """Forces (n,) on the ball after it was pushed in, and simulated ticks per second and copy."""
    pose, begun = batch.pose("ball"), time.perf_counter()
    for way in np.linspace(0.0, 0.045, ticks):
        pose[:, 0] = 0.06 - way
        batch.step()
    batch.step(ticks)
    return np.linalg.norm(batch.contact_force("ball"), axis=1), 2 * ticks * batch.n / (time.perf_counter() - begun)


def main() -> None:
    parser = argparse.ArgumentParser(description="Sweep E and nu.")
    parser.add_argument("--count", type=int, default=8, help="values of E, and of nu")
    parser.add_argument("--ticks", type=int, default=300, help="ticks of the press")
    parser.add_argument("-o", "--output", help="plot of speed against error")
    args = parser.parse_args()

    scene = pp.Scene(SCENE)
    young, poisson = np.geomspace(5e3, 80e3, args.count), np.linspace(0.2, 0.45, args.count)
    batch = pp.Batch(scene, n=args.count**2)
    batch.vary("body/drop/material/young_pa", np.repeat(young, args.count))
    batch.vary("body/drop/material/poisson", np.tile(poisson, args.count))
    force, rate = pressed(batch, args.ticks)
    table = force.reshape(args.count, args.count)
    print("force (N); rows: E (kPa), columns: nu " + " ".join(f"{nu:.2f}" for nu in poisson))
    for value, row in zip(young, table):
        print(f"{value * 1e-3:7.1f}  " + " ".join(f"{f:7.4f}" for f in row))
    print(f"{rate:.0f} ticks/s over all copies")

    # Speed against error: coarser and finer nets under the same press, the finest as reference.
    figures = []
    for net in (8, 12, 16) if args.output else (8, 12):
        finer = scene.varied({"body/drop/lattice/refine": [net, net]})
        value, speed = pressed(pp.Batch(finer, n=1), args.ticks)
        figures.append((net, float(value[0]), speed))
    reference = figures[-1][1]
    for net, value, speed in figures:
        print(f"net {net:2} x {net:2}: {value:.4f} N, error {abs(value / reference - 1) * 100:5.1f} %, {speed:.0f} ticks/s")
    if args.output:
        import matplotlib.pyplot as plt

        figure, axes = plt.subplots()
        axes.loglog([s for _, _, s in figures[:-1]], [abs(v / reference - 1) for _, v, _ in figures[:-1]], "o-")
        axes.set(xlabel="ticks per second", ylabel="relative error of the force")
        figure.savefig(args.output)
    print(f"force grows with E: {bool((np.diff(table, axis=0) > 0).all())}")


if __name__ == "__main__":
    main()
