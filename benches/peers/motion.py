"""The ring-down of `palpate bench deformation` in MuJoCo.

    python motion.py < beam.json

`beam.json` has `counts` (nodes along x, y, z), `sides` (m), `young_pa`, `poisson`, `density_kg_m3`, `held_m` (nodes up
to this x never move), `rest` and `start` (places of our nodes, m) and `ticks`. Prints one JSON object: the mean height of the free end above rest after each step of 1 ms, m, and the times of
the steps, s.
"""

import json
import sys
import time

import mujoco
import numpy as np

beam = json.load(sys.stdin)
counts, sides = beam["counts"], beam["sides"]
spacing = [side / (count - 1) for side, count in zip(sides, counts)]
held = round(beam["held_m"] / spacing[0])
mass = beam["density_kg_m3"] * float(np.prod(sides))


# Elasticity is implicit with the integrator "discrete" (4.0); before, with "implicitfast".
def model(integrator):
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="1e-3" gravity="0 0 0" integrator="{integrator}" solver="CG" tolerance="1e-8" iterations="100"/>
  <size memory="512M"/>
  <worldbody>
    <flexcomp name="beam" type="grid" dim="3" count="{' '.join(map(str, counts))}"
              spacing="{' '.join(map(str, spacing))}" pos="{sides[0] / 2} 0 0" mass="{mass}" radius="1e-4">
      <contact selfcollide="none"/>
      <elasticity young="{beam['young_pa']}" poisson="{beam['poisson']}" damping="0"/>
      <pin gridrange="0 0 0 {held} {counts[1] - 1} {counts[2] - 1}"/>
    </flexcomp>
  </worldbody>
</mujoco>""")


try:
    m = model("discrete")
except ValueError:
    m = model("implicitfast")
d = mujoco.MjData(m)
mujoco.mj_forward(m, d)
rest = d.flexvert_xpos.copy()
ours, bent = np.array(beam["rest"]), np.array(beam["start"])
# Both are the same box, elsewhere.
shift = (rest.min(0) + rest.max(0) - ours.min(0) - ours.max(0)) / 2
ours, bent = ours + shift, bent + shift
nearest = np.argmin(((rest[:, None] - ours[None]) ** 2).sum(2), axis=1)
off = np.abs(ours[nearest] - rest).max()
if off > 1e-6:
    raise SystemExit(f"a node is {off} m from ours")
for vertex, body in enumerate(m.flex_vertbodyid):
    if m.body_jntnum[body] == 3:
        first = m.jnt_qposadr[m.body_jntadr[body]]
        d.qpos[first : first + 3] = bent[nearest[vertex]] - rest[vertex]
tip = rest[:, 0] > sides[0] - 1e-9
tips, times = [], []
for _ in range(beam["ticks"]):
    begun = time.perf_counter()
    mujoco.mj_step(m, d)
    times.append(time.perf_counter() - begun)
    # Where the nodes are after the step.
    mujoco.mj_kinematics(m, d)
    mujoco.mj_flex(m, d)
    tips.append(float((d.flexvert_xpos[tip, 2] - rest[tip, 2]).mean()))
print(json.dumps({"method": f"mujoco {mujoco.__version__} flex, CG", "tips_m": tips, "times_s": times}))
