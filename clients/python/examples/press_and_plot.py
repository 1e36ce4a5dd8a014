#!/usr/bin/env python3
"""Presses a soft teardrop with a ball, in process, and plots force over depth. Needs ``pip install matplotlib``."""

import argparse

import numpy as np

import palpate as pp

SCENE = {
    "name": "press",
    "body": [
        {
            "id": "drop",
            "surface": {"builtin": "teardrop", "net": [8, 8]},
            "model": "lattice",
            "material": {"young_pa": 20e3, "density_kg_m3": 1000.0, "damping_s": 2e-3},
            "lattice": {"layers": 3, "refine": [12, 12]},
            "fixed": [{"point": [0.0, 0.0, 0.015], "normal": [0.0, 0.0, 1.0]}],
        }
    ],
    "tool": [{"id": "ball", "shape": {"sphere": {"radius_m": 0.01}}, "pose": {"position": [0.06, 0.003, 0.045]}}],
}


def main() -> None:
    parser = argparse.ArgumentParser(description="Press and plot.")
    parser.add_argument("--ticks", type=int, default=1000, help="ticks of 1 ms")
    parser.add_argument("-o", "--output", default="press.svg", help="picture")
    args = parser.parse_args()
    import matplotlib.pyplot as plt

    sim = pp.Scene(SCENE).simulate()
    way = 0.05 * np.sin(np.linspace(0.0, np.pi, args.ticks))  # there and back
    places = np.column_stack([0.06 - way, np.full_like(way, 0.003), np.full_like(way, 0.045)])
    trace = sim.run({"ball": places})
    force, depth = np.linalg.norm(trace.contact_force["ball"], axis=1), trace.depth["ball"]

    figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.5))
    left.plot(trace.tick * sim.scene.dt, force)
    left.set(xlabel="time (s)", ylabel="contact force (N)")
    right.plot((0.06 - places[:, 0]) * 1e3, force)
    right.set(xlabel="way of the ball (mm)", ylabel="contact force (N)")
    figure.tight_layout()
    figure.savefig(args.output)
    peak = int(force.argmax())
    print(f"{args.output}: peak force {force[peak]:.3f} N at {way[peak] * 1e3:.1f} mm; penetration {depth[peak] * 1e3:.2f} mm")


if __name__ == "__main__":
    main()
