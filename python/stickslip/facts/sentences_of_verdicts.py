"""Sentences on what was found: verdicts, experiments, and what the misfit looks like."""

from __future__ import annotations

import math
from collections.abc import Mapping

from stickslip.facts.codes import Code
from stickslip.facts.sentences_of_data import Fields, Sentence, listed

_TORQUE = {
    "constant": "It is constant, as from the gain of a coil, an ambient field or a turned moment.",
    "theta": "It goes with the tilt, as from the strength or direction of moment and field.",
    "rate": "It goes with the rate of the tilt, as from drag on turning or a field that lags.",
}
_FORCE = {
    "constant": "It is constant, as from a tilted surface, an ambient gradient or other friction.",
    "theta": "It goes with the tilt, as from adhesion or drag that depends on the angle.",
    "rate": "It goes with the rate of the tilt, as from another normal force.",
    "contact velocity": "It goes with the contact's velocity, as from drag or viscous friction.",
}


def _candidate(name: str) -> str:
    return "no cause at all" if name == "none" else name


def _named(template: str) -> Sentence:
    """Of a candidate `name`, which may be the model without a cause."""
    return lambda f: template.format(**{**f, "name": _candidate(f["name"])})


def _among(template: str, key: str = "causes") -> Sentence:
    return lambda f: template.format(**{**f, key: listed(f[key])})


def _look(template: str) -> Sentence:
    return lambda f: template.format(
        **{**f, "seen": listed(f["seen"]), "unseen": listed(f["unseen"])}
    )


def _uneven(f: Fields) -> str:
    said = [
        f"in {each['part']} ({each['misfit']:.1f}, against {each['misfit_of_other']:.1f} in "
        f"{each['other']})"
        for each in f["parts"]
    ]
    return f"The misfit of the recalibrated model per condition is larger {' and '.join(said)}."


def _mixed(f: Fields) -> str:
    said = [f"{how} in {listed(f[how])}" for how in ("faster", "slower") if f[how]]
    return _velocities(" and ".join(said))


def _velocities(how: str) -> str:
    return f"With this cause and the same constants, the velocities are {how}."


def _models(f: Fields, form: str, factor: float, unit: str) -> str:
    """Errors of both models."""
    said = f"by {f['recalibrated'] * factor:{form}} {unit}"
    if f["extended"] is not None:
        said += f", and the extended model by {f['extended'] * factor:{form}} {unit}"
    return said


def _advance(f: Fields) -> str:
    measured, sd, model = (f[key] * 1e6 for key in ("measured", "sd", "recalibrated"))
    said = (
        f"A pulse moves the robot by {measured:.5g} ± {sd:.1g} um, and the recalibrated model by "
        f"{model:.5g} um"
    )
    extended = f["extended"]
    return f"{said}." if extended is None else f"{said}; with the cause {extended * 1e6:.5g} um."


def _clean(f: Fields) -> str:
    return f"{f['value']:+.2g} ± {f['sd']:.1g} {f['unit']}"


def _residual(f: Fields, meanings: Mapping[str, str]) -> str:
    what = "in the mean"
    if f["variable"] != "constant":
        what = f"for one standard deviation of the {f['variable']}"
    return f"{f['value']:+.2g} {f['unit']} {what} (t = {f['t']:.1f}). {meanings[f['variable']]}"


def _onset(said: str) -> str:
    return (
        "Just before the contact begins to slip, friction over normal force differs from that of "
        f"the recalibrated model, smoothed alike, by {{difference:+.2g}} ± {{sd:.1g}}: {said}."
    )


_DRIFTS = "Beyond the simulation's own drift, the {} changes by {{value:.2g}} ± {{sd:.1g}} {} each "

_STAGE = (
    "Tilt the stage by about 2 degrees one way and the other: the velocities change alike "
    "about a surface that was level, which tells {seen} from {unseen}."
)

