"""Writes the surfaces of the spoon scenarios: python3 scenes/surfaces.py (no packages needed).

handle.json: a strip of 150 mm × 16 mm in z = 0, normal +z, u along it; scenes give it its thickness.
box.json: a box with flat faces on z = 0, its edges rounded.
loaf.json: a block of 70 mm × 36 mm × 24 mm on z = 0, round everywhere.
puck.json: a cylinder of radius 20 mm and height 20 mm on z = 0 with flat faces and a rim rounded by half a millimetre.
bowl.json: a bowl of 60 mm × 40 mm, its tip at x = -60 mm, its neck at x = 0, where it is as wide as the handle; 12 mm
deep for the merge, 6 mm for the jelly. Control points are places of these functions, so that the surfaces are smooth versions of them.
"""
import json
import math
import pathlib

HERE = pathlib.Path(__file__).parent


def knots(count):
    inner = count - 3
    return [0.0] * 4 + [k / inner for k in range(1, inner)] + [1.0] * 4


def greville(count):
    t = knots(count)
    return [sum(t[k + 1 : k + 4]) / 3 for k in range(count)]


def surface(name, counts, at):
    points = [[[round(x, 12) for x in at(u, v)] for v in greville(counts[1])] for u in greville(counts[0])]
    return {
        "format": "palpate.surface.v1",
        "name": name,
        "degree": [3, 3],
        "periodic": [False, False],
        "knots": [knots(counts[0]), knots(counts[1])],
        "points": points,
        "flip_normal": False,
    }


def handle(u, v):
    return (0.15 * u, 0.016 * (v - 0.5), 0.0)


def bowl(deep):
    def at(u, v):
        across = 2 * v - 1
        half = 0.004 + 0.016 * math.sin(math.pi * (0.08 + 0.84 * u))
        depth = deep * math.sin(math.pi * (0.1 + 0.85 * u)) * (1 - across * across)
        return (0.06 * (u - 1), half * across, -depth)

    return at


def of_rings(name, rings):
    return {
        "format": "palpate.surface.v1",
        "name": name,
        "degree": [3, 3],
        "periodic": [True, False],
        "knots": [[k / len(rings) for k in range(len(rings) + 1)], knots(len(rings[0]))],
        "points": [[[round(x, 12) for x in point] for point in ring] for ring in rings],
        "flip_normal": False,
    }


def puck(radius, height):
    around = 12
    # A cubic B-spline is inside of its polygon by this.
    out = 3 / (2 + math.cos(2 * math.pi / around))
    rim = 0.025 * height
    # Four rows in a plane make a span of it.
    face = [0.0, 0.3, 0.6, 0.85, 0.95]
    profile = [(part, 0.0) for part in face] + [(1.0, z) for z in (rim, 0.5 * height, height - rim)]
    profile += [(part, height) for part in reversed(face)]
    rings = []
    for k in range(around):
        angle = 2 * math.pi * k / around
        cos, sin = out * radius * math.cos(angle), out * radius * math.sin(angle)
        rings.append([(part * cos, part * sin, z) for part, z in profile])
    return of_rings("puck", rings)


def box(length, width, height, rounded):
    # Five points in a line make two spans of it; the corner between two lines is rounded.
    a, b, r = length / 2, width / 2, rounded
    half = [(a, -b + r), (a, 0), (a, b - r), (a, b), (a - r, b), (0, b), (-a + r, b), (-a, b)]
    around = half + [(-x, -y) for x, y in half]
    face = [0, 0.25, 0.5, 0.75, 1 - 2 * r / min(length, width)]
    profile = [(part, 0) for part in face] + [(1, z) for z in (0, r, height / 2, height - r, height)]
    profile += [(part, height) for part in reversed(face)]
    return of_rings("box", [[(part * x, part * y, z) for part, z in profile] for x, y in around])


def loaf(length, width, height):
    # A superellipsoid of exponent 3, its poles at the ends.
    def power(x):
        return math.copysign(abs(x) ** (2 / 3), x)

    rows, around = 13, 16
    rings = []
    for k in range(around):
        angle = 2 * math.pi * k / around
        ring = []
        for t in greville(rows):
            along, out = power(math.sin(math.pi * (t - 0.5))), power(math.sin(math.pi * t))
            y, z = power(math.cos(angle)) * out, power(math.sin(angle)) * out
            ring.append((0.5 * length * along, 0.5 * width * y, 0.5 * height * (z + 1)))
        rings.append(ring)
    return of_rings("loaf", rings)


def write(document, *folders):
    for folder in folders:
        path = HERE / folder / f"{document['name']}.json"
        path.write_text(json.dumps(document) + "\n")


write(surface("handle", (16, 6), handle), "spoon-bend", "spoon-grip", "spoon-merge", "spoon-weight")
write(surface("bowl", (12, 10), bowl(0.012)), "spoon-merge")
write(surface("bowl", (12, 10), bowl(0.006)), "jelly", "jelly-shake")
write(puck(0.02, 0.02), "stack")
write(box(0.006, 0.02, 0.04, 0.0005), "dominoes")
write(box(0.04, 0.02, 0.02, 0.001), "wall")
write(loaf(0.07, 0.036, 0.024), "cut")
