"""Bad input to the design of drives, cameras, headings and environments.

Each row: a name, what is done with a folder, the type of the error, and words of its one line.
"""

import math

import gymnasium
import numpy as np

from stickslip import Drive, Scenario, ScenarioError, optimise, simulate
from stickslip._util.prior import Prior
from stickslip.control import Camera, Film, heading_voltages
from stickslip.control.environments import RobotEnv, RobotVectorEnv
from stickslip.scenario.waveform import drive_waveform

START = Scenario(drive=Drive(base=0.5e-3, pulses=6, ramp=0.02))
UNCERTAIN = START.with_uncertain({"contact.adhesion": {"mean": 0.22e-6, "sd": 0.03e-6}})
FREE = {"drive.frequency": (40.0, 160.0)}
VOLTS = {"voltage_max": 26.0}
PROGRAM = START.replace({"drive.mode": "program", "drive.program": drive_waveform(START)})


def design(scenario=START, **changes):
    """A search that is refused before it begins."""
    given = {"maximise": "mean_velocity", "free": FREE, "limits": VOLTS, **changes}
    return lambda _: optimise(scenario, **given)


def env(**options):
    return lambda _: RobotEnv(**options)


def path(corners):
    return env(task="follow", path=corners)


def act(action, **options):
    """An action of a robot that has begun."""

    def acted(_):
        env = RobotEnv(**options)
        env.reset(seed=1)
        env.step(action)

    return acted