SENTENCES: Mapping[Code, Sentence] = {
    Code.NOTHING_DETECTED: (
        "Both tests pass (p = {p_value:.2g}; something is there below {level:g})."
    ),
    Code.RUNNER_UP: _named("The runner-up, {name}, is behind by {lead:.1f} in log-evidence."),
    Code.OTHER_LEADS: _named(
        "Another candidate leads: {name} is ahead by {lead:.1f} in log-evidence."
    ),
    Code.OTHER_LEADS_UNEXPLAINED: _named(
        "Another candidate, {name}, is ahead by {lead:.1f} in log-evidence, but does not explain "
        "the data (p below {level:g})."
    ),
    Code.NEAREST: (
        "The candidate {name} comes nearest; it leaves a chi-square of {chi2:.0f} for "
        "{observables} observables, and the recalibrated model {recalibrated:.0f}."
    ),
    Code.ALIKE: _among(
        "The effects of {causes} on these data are alike once the model is recalibrated (cosine "
        "above {limit:g})."
    ),
    Code.NOT_SEPARATED: _among(
        "The evidence does not separate {causes}: a lead of {margin:g} in log-evidence is needed."
    ),
    Code.SEVERAL_PAIRS: lambda f: (
        f"{f['count']} pairs explain the data about as well (within {f['margin']:g} in "
        f"log-evidence): {listed(f['pairs'])}."
    ),
    Code.LITTLE_EVIDENCE: _named(
        "The log-evidence of {name} is {lead:.1f} above that of no cause, and {margin:g} is needed."
    ),
    Code.STARTS_DISAGREE: "Fits of {name} from different starts do not agree.",
    Code.NOT_PREDICTED_BETTER: (
        "With {name}, conditions that are left out are not predicted better than without it."
    ),
    Code.AT_LIMIT: "An amplitude of {name} is at the end of its physical range.",
    Code.TABLE_CONTRADICTS: (
        "The tables of kind {kind} contradict {name}: with it, their own misfit has a p-value "
        "below {level:.2g}."
    ),
    Code.TRAINING_SUBSET: _named("Without the held-out conditions {name} would lead."),
    Code.SMOOTH_REST: (
        "The candidate {name} takes {percent:.0f} % of what a smooth function of the settings "
        "would take from the misfit; {needed:.0f} % is needed."
    ),
    Code.NO_EXPLANATION: (
        "No single cause and no pair brings the misfit down to the noise (p of at least {level:g})."
    ),
    Code.LESS_LIKELY: _named(
        "One candidate, {explaining}, brings the misfit down to the noise, but is less likely than "
        "{name}, which does not."
    ),
    Code.PAIR_LEADS_TOO_LITTLE: (
        "No single cause explains the data, and the pair {name} leads by {lead:.1f} in "
        "log-evidence; {needed:g} is needed for a pair."
    ),
    Code.PAIR_NEEDED: "No single cause explains the data as well as the pair {name}.",
    Code.SEPARATES: (
        "It separates {first} from {second}: with {trials} trials a chi-square of {chi2:.1f} is "
        "expected, and one of {needed:g} is enough."
    ),
    Code.SEPARATES_TOO_LITTLE: (
        "It separates {first} from {second} too little: with {trials} trials a chi-square "
        "of {chi2:.1f} is expected, and one of {needed:g} is needed."
    ),
    Code.NONE_SEPARATES: (
        "No drive that was tried would tell the leading candidates apart with {trials} trials; "
        "here is the best of them."
    ),
    Code.LOOK_AT_CURRENTS: _look(
        "Log the coil currents: they show {seen} directly, and nothing of {unseen}."
    ),
    Code.LOOK_AT_FIELD: _look(
        "Measure the field at the robot for known currents: it shows {seen}, and nothing of "
        "{unseen}."
    ),
    Code.LOOK_AT_TILT: _look(_STAGE),
    Code.LOOK_AT_SCALE: _look("Film a scale: it shows {seen}, and nothing of {unseen}."),
    Code.LOOK_AT_CLOCK: _look("Film a clock: it shows {seen}, and nothing of {unseen}."),
    Code.LOOK_AT_REST: _look(
        "Film the robot flat on the surface without a field: that shows {seen}, and nothing of "
        "{unseen}."
    ),
    Code.LOOK_AT_STATIC_TILT: _look(
        "Read the static tilt in held fields: it shows {seen}, and nothing of {unseen}."
    ),
    Code.MISFIT_EVEN: (
        "The misfit of the recalibrated model per condition is about the same in all parts (none "
        "has {contrast:g} times that of its counterpart)."
    ),
    Code.MISFIT_UNEVEN: _uneven,
    Code.VELOCITIES_UNCHANGED: _velocities("hardly changed"),
    Code.VELOCITIES_FASTER: _velocities("faster throughout"),
    Code.VELOCITIES_SLOWER: _velocities("slower throughout"),
    Code.VELOCITIES_SHIFTED: _velocities("shifted towards {direction} throughout"),
    Code.VELOCITIES_MIXED: _mixed,
    Code.CONSTANT_CHANGES: (
        "The constant {name} differs between {first} and {second} by {gap:.1f} standard "
        "deviations, more than {limit:g}."
    ),
    Code.TRADE_OFF: _among(
        "Near the recalibrated model {names} trade off: they can change together without a change "
        "of what was measured.",
        "names",
    ),
    Code.LITTLE_KNOWN: "Near the recalibrated model the data say little about {name}.",
    Code.ANGLE_MISFIT: lambda f: (
        "The recalibrated model misses these angles "
        f"{_models(f, '.2f', math.degrees(1.0), 'degrees')} (root mean square)."
    ),
    Code.ANGLE_MODEL: (
        "An angle of a model is that at which the magnetic torque and the weight about the corner "
        "it pivots on cancel, after the field was raised from zero."
    ),
    Code.NO_ANGLE_WITHOUT_FIELD: (
        "No angle was read without field: none below {percent:g} % of the strongest. One such "
        "reading tells an offset of the camera, which is there too, from what tilts the robot."
    ),
    Code.FIELD_MISFIT: lambda f: (
        f"The recalibrated model misses these fields {_models(f, '.3g', 1e6, 'uT')} (root mean "
        f"square); the largest component is {f['largest'] * 1e3:.3g} mT."
    ),
    Code.NO_FORCE_VIEW: (
        "No forces are shown: the drive has no phase to fold on, the frames are too few, or the "
        "recalibrated model does not simulate."
    ),
    Code.ADVANCE: _advance,
    Code.TOO_FEW_PHASES: (
        "The film shows {phases} different phases of the drive, enough for {orders} of its "
        "harmonics; rates and forces need {needed}, so none are given. More frames a second, or a "
        "rate that is no simple multiple of the drive's, would show more."
    ),
    Code.TORQUE_NOT_JUDGED: (
        "The contact never sticks for long enough to judge the torque about it."
    ),
    Code.TORQUE_CLEAN: lambda f: (
        f"The torque residual while sticking is consistent with zero, {_clean(f)}: at "
        f"most {f['hidden']:.1%} of the field's largest torque could be hidden, so currents, field "
        "and moment are as in the model."
    ),
    Code.TORQUE_RESIDUAL: lambda f: (
        f"The torque residual while sticking is {_residual(f, _TORQUE)}"
    ),
    Code.FORCE_NOT_JUDGED: (
        "The contact never slips for long enough to judge the force along the surface."
    ),
    Code.FORCE_CLEAN: lambda f: (
        f"The force residual while slipping is consistent with zero, {_clean(f)}: at "
        f"most {f['hidden']:.1%} of weight and adhesion could be hidden."
    ),
    Code.FORCE_RESIDUAL: lambda f: f"The force residual while slipping is {_residual(f, _FORCE)}",
    Code.ONSET_SAME: _onset("no difference that can be seen"),
    Code.ONSET_DIFFERS: _onset("a clear difference"),
    Code.NO_DRIFT_OF_PERIODS: (
        "From period to period nothing drifts that does not drift in the simulation."
    ),
    Code.DRIFT_OF_TILT: _DRIFTS.format("tilt", "rad") + "period.",
    Code.DRIFT_OF_ADVANCE: _DRIFTS.format("advance", "m") + "period.",
    Code.FORCE_WITH_CAUSE: (
        "With the cause the mean force residual goes from t = {before:.1f} to {after:.1f}."
    ),
    Code.DIRECTIONS_TOO_SHORT: (
        "One of the two films is too short to show the advance of a pulse."
    ),
    Code.DIRECTIONS_CANCEL: (
        "The advances of a pulse, {forward:.4g} m and {reverse:.4g} m, are equal and opposite "
        "within their errors (t = {t:.1f})."
    ),
    Code.DIRECTIONS_DIFFER: (
        "The advances of a pulse, {forward:.4g} m and {reverse:.4g} m, do not cancel: {total:.2g} "
        "m is left (t = {t:.1f}), so something is fixed to the world: tilt, an ambient field, or "
        "the surface."
    ),
    Code.FORCES_OF_DIRECTIONS: (
        "Of the force residuals while slipping, {world:.2g} ± {sd:.1g} N is fixed to the world "
        "(along +x) and {robot:.2g} ± {sd:.1g} N turns with the robot."
    ),
}
