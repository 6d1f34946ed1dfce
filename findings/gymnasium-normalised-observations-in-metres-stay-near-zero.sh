#!/usr/bin/env bash
# Expected: `NormalizeObservation` gives observations of mean 0 and deviation 1, whatever their unit.
# What happens: 1e-8 is added to the running variance, and that begins at 1 with a weight of 1e-4. Positions in metres
#   that vary by 20 um come out with a deviation below 0.2, of 1 um with a hundredth: the policy sees almost zeros, and
#   no warning tells.
# Package: gymnasium 1.4.0. Source: `epsilon` is documented, what it costs is not; found by trying. A smaller one does
#   not help.
# Who is hurt: whoever trains on a small robot in SI units.
# Instead: scale observations to about 1 first, as with TransformObservation (tried).
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet --disable-pip-version-check \
    numpy==2.4.6 gymnasium==1.4.0 cloudpickle==3.1.2 Farama-Notifications==0.0.6
cd "$folder"
"$folder/venv/bin/python" - <<'PROGRAM'
import warnings

import gymnasium as gym
import numpy as np
from gymnasium.wrappers import NormalizeObservation, TransformObservation

warnings.simplefilter("error")


class Robot(gym.Env):
    """A position that varies by `scale`, in metres."""

    action_space = gym.spaces.Discrete(2)
    observation_space = gym.spaces.Box(-np.inf, np.inf, (1,), np.float64)

    def __init__(self, scale):
        self.scale = scale

    def reset(self, *, seed=None, options=None):
        super().reset(seed=seed)
        return self.scale * self.np_random.normal(size=1), {}

    def step(self, action):
        return self.scale * self.np_random.normal(size=1), 0.0, False, False, {}


def deviation(env):
    env.reset(seed=0)
    return float(np.std([env.step(0)[0] for _ in range(6000)][1000:]))


print("gymnasium", gym.__version__, "numpy", np.__version__)
for scale, bound in ((1.0, None), (1e-4, 0.8), (2e-5, 0.2), (1e-6, 0.02)):
    seen = deviation(NormalizeObservation(Robot(scale)))
    print(f"position that varies by {scale * 1e6:g} um: deviation {seen:.4f} after NormalizeObservation")
    assert abs(seen - 1.0) < 0.05 if bound is None else seen < bound
    # instead
    robot = Robot(scale)
    by_unit = TransformObservation(robot, lambda x, s=scale: x / s, robot.observation_space)
    assert abs(deviation(NormalizeObservation(by_unit)) - 1.0) < 0.05
    assert deviation(NormalizeObservation(robot, epsilon=1e-20)) < 0.05 or scale > 1e-6
PROGRAM
