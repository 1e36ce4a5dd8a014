"""Free rigid bodies of `palpate bench contact` in MuJoCo.

    python rigid.py < case.json

`case.json` has `dt_s`, `radius_m` and `height_m` of pucks, `ball_m`, and a `setup`: `things` (`shape`, `place_m`,
`density_kg_m3`, `velocity_m_s`, `spin_rad_s`), `gravity_m_s2`, `mu`, `restitution`, `floor` and `ticks`. Prints a list of
runs, one for each setting of contacts: its `method`, and `frames` with the time of each step and the bodies after it.
"""

import json
import sys
import time

import mujoco
import numpy as np

case = json.load(sys.stdin)
setup = case["setup"]
things = setup["things"]
dt = case["dt_s"]


def words(numbers):
    return " ".join(repr(x) for x in numbers)


def body(thing):
    x, y, z = thing["place_m"]
    if thing["shape"] == "puck":
        half = case["height_m"] / 2
        z, shape = z + half, f'type="cylinder" size="{case["radius_m"]} {half}"'
    else:
        shape = f'type="sphere" size="{case["ball_m"]}"'
    return (f'<body pos="{words([x, y, z])}"><freejoint/>'
            f'<geom {shape} density="{thing["density_kg_m3"]}"/></body>')


def model(options, contacts):
    floor = '<geom type="plane" size="1 1 1"/>' if setup["floor"] else ""
    condim = 3 if setup["mu"] > 0 else 1
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{dt}" gravity="{words(setup["gravity_m_s2"])}" {options}>
    <flag multiccd="enable" sleep="enable"/>
  </option>
  <default><geom condim="{condim}" friction="{setup["mu"]} 0 0" {contacts}/></default>
  <worldbody>{floor}{"".join(body(thing) for thing in things)}</worldbody>
</mujoco>""")


def motion(d, k):
    place, speed = d.qpos[7 * k : 7 * k + 7], d.qvel[6 * k : 6 * k + 6]
    turn = np.zeros(9)
    mujoco.mju_quat2Mat(turn, place[3:])
    turn = turn.reshape(3, 3)
    return {"centre_m": place[:3].tolist(), "velocity_m_s": speed[:3].tolist(),
            "spin_rad_s": (turn @ speed[3:]).tolist(), "axis": turn[:, 2].tolist()}


def frames(m):
    d = mujoco.MjData(m)
    for k, thing in enumerate(things):
        d.qvel[6 * k : 6 * k + 6] = thing["velocity_m_s"] + thing["spin_rad_s"]
    for _ in range(setup["ticks"]):
        begun = time.perf_counter()
        mujoco.mj_step(m, d)
        took = time.perf_counter() - begun
        yield {"took_s": took, "asleep": bool((d.tree_asleep >= 0).all()),
               "bodies": [motion(d, k) for k in range(len(things))]}


# Contacts as stiff as a step allows.
stiff = f'solref="{2 * dt} 1" solimp="0.99 0.999 0.0001"'
if setup["restitution"] > 0:
    # Springs without damping, a tenth of a radian a tick; as soft as this each contact is a spring of its own.
    springs = f'solref="{-100 * (0.1 / dt) ** 2} 0" solimp="0.01 0.01 0.0001"'
    settings = [("springs", "", springs)]
else:
    settings = [("its own softness", "", ""), ("stiff, elliptic", 'cone="elliptic" impratio="10"', stiff)]
runs = [{"method": f"mujoco {mujoco.__version__}, {name}", "frames": list(frames(model(options, contacts)))}
        for name, options, contacts in settings]
print(json.dumps(runs))