ROWS = [
    # optimise
    ("goal", design(maximise="speed"), "mean_velocity"),
    ("no goal", design(maximise=None), "either maximise or minimise"),
    ("two goals", design(minimise="power_mean"), "either maximise or minimise"),
    ("nothing free", design(free=None), "nothing is free"),
    ("key", design(free={"drive.frequncy": (1, 2)}), 'did you mean "drive.frequency"'),
    ("list of keys", design(free=["drive.hold"]), "allowed is a Mapping, such as a dict"),
    ("list of limits", design(limits=["voltage_max"]), "limits = ['voltage_max']: allowed is a"),
    ("progress", design(progress="yes"), 'progress = "yes"'),
    ("range reversed", design(free={"drive.frequency": (100.0, 50.0)}), "low below high"),
    ("range beyond", design(free={"drive.frequency": (-1.0, 50.0)}), "drive.frequency = -1.0"),
    ("no range", design(free={"drive.frequency": 100.0}), "(low, high)"),
    ("whole number", design(free={"drive.pulses": (10, 20)}), "cannot be free"),
    ("solver", design(free={"solver.rtol": (1e-9, 1e-6)}), "cannot be free"),
    ("word", design(free={"drive.edge": ["rise", "drop"]}), "drop"),
    ("words", design(free={"drive.edge": "rise"}), "a list of words"),
    ("mode", design(free={"drive.mode": ["IPP", "program"]}), "knots"),
    ("limit", design(limits={"voltage": 3.0}), "voltage_max"),
    ("limit a word", design(limits={"voltage_max": "much"}), "allowed is a finite number"),
    ("limit infinite", design(limits={"voltage_max": np.inf}, knots=3), "a finite number"),
    ("score q0", design(score="q0"), '"q10"'),
    ("score", design(score="best"), '"q10"'),
    ("draws", design(draws=0), "draws = 0"),
    ("fresh", design(fresh=0), "fresh = 0"),
    ("evaluations", design(evaluations=2.5), "evaluations = 2.5"),
    ("seed", design(seed=-1), "seed = -1"),
    ("knots without limit", design(knots=12, limits={}), "voltage_max"),
    ("one knot", design(knots=1), "knots = 1"),
    ("coil", design(knots=4, coils=["zp"]), "zp"),
    ("coil twice", design(knots=4, coils=["xp", "xp"]), "each coil once"),
    ("peak of knots", design(knots=4, free={"drive.peak": (1e-3, 2e-3)}), "of no use with knots"),
    ("knots at a heading", design(START.replace({"drive.heading": 0.5}), knots=4), "drive.heading"),
    ("knots of a program", design(PROGRAM, free=None, knots=4), "period is not known"),
    ("uncertain", design(UNCERTAIN, free={"contact.adhesion": (0.0, 1e-6)}), "not both"),
    ("start", design(3), "allowed is a Scenario"),
    # cameras
    ("frame rate 0", lambda _: Camera(frame_rate=0.0), "camera.frame_rate"),
    ("frame rate a word", lambda _: Camera(frame_rate="x"), "a finite number from 0.001"),
    ("frame rate infinite", lambda _: Camera(frame_rate=math.inf), "camera.frame_rate = inf"),
    ("exposure", lambda _: Camera(frame_rate=100.0, exposure=0.1), "camera.exposure"),
    ("no exposure", lambda _: Camera(exposure=None), "to 0.0333333"),
    ("dropped", lambda _: Camera(dropped=2.0), "camera.dropped"),
    ("dropped nan", lambda _: Camera(dropped=math.nan), "from 0 to 1"),
    ("noise", lambda _: Camera(noise_heading=-1.0), "camera.noise_heading"),
    ("film's period", lambda _: Film(Camera(), 0, np.zeros(2)), "period = 0"),
    ("film's pose", lambda _: Film(Camera(), 1e-3, np.zeros(3)), "pose of shape (3,)"),
    ("film's camera", lambda _: Film(30, 1e-3, np.zeros(2)), "camera = 30"),
    # headings
    ("heading", lambda _: heading_voltages("north", 26, -10), "finite numbers of rad"),
    ("heading nan", lambda _: heading_voltages(math.nan, 26.0, -10.0), "heading = nan"),
    ("along", lambda _: heading_voltages(0.0, math.inf, -10.0), "along = inf"),
    ("clamp", lambda _: heading_voltages(0.0, 26.0, None), "clamp = None"),
    ("shapes", lambda _: heading_voltages(np.zeros(3), np.zeros(2), 0.0), "(3,), (2,), ()"),
    # environments
    ("task", env(task="raech"), 'did you mean "reach"'),
    ("env's camera", lambda _: gymnasium.make("stickslip/Walk-v0", camera=30), "camera = 30"),
    ("env's scenario", env(scenario="x.toml"), 'scenario = "x.toml"'),
    ("no robots", lambda _: RobotVectorEnv(0), "num_envs = 0"),
    ("foo", lambda _: RobotEnv(foo=1), "RobotVectorEnv: foo = 1: there is no such argument"),
    ("seeds", lambda _: RobotVectorEnv(2).reset(seed=[1, 2, 3]), "3 entries: allowed are 2"),
    ("seed below 0", lambda _: RobotVectorEnv(2).reset(seed=np.array([1, -1])), "seed = -1"),
    ("seed a fraction", lambda _: RobotVectorEnv(2).reset(seed=1.5), "seed = 1.5"),
    ("seed of one", lambda _: RobotEnv().reset(seed=-1), "seed = -1"),
    *(("reset_mask", lambda _, mask=mask: RobotVectorEnv(2).reset(options={"reset_mask": mask}),
       "2 booleans") for mask in ([1, 0], np.array([1, 0], np.uint8), [0.0, 1.0], [True], None,
                                  [[True, False]])),
    ("coils", env(coils=["zp"]), "coils"),
    ("coils a word", env(coils="xp"), 'coils = "xp"'),
    ("coils a number", env(coils=5), "coils = 5"),
    ("coils twice", env(coils=("xp", "xp")), "each coil once"),
    ("no clamp", env(task="follow", coils=("xp", "yp")), '"clamp" and one'),
    ("path of reach", env(task="reach", path=[(0, 0), (1, 0)]), 'the task "reach" follows none'),
    ("path away", act([0, 0, 0], task="follow", path=[(5e-3, 0), (6e-3, 0)]), "begins 5 mm"),
    ("path beyond", path([(0, 0), (2, 0)]), "path: (2, 0) m lies beyond the coils' field: "),
    ("path a word", path("L"), 'path = "L": allowed is shape (k, 2)'),
    ("path of numbers", path([1.0, 2.0, 3.0]), "path of shape (3,)"),
    ("path of two numbers by name", path({"x": 1e-3, "y": 2e-3}), "of shape (2,)"),
    ("one corner", path([(0.0, 0.0)]), "path of shape (1, 2)"),
    ("corner nan", path([(0.0, 0.0), (math.nan, 0.0)]), "finite"),
    ("ragged path", path([(0.0, 0.0), (1.0,)]), "allowed is shape"),
    ("corner twice", path([(0.0, 0.0), (0.0, 0.0)]), "corner 1 is where"),
    ("goal beyond", env(task="reach", goal=(0.0, 1.0)), "goal: (0, 1) m lies beyond"),
    ("goal nan", env(task="reach", goal=(math.nan, 0.0)), "allowed is x and y"),
    ("goal of three", env(task="reach", goal=(0, 0, 0)), "of shape (3,): allowed is shape (2,)"),
    ("goal of walk", env(goal=(1e-3, 0.0)), 'goal: the task "walk" takes none'),
    ("turning", env(turning=-3), "turning = -3: allowed is a finite number of rad/s above 0"),
    ("voltage", env(voltage=math.nan), "voltage = nan"),
    ("period 0", env(period=0), "period = 0: allowed is a finite number of s above 0"),
    ("period a word", env(period="x"), 'period = "x"'),
    ("render mode", env(render_mode="rgb_array"), "there is no such argument"),
    ("steps", env(max_episode_steps=-1), "max_episode_steps = -1: allowed is a whole"),
    ("prior", env(uncertain={"robot.mass": Prior("normal", 1e3, 1.0)}), "robot.mass"),
    ("y in one plane", lambda _: simulate(START, until="y >= 1e-3"), "plane y = 0"),
    ("heading in one plane", lambda _: simulate(START, until="heading <= -0.5"), "plane y = 0"),
    ("goals by name", env(task="reach", goal={"x": [1e-3, 0.0], "y": 0.0}),
     "of shape (2, 2): allowed is shape (2,), x, y"),
    ("action nan", act([0.5, math.nan]), "action: row 1 = nan: allowed is shape (2,)"),
    ("action infinite", act([-math.inf, 0.5, 0.5], task="reach"), "allowed is shape (3,)"),
    ("action too short", act([0.5]), "of shape (1,): allowed is shape (2,)"),
    ("action of two", act(np.zeros((2, 2))), "of shape (2, 2): allowed is shape (2,)"),
    ("action a word", act("left"), 'action = "left": allowed is shape (2,)'),
    ("action masked", act(np.ma.array([0.5, 0.5], mask=[False, True])), "action: row 1 = nan"),
    ("no action", act(None), "allowed is shape (2,)"),
    ("action ragged", act([[0.0], [0.0, 1.0]]), "allowed is shape (2,)"),
]  # fmt: skip
REFUSALS = [(name, done, ScenarioError, words) for name, done, words in ROWS]
