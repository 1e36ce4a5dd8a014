#!/usr/bin/env python3
"""Reads a recording into a table and finds its phases of contact. Needs ``pip install pandas``.

python3 recording_to_pandas.py session.mcap      (without a file: records a short session first)
"""

import argparse
import tempfile
from pathlib import Path

import numpy as np

import palpate as pp
from press_and_plot import SCENE


def recorded(path: Path) -> Path:
    """Two presses in lockstep."""
    way = 0.05 * np.sin(np.linspace(0.0, 2.0 * np.pi, 800)) ** 2
    with pp.serve(SCENE, clock="lockstep", record=path) as daemon, daemon.tool("ball") as ball:
        for x in 0.06 - way:
            ball.step((x, 0.003, 0.045))
    return path


def main() -> None:
    parser = argparse.ArgumentParser(description="Read a recording into pandas.")
    parser.add_argument("file", nargs="?", type=Path)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as directory:
        recording = pp.open(args.file or recorded(Path(directory) / "press.mcap"))
        tool = recording.tools[0]
        table = recording.to_pandas(["force", "depth", "contact_count"])
        table["force"] = np.linalg.norm(table[[f"{tool}.force.{axis}" for axis in "xyz"]], axis=1)
        touching = table[f"{tool}.contact_count"] > 0
        table["phase"] = (touching & ~touching.shift(fill_value=False)).cumsum().where(touching)
        for number, phase in table.groupby("phase"):
            span = phase["time"].iloc[[0, -1]].to_numpy()
            print(f"contact {number:.0f}: {span[0]:.3f} to {span[1]:.3f} s, at most {phase['force'].max():.3f} N")
        peak = table["force"].idxmax()
        print(f"peak force {table['force'][peak]:.3f} N at {table['time'][peak]:.3f} s")


if __name__ == "__main__":
    main()
