"""Draws the pictures of the scenarios from recordings of them:

    python3 scenes/pictures.py PALPATE RECORDINGS [NAME …]

PALPATE is the program, RECORDINGS a folder for what `palpate scenario NAME --record RECORDINGS/NAME.mcap` writes (kept
if there). Needs matplotlib and numpy. The map of `palpation` is written by `palpate scenario palpation --out DIR` itself.
"""
import json
import pathlib
import subprocess
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from mpl_toolkits.mplot3d.art3d import Poly3DCollection

HERE = pathlib.Path(__file__).parent
SKIN = {"bowl": "#9aa7b4", "jelly": "#d1495b", "plate": "#9aa7b4", "floor": "#9aa7b4", "puck-1": "#d1495b", "gel-2-1": "#d1495b"}

# By scenario: panels of (run, tick, title), view (elevation, azimuth), bodies to leave out.
PANELS = {
    "teardrop-tools": ([("sphere", 950, "sphere"), ("point", 950, "point"), ("plane", 950, "plane"), ("torus", 950, "torus")], (12, -70)),
    "plasticine": ([("60 N", 1190, "60 N, pulled"), ("60 N", 2000, "60 N, released")], (14, -60)),
    "spoon-bend": ([("bent", 10, "before"), ("bent", 1150, "pushed"), ("bent", 2200, "what stays")], (12, -80)),
    "spoon-grip": ([("four grips", 10, "before"), ("four grips", 2800, "four grips")], (16, -75)),
    "spoon-weight": ([("polypropylene", 10000, "polypropylene, 0.03 mm of sag")], (12, -80)),
    "jelly": ([("0 degrees", 4000, "0°"), ("10 degrees", 4000, "10°"), ("20 degrees", 4000, "20°"), ("30 degrees", 600, "30°, after 0.6 s")], (14, -85)),
    "jelly-shake": ([("8 degrees", 4000, "8°"), ("8 degrees, shaken along", 4000, "shaken along"), ("8 degrees, shaken across", 4000, "shaken across"), ("8 degrees sideways, shaken so", 4000, "sideways")], (14, -60)),
    "two-hands": ([("right hand alone", 1150, "one hand"), ("both hands", 1150, "both hands")], (12, -80)),
    "vessel-probe": ([("vessel", 10, "before"), ("vessel", 1350, "probed")], (12, -70)),
    "stack": ([("tower", 2000, "ten alike"), ("heavy on light", 2000, "the second 100 times as heavy")], (10, -70)),
    "dominoes": ([("row", 250, "0.25 s"), ("row", 1200, "after 1.2 s")], (14, -75)),
    "wall": ([("wall", 500, "at rest")], (14, -60)),
    "cut": ([("two cuts", 10, "cut"), ("two cuts", 3500, "pushed")], (24, -60)),
    "tele-touch": ([("both near", 1000, "both press, near"), ("20 ms away", 1000, "both press, 20 ms away")], (16, -70)),
}


# Heights drawn larger, where they would not show.
STRETCH = {"spoon-grip": 6.0, "plasticine": 10.0, "spoon-weight": 400.0, "tele-touch": 4.0}
# Only what is nearer to the middle than this, m.
NEAR = {"plasticine": 0.02, "stack": 0.06, "dominoes": 0.23, "wall": 0.12}
# Bodies left out.
OUT = {"plate", "table"}


def run(*command):
    subprocess.run([str(c) for c in command], check=True, stdout=subprocess.DEVNULL)


def mesh(palpate, recording, body, tick):
    path = recording.with_suffix(f".{body}.{tick}.obj")
    if not path.exists():
        run(palpate, "export", recording, path, "--net", body, "--tick", tick)
    points, faces = [], []
    for line in path.read_text().splitlines():
        words = line.split()
        if words[:1] == ["v"]:
            points.append([float(w) for w in words[1:4]])
        elif words[:1] == ["f"]:
            faces.append([int(w.split("/")[0]) - 1 for w in words[1:4]])
    return np.array(points), np.array(faces)


def shaded(points, faces, colour):
    base = np.array(matplotlib.colors.to_rgb(colour))
    a, b, c = (points[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-30)
    light = np.array([0.3, -0.6, 0.75]) / np.linalg.norm([0.3, -0.6, 0.75])
    lit = 0.45 + 0.55 * np.abs(normal @ light)
    return np.clip(base[None, :] * lit[:, None], 0, 1)


def draw(palpate, recordings, name):
    panels, (elevation, azimuth) = PANELS[name]
    figure = plt.figure(figsize=(3.4 * len(panels), 3.2), dpi=90)
    listed = subprocess.run([palpate, "scenario", "--list", "--json"], capture_output=True, check=True, text=True).stdout
    runs = next(s["runs"] for s in map(json.loads, listed.splitlines()) if s["name"] == name)
    single = recordings / f"{name}.mcap"
    if not any(recordings.glob(f"{name}*.mcap")):
        with (recordings / f"{name}.txt").open("w") as table:
            subprocess.run([palpate, "scenario", name, "--record", single], stdout=table)
    for k, (run_name, tick, title) in enumerate(panels):
        recording = single if single.exists() else recordings / f"{name}-{runs.index(run_name)}.mcap"
        info = json.loads(subprocess.run([palpate, "info", recording, "--json"], capture_output=True, check=True, text=True).stdout)
        bodies = [body for body in bodies_of(info) if body not in OUT]
        axes = figure.add_subplot(1, len(panels), k + 1, projection="3d")
        everything = []
        for body in bodies:
            points, faces = mesh(palpate, recording, body, tick)
            points[:, 2] *= STRETCH.get(name, 1.0)
            near = NEAR.get(name)
            if near:
                faces = faces[np.abs(points[faces][:, :, :2]).max(axis=(1, 2)) < near]
            everything.append(points[np.unique(faces)])
            colour = SKIN.get(body, "#d98e4a")
            part = Poly3DCollection(points[faces], facecolors=shaded(points, faces, colour), edgecolors="none", linewidths=0, antialiased=False, alpha=0.55 if body == "bowl" else 1.0)
            if body == "floor":
                # Behind all that stands on it.
                part.set_sort_zpos(-10.0)
            axes.add_collection3d(part)
        everything = np.concatenate(everything) * 1.0
        low, high = everything.min(0), everything.max(0) + 1e-9
        axes.set_xlim(low[0], high[0]); axes.set_ylim(low[1], high[1]); axes.set_zlim(low[2], high[2])
        axes.set_box_aspect(np.maximum(high - low, 1e-3 * (high - low).max()), zoom=1.05)
        axes.view_init(elevation, azimuth)
        axes.set_axis_off()
        stretch = f" (heights × {STRETCH[name]:.0f})" if name in STRETCH else ""
        axes.set_title(title + stretch)
    figure.subplots_adjust(left=0, right=1, bottom=0, top=0.92, wspace=0)
    figure.savefig(HERE / name / "picture.png")
    plt.close(figure)
    print(HERE / name / "picture.png")


def bodies_of(info):
    found = info.get("bodies") or info.get("scene", {}).get("bodies") or []
    return [body["id"] if isinstance(body, dict) else body for body in found]


def main():
    palpate, recordings = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
    recordings.mkdir(parents=True, exist_ok=True)
    for name in sys.argv[3:] or PANELS:
        draw(palpate, recordings, name)


if __name__ == "__main__":
    main()
