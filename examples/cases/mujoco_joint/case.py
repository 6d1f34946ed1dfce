"""A rich simulator and a small model of a joint: which term does the small one lack?"""

import mujoco
import numpy as np

from stickslip import Cause, Parameter, Prior, Series, diagnose_model, instruments

model = mujoco.MjModel.from_xml_string("""
<mujoco>
  <option timestep="0.001" gravity="0 0 0" integrator="implicitfast"/>
  <worldbody>
    <body>
      <joint name="hinge" type="hinge" axis="0 0 1" damping="0.02" frictionloss="0.05"/>
      <geom type="box" size="0.1 0.1 0.02" mass="1.5"/>
    </body>
  </worldbody>
  <actuator><motor joint="hinge"/></actuator>
</mujoco>""")
data = mujoco.MjData(model)
t = 0.02 * np.arange(250)
torque = 0.08 * np.sin(2.5 * t) + 0.06 * np.sin(6.9 * t + 1.0)
exact = []
for each in torque:
    exact.append(data.qvel[0])
    data.ctrl[0] = each
    mujoco.mj_step(model, data, 20)
speed = exact + 0.02 * np.random.default_rng(0).standard_normal(len(t))


def joint(record, p):
    """Speed, rad/s, at the times of a record, shape (vectors, readings)."""
    torque, w = record["torque"], p["start"]
    angle, rows = 0.0, [w]
    for k, step in enumerate(np.diff(record.t)):
        kept = np.exp(-p["damping"] / p["inertia"] * step)
        gained = (1.0 - kept) / p["damping"]  # speed for a torque over the step
        pull = torque[..., [k]] - p["spring"] * angle - p["drag"] * w * np.abs(w)
        w = kept * w + gained * pull
        w = np.sign(w) * np.maximum(np.abs(w) - gained * p["dry"], 0.0)
        angle = angle + step * w
        rows.append(w)
    return np.hstack(rows)


def amplitude(name, unit, size, low=0.0):
    return Parameter(name, unit=unit, low=low, high=30 * size, size=size)


zero = amplitude("zero", "N m", 0.01, low=-0.3)
causes = [
    Cause("dry friction", amplitude("dry", "N m", 0.02)),
    Cause("quadratic drag", amplitude("drag", "N m s^2", 0.005)),
    Cause("spring", amplitude("spring", "N m/rad", 0.02)),
    Cause("torque offset", zero, read=lambda u, _, p, at: u + p["zero"], input="torque"),
    instruments.lag(0.02, input="torque", name="torque lag"),
    instruments.scale(name="speed scale"),
]
known = [
    Parameter("inertia", Prior("normal", 0.01, 0.0003), "kg m^2"),
    Parameter("damping", Prior("log-normal", 0.03, 1.5), "N m s/rad", cause=False),
    Parameter("start", Prior("normal", 0.0, 0.1), "rad/s", each_record=True),
]
record = Series(t, speed, {"torque": torque}, unit="rad/s")

result = diagnose_model(joint, record, known, causes)
print(result.verdict.kind, *result.verdict.causes)
found = result.params
for name in ("dry", "damping", "inertia"):
    value, unit = found.loc[name, ["value", "unit"]]
    print(f"{name}: {value:.3f} {unit}")
for name in ("none", "dry friction"):
    off = result.candidate(name).prediction.eval("reading - predicted")
    print(f"{name}: {np.sqrt(np.mean(off**2)):.2f} rad/s")

values = {"drag": 0.0, "spring": 0.0, **result.extended, "start": 0.0}
p = {name: np.array([[value]]) for name, value in values.items()}
rest = joint(record, p)[0, 1:] == 0.0
creep = np.median(np.array(exact)[1:][rest] / torque[:-1][rest])
print(f"creep: {creep:.1f} rad/s for 1 N m")
