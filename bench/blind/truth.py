"""What is hidden in each data set of the study, drawn at random.

The forms differ from the library's where the reference simulator has others: friction falls as
1/(1 + (v/vs)^2) and drag goes with |cos theta|. The true constants come from the priors.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

KINDS = (
    "none",
    "none, hard",
    "constant 3 sd",
    "constant 5 sd",
    "single",
    "weak",
    "near twins",
    "exact twins",
    "pair",
    "unknown",
    "shuffled",
)

Drive = dict[str, float | str]

# Size of each cause that is a strong one, before it is scaled to the wanted signal to noise.
_SIZES = {
    "surface_tilt": {"angle": 0.01},
    "ambient_field": {"Bx": 5e-5},
    "misalignment": {"angle": 0.04},
    "stribeck_friction": {"speed": 8e-3, "form": "rational"},
    "angle_drag": {"amplitude": 3.0, "power": 1},
    "rotational_drag": {"coefficient": 2e-14},
    "eddy_lag": {"time": 3e-4},
    "edge_time": {"time": 5e-4},
    "field_gain": {"clamp": 0.05},
    "restitution": {"coefficient": 0.2},
}
SINGLES = tuple(_SIZES)
_TWO_SIDED = ("surface_tilt", "ambient_field", "misalignment", "field_gain")
_LARGEST = {
    "stribeck_friction": 0.04, "angle_drag": 20.0, "rotational_drag": 3e-13, "eddy_lag": 2.5e-3,
    "edge_time": 3e-3, "restitution": 0.5,
}  # fmt: skip


@dataclass(frozen=True)
class Truth:
    """What is behind one data set.

    Attributes
    ----------
    kind : str
    answer : tuple of str
        Names in the library's words; empty where nothing of the library is hidden.
    constants : dict
        Of the reference simulator, SI units.
    effects : dict
        Its effects, and ``edge_time`` and ``field_gain``, which change the drive.
    length_scale : float
        Part by which lengths are read too large.
    ripple : tuple of float
        Amplitude, period in the logarithm of the frequency, phase of a factor that no cause has.
    """

    kind: str
    answer: tuple[str, ...]
    constants: dict[str, float]
    effects: dict[str, dict[str, float | str]] = field(default_factory=dict)
    length_scale: float = 0.0
    ripple: tuple[float, float, float] = (0.0, 1.0, 0.0)

    def without(self) -> Truth:
        """The same robot with nothing hidden."""
        return replace(self, effects={}, length_scale=0.0, ripple=(0.0, 1.0, 0.0))

    def scaled(self, factor: float) -> Truth:
        """The same with every hidden thing larger by a factor, as far as it can be."""
        effects = {name: _scaled(name, each, factor) for name, each in self.effects.items()}
        amplitude, *shape = self.ripple
        return replace(
            self,
            effects=effects,
            length_scale=float(np.clip(self.length_scale * factor, -0.3, 0.4)),
            ripple=(float(np.clip(amplitude * factor, 0.0, 0.9)), shape[0], shape[1]),
        )


def _scaled(name: str, parameters: dict[str, float | str], factor: float) -> dict[str, float | str]:
    largest = _LARGEST.get(name, np.inf)
    result = dict(parameters)
    for key, value in parameters.items():
        if key not in ("form", "power"):
            assert not isinstance(value, str)
            result[key] = float(np.clip(value * factor, -largest, largest))
    return result


def conditions(kind: str) -> list[Drive]:
    """Settings of the drive: 30 that vary all its fields; near twins from one mode, one way alone.

    Causes of one field are alike where the other one is always the same, so the hold varies too.
    """
    rows: list[Drive] = []
    modes = ("OPP",) if kind == "near twins" else ("IPP", "OPP")
    for mode in modes:
        usual: Drive = {
            "mode": mode, "base": 0.5e-3, "hold": 1.0e-3, "direction": "+x", "peak": 2.5e-3
        }  # fmt: skip
        paces = (20.0, 30.0, 40.0, 50.0, 65.0, 80.0, 100.0, 120.0)
        if kind == "near twins":
            rows += [{**usual, "frequency": pace} for pace in paces]
            rows += [{**usual, "frequency": pace, "peak": 2.0e-3} for pace in paces[::2]]
            rows += [{**usual, "frequency": 45.0, "peak": peak} for peak in (1.5e-3, 2e-3, 3e-3)]
            continue
        rows += [{**usual, "frequency": pace} for pace in (20.0, 30.0, 45.0, 65.0, 90.0, 120.0)]
        rows += [{**usual, "frequency": 45.0, "peak": peak} for peak in (1.5e-3, 2e-3, 3e-3)]
        rows += [{**usual, "frequency": 55.0, "hold": hold} for hold in (0.6e-3, 1.8e-3)]
        rows += [{**usual, "frequency": 75.0, "base": 0.9e-3}]
        back = {**usual, "direction": "-x"}
        rows += [{**back, "frequency": pace} for pace in (25.0, 50.0, 110.0)]
    return rows


def draw(kind: str, random: np.random.Generator) -> Truth:
    """The truth of a data set, its hidden effects at a usual size."""
    constants = {
        "kinetic_friction": min(0.145 + 0.01 * random.standard_normal(), 0.199),
        "adhesion": max(0.22e-6 + 0.03e-6 * random.standard_normal(), 0.0),
        "linear": float(np.exp(random.uniform(np.log(1e-6), np.log(1e-4)))),
        "rotational": 9e-17 * 2.0 ** random.standard_normal(),
    }
    answer: tuple[str, ...] = ()
    if kind.startswith("constant"):
        name = str(random.choice(["kinetic_friction", "adhesion"]))
        mean, sd = (0.145, 0.01) if name == "kinetic_friction" else (0.22e-6, 0.03e-6)
        # A static friction of 0.2 leaves kinetic friction room to one side only.
        sign = -1.0 if name == "kinetic_friction" else float(random.choice([-1.0, 1.0]))
        constants[name] = mean + float(kind.split()[1]) * sign * sd
        answer = (f"contact.{name}",)
    elif kind in ("single", "weak", "shuffled"):
        answer = (str(random.choice(SINGLES)),)
    elif kind == "pair":
        answer = tuple(str(each) for each in random.choice(SINGLES, 2, replace=False))
    elif kind == "near twins":
        answer = ("surface_tilt",)
    elif kind == "exact twins":
        answer = ("length_scale",)
    truth = Truth(kind, answer, constants)
    effects = {name: _effect(name, random) for name in answer if name in _SIZES}
    if kind == "exact twins":
        return replace(truth, length_scale=float(random.choice([-0.1, 0.1])))
    if kind == "unknown":
        wave = (0.1, float(random.uniform(0.35, 0.6)), float(random.uniform(0, 2 * np.pi)))
        return replace(truth, ripple=wave)
    return replace(truth, effects=effects)


def _effect(name: str, random: np.random.Generator) -> dict[str, float | str]:
    sizes: dict[str, float | str] = dict(_SIZES[name])
    if name == "ambient_field" and random.random() < 0.5:
        sizes = {"Bz": 5e-5}
    if name == "field_gain" and random.random() < 0.5:
        sizes = {"in_plane": 0.05}
    sign = float(random.choice([-1.0, 1.0])) if name in _TWO_SIDED else 1.0
    sign *= float(np.exp(random.uniform(-0.7, 0.7)))
    return {
        key: value if isinstance(value, str) or key == "power" else sign * value
        for key, value in sizes.items()
    }
