"""Dtypes of structured arrays. SI units, world frame."""

import numpy as np

#: A contact that carries force.
CONTACT = np.dtype(
    [
        ("tool", np.int32),  # index in scene.tools; -1: contact between bodies
        ("body", np.int32),  # index in scene.bodies
        ("other_body", np.int32),  # body that touches it; -1: a tool does
        ("copy", np.int32),  # of a batch
        ("u", np.float64),
        ("v", np.float64),
        ("point", np.float64, 3),  # m, on the surface
        ("normal", np.float64, 3),  # outward unit
        ("depth", np.float64),  # m
        ("force", np.float64, 3),  # N, on the tool or on other_body
        ("normal_force", np.float64),  # N, along the normal
        ("friction_force", np.float64, 3),  # N, the rest
    ]
)

#: A closest point of a part.
PART_CLOSEST = np.dtype(
    [
        ("point", np.float64, 3),  # m
        ("normal", np.float64, 3),  # unit, out of the matter
        ("distance", np.float64),  # m
        ("signed_distance", np.float64),  # m; negative inside; NaN where the part has no inside
        ("support", np.uint32),  # 0 a face, 1 an edge, 2 a vertex
        ("support_index", np.uint32),
        ("face", np.uint32),  # on which it lies, or one of those that meet there
    ]
)

#: A closest point of a surface.
CLOSEST = np.dtype(
    [
        ("u", np.float64),
        ("v", np.float64),
        ("point", np.float64, 3),  # m
        ("normal", np.float64, 3),  # outward unit
        ("distance", np.float64),  # m
        ("signed_distance", np.float64),  # m; negative on the inner side
        ("curvature", np.float64, 2),  # 1/m, greater first; NaN where not defined
    ]
)
