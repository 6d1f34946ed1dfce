"""The reference problem with MuJoCo: a box on a plane, a fixed time step and soft contact.

Millimetres, milligrams and milliseconds. Linear drag is MuJoCo's joint damping; the magnetic
wrench and the quadratic drag are applied before each step. MuJoCo knows one friction coefficient a
contact, so that is set before each step: static below a slip speed, kinetic above.

Adhesion is applied by hand with them, as a pull that lasts up to a small gap. MuJoCo's adhesion
actuator is not used: a corner that is lifted for one step loses its pull there, so that it leaves
some 1300 times instead of 21, and smaller steps do not help.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import mujoco

from peers.problem import KINETIC_FRICTION, PULSES, STATIC_FRICTION, Problem, mean_velocity

UNITS = {"length": 1e3, "mass": 1e6, "time": 1e3}  # mm, mg, ms
TILTED = 1e-5  # rad, from where on the body stands on an edge


@dataclass(frozen=True)
class Settings:
    """Settings that a user of MuJoCo can choose.

    timestep: ms. stiffness_time: time constant of the contact (solref), in time steps.
    damping_ratio: of the contact (solref). impedance: solimp, the same at any depth.
    friction_impedance: impratio. stick_speed: below it friction is static, mm/ms.
    release_gap: up to it a corner is pulled, mm; only one that has touched.
    """

    timestep: float
    stiffness_time: float
    damping_ratio: float
    impedance: float
    friction_impedance: float
    stick_speed: float
    release_gap: float


QUICK = Settings(0.04, 3.0, 1.0, 0.9, 100.0, 2.25e-5, 2.96e-5)
ACCURATE = Settings(0.01, 6.0, 4.0, 0.99, 10.0, 2.44e-5, 4.96e-6)


def model_of(problem: Problem, settings: Settings) -> mujoco.MjModel:
    """MuJoCo's model of the body in `problem`, which is in mm, mg and ms."""
    body = problem.body
    a, w, b = body.half_length, body.half_width, body.half_height
    d = settings.impedance
    inertia = " ".join([repr(body.inertia)] * 3)
    return mujoco.MjModel.from_xml_string(f"""
<mujoco>
  <option timestep="{settings.timestep}" integrator="Euler" cone="elliptic" solver="Newton"
      tolerance="1e-12" impratio="{settings.friction_impedance}"
      gravity="0 0 {-body.weight / body.mass!r}"/>
  <default>
    <geom condim="3" friction="{STATIC_FRICTION} 0 0" solimp="{d} {d} 0.001 0.5 2"
        solref="{settings.stiffness_time * settings.timestep!r} {settings.damping_ratio}"/>
  </default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body pos="0 0 {b!r}">
      <joint type="slide" axis="1 0 0" damping="{body.linear_drag!r}"/>
      <joint type="slide" axis="0 0 1" damping="{body.linear_drag!r}"/>
      <joint type="hinge" axis="0 1 0"/>
      <inertial pos="0 0 0" mass="{body.mass!r}" diaginertia="{inertia}"/>
      <geom name="body" type="box" size="{a!r} {w!r} {b!r}"/>
    </body>
  </worldbody>
</mujoco>""")


def simulate(problem: Problem, settings: Settings) -> float:
    """Mean velocity of the centre of mass, m/s."""
    problem = problem.scaled(**UNITS)
    body = problem.body
    model = model_of(problem, settings)
    data = mujoco.MjData(model)
    step, friction = settings.timestep, model.geom_friction
    position, velocity, applied = data.qpos, data.qvel, data.qfrc_applied
    a, b, twist = body.half_length, body.half_height, body.quadratic_drag
    cx, cz = problem.centre
    cz -= b  # the slide joints count from the position at rest
    rate = -1.0 / problem.time_constant
    exp, cos, sin = math.exp, math.cos, math.sin
    path = []
    touches = True
    count = 0
    for segment in problem.segments:
        terms = list(zip(*(segment.current.T @ problem.field).tolist(), strict=True))
        last = round(segment.end / step)
        start = segment.start
        while count < last:
            tau = count * step - start
            e = exp(rate * tau)
            bx, bz, gxx, gxz, gzz, xxx, xxz, xzz, zzz = [p + q * tau + r * e for p, q, r in terms]
            x, z, theta = position.tolist()
            vx, _, omega = velocity.tolist()
            dx, dz = x - cx, z - cz
            c, s = cos(theta), sin(theta)
            nxx, nxz = gxx + xxx * dx + xxz * dz, gxz + xxz * dx + xzz * dz
            nzz = gzz + xzz * dx + zzz * dz
            field_x = bx + 0.5 * ((gxx + nxx) * dx + (gxz + nxz) * dz)
            field_z = bz + 0.5 * ((gxz + nxz) * dx + (gzz + nzz) * dz)
            height = a * s + b * c
            gap = z + b - height
            touches = gap <= (settings.release_gap if touches else 0.0)
            pull = body.adhesion if touches else 0.0
            lever = a * c - b * s if theta > TILTED else 0.0
            applied[:] = (
                c * nxx - s * nxz,
                c * nxz - s * nzz - pull,
                -s * field_x - c * field_z - twist * omega * abs(omega) + lever * pull,
            )
            slides = abs(vx - omega * height) > settings.stick_speed
            friction[:, 0] = KINETIC_FRICTION if slides else STATIC_FRICTION
            mujoco.mj_step(model, data)
            count += 1
        path.append(float(position[0]))
    return mean_velocity(problem, path[-PULSES:]) * UNITS["time"] / UNITS["length"]


def creep(problem: Problem, settings: Settings, share: float, seconds: float) -> float:
    """Drift in m of the flat block, pushed with `share` of its friction limit for `seconds`."""
    body = problem.scaled(**UNITS).body
    model = model_of(problem.scaled(**UNITS), settings)
    data = mujoco.MjData(model)
    data.qfrc_applied[0] = share * STATIC_FRICTION * (body.weight + body.adhesion)
    data.qfrc_applied[1] = -body.adhesion
    mujoco.mj_step(model, data, round(seconds * UNITS["time"] / settings.timestep))
    return float(data.qpos[0]) / UNITS["length"]
