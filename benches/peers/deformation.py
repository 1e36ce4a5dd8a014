"""The press of `palpate bench deformation` in MuJoCo or PyBullet.

    python deformation.py mujoco|pybullet SCALE PRESS_TICKS HOLD_TICKS

A box of 0.1 m (12 nodes a side, 1000 kg/m3, E = 20 kPa * SCALE, nu = 0.3, bottom fixed), a frictionless ball of 30 mm
pressed 10 mm into the middle of its top, steps of 1 ms. Prints one JSON object, with forces in newtons.
"""

import json
import math
import os
import statistics
import sys
import tempfile
import time

NODES = 12
SIDE = 0.1
BALL = 0.03
DT = 1e-3
YOUNG = 20e3
POISSON = 0.3
MARGIN = 1e-4


def report(method, times, forces):
    """Force and its range over the last 50 ticks."""
    last = forces[-50:]
    ordered = sorted(times)
    row = {
        "method": method,
        "median_s": ordered[len(ordered) // 2],
        "p99_s": ordered[(len(ordered) - 1) * 99 // 100],
        "force_n": statistics.fmean(last),
        "range_n": [min(last), max(last)],
        "n": len(times),
    }
    if not all(math.isfinite(x) for x in forces):
        raise SystemExit(f"{method}: a force that is not finite")
    print(json.dumps(row))


def heights(press, hold):
    """Height of the ball's centre above the top of the box, a tick at a time."""
    return [BALL + MARGIN - 0.01 * min(1.0, (k + 1) / press) for k in range(press + hold)]


def mujoco(scale, press, hold):
    import mujoco as mj
    import numpy as np

    step = SIDE / (NODES - 1)
    # Elasticity is implicit with the integrator "discrete" (4.0); before, with "implicitfast".
    def model(integrator):
        return mj.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{DT}" gravity="0 0 0" integrator="{integrator}" solver="CG" tolerance="1e-8" iterations="100"/>
  <size memory="512M"/>
  <worldbody>
    <body name="ball" mocap="true" pos="0 0 {BALL + 2e-3}">
      <geom type="sphere" size="{BALL}" condim="1" solref="0.004 1" solimp="0.99 0.999 0.0001"/>
    </body>
    <flexcomp name="box" type="grid" dim="3" count="{NODES} {NODES} {NODES}" spacing="{step} {step} {step}"
              pos="0 0 {-SIDE / 2}" mass="1" radius="{MARGIN}">
      <contact condim="1" selfcollide="none" solref="0.004 1" solimp="0.99 0.999 0.0001"/>
      <elasticity young="{YOUNG * scale}" poisson="{POISSON}" damping="0.002"/>
      <pin gridrange="0 0 0 {NODES - 1} {NODES - 1} 0"/>
    </flexcomp>
  </worldbody>
</mujoco>""")

    try:
        m = model("discrete")
    except ValueError:
        m = model("implicitfast")
    d = mj.MjData(m)
    times, forces, wrench = [], [], np.zeros(6)
    for height in heights(press, hold):
        d.mocap_pos[0] = [0.0, 0.0, height]
        start = time.perf_counter()
        mj.mj_step(m, d)
        times.append(time.perf_counter() - start)
        total = 0.0
        for c in range(d.ncon):
            mj.mj_contactForce(m, d, c, wrench)
            total += abs(wrench[0] * d.contact[c].frame[2])
        forces.append(total)
    report(f"mujoco {mj.__version__} flex, CG", times, forces)


def grid():
    """Nodes, and five tetrahedra a cell with face diagonals shared."""
    n, step = NODES, SIDE / (NODES - 1)
    nodes = [
        (i * step - SIDE / 2, j * step - SIDE / 2, k * step - SIDE)
        for i in range(n) for j in range(n) for k in range(n)
    ]
    even = [(0, 3, 5, 6), (1, 0, 3, 5), (2, 0, 3, 6), (4, 0, 5, 6), (7, 3, 5, 6)]
    odd = [(1, 2, 4, 7), (0, 1, 2, 4), (3, 1, 2, 7), (5, 1, 4, 7), (6, 2, 4, 7)]
    cells = []
    for i in range(n - 1):
        for j in range(n - 1):
            for k in range(n - 1):
                corner = [((i + (c & 1)) * n + j + (c >> 1 & 1)) * n + k + (c >> 2 & 1) for c in range(8)]
                for tet in (even if (i + j + k) % 2 == 0 else odd):
                    a, b, c, e = (corner[t] for t in tet)
                    p, q, r, s = (nodes[x] for x in (a, b, c, e))
                    u, v, w = ([y[t] - p[t] for t in range(3)] for y in (q, r, s))
                    volume = (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
                              + u[2] * (v[0] * w[1] - v[1] * w[0]))
                    cells.append((a, b, c, e) if volume > 0 else (a, c, b, e))
    return nodes, cells


def vtk(path):
    nodes, cells = grid()
    with open(path, "w") as out:
        out.write("# vtk DataFile Version 2.0\nbox\nASCII\nDATASET UNSTRUCTURED_GRID\n")
        out.write(f"POINTS {len(nodes)} double\n")
        out.writelines("%.9g %.9g %.9g\n" % p for p in nodes)
        out.write(f"CELLS {len(cells)} {5 * len(cells)}\n")
        out.writelines("4 %d %d %d %d\n" % c for c in cells)
        out.write(f"CELL_TYPES {len(cells)}\n" + "10\n" * len(cells))
    return nodes


def pybullet(scale, press, hold):
    import pybullet as p

    p.connect(p.DIRECT)
    p.resetSimulation(p.RESET_USE_DEFORMABLE_WORLD)
    p.setGravity(0, 0, 0)
    p.setPhysicsEngineParameter(fixedTimeStep=DT, numSubSteps=1, sparseSdfVoxelSize=0.01)
    lame_mu = YOUNG * scale / (2 * (1 + POISSON))
    lame_lambda = YOUNG * scale * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "box.vtk")
        nodes = vtk(path)
        box = p.loadSoftBody(
            path, simFileName=path, mass=1.0, useNeoHookean=1, NeoHookeanMu=lame_mu, NeoHookeanLambda=lame_lambda,
            NeoHookeanDamping=0.002, collisionMargin=MARGIN, useSelfCollision=0, frictionCoeff=0.0,
            useFaceContact=1, repulsionStiffness=8000,
        )
    for k, node in enumerate(nodes):
        if node[2] < -SIDE + 1e-6:
            p.createSoftBodyAnchor(box, k, -1, -1)
    shape = p.createCollisionShape(p.GEOM_SPHERE, radius=BALL)
    at = [0.0, 0.0, BALL + 2e-3]
    ball = p.createMultiBody(1.0, shape, -1, at)
    p.changeDynamics(ball, -1, lateralFriction=0.0, linearDamping=0.0)
    # Contact forces with soft bodies are not reported: what holds the ball to its path tells them.
    held = p.createConstraint(ball, -1, -1, -1, p.JOINT_FIXED, [0, 0, 0], [0, 0, 0], at)
    p.changeConstraint(held, at, maxForce=1e9)
    times, forces = [], []
    for height in heights(press, hold):
        p.changeConstraint(held, [0.0, 0.0, height], maxForce=1e9)
        start = time.perf_counter()
        p.stepSimulation()
        times.append(time.perf_counter() - start)
        forces.append(-p.getConstraintState(held)[2])
    sign = 1.0 if statistics.fmean(forces[-50:]) >= 0 else -1.0
    report("pybullet neo-Hookean", times, [sign * f for f in forces])


if __name__ == "__main__":
    engine, scale, press, hold = sys.argv[1], float(sys.argv[2]), int(sys.argv[3]), int(sys.argv[4])
    {"mujoco": mujoco, "pybullet": pybullet}[engine](scale, press, hold)
