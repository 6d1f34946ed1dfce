// What the page shows of a scenario: settings, examples and effects. Values are in SI units; a
// setting shows them over its `scale`.

const START = { "drive.frequency": 30, "drive.peak": 1.5e-3, "drive.base": 0.5e-3, "drive.pulses": 20 };

const DEGREE = Math.PI / 180;

function slider(key, label, unit, scale, min, max, step) {
  return { key, label, unit, scale, min, max, step };
}
function choice(key, label, words) {
  return { key, label, words };
}

const GROUPS = [
  ["Drive", [
    choice("drive.mode", "Pulses come from", [["IPP", "coil ahead: in-plane (IPP)"], ["OPP", "coil below: out-of-plane (OPP)"]]),
    choice("drive.coils", "Field along the surface of", [["single", "the coil ahead"], ["pairs", "a pair, ahead and behind"]]),
    choice("drive.edge", "The field jumps", [["rise", "up"], ["fall", "down"]]),
    choice("drive.clamp", "Leans on", [["down", "front edge"], ["up", "rear edge"]]),
    choice("drive.direction", "Faces", [["+x", "right (+x)"], ["-x", "left (-x)"]]),
    slider("drive.frequency", "Frequency", "Hz", 1, 5, 150, 1),
    slider("drive.peak", "Peak field", "mT", 1e-3, 0, 6, 0.05),
    slider("drive.base", "Base field", "mT", 1e-3, 0, 3, 0.05),
    slider("drive.hold", "Holding field", "mT", 1e-3, 0, 4, 0.05),
  ]],
  ["Contact", [
    slider("contact.static_friction", "Static friction", "", 1, 0, 1.5, 0.005),
    slider("contact.kinetic_friction", "Kinetic friction", "", 1, 0, 1.5, 0.005),
    slider("contact.adhesion", "Adhesion", "nN", 1e-9, 0, 3000, 10),
    slider("contact.restitution", "Rebound (restitution)", "", 1, 0, 0.9, 0.05),
  ]],
  ["Robot", [
    slider("robot.length", "Length", "µm", 1e-6, 80, 500, 5),
    slider("robot.height", "Height", "µm", 1e-6, 30, 300, 5),
    slider("robot.mass", "Mass", "µg", 1e-9, 2, 100, 0.1),
    slider("robot.magnetization", "Magnetization", "kA/m", 1e3, 0, 1000, 5),
  ]],
  ["Surface and one effect", [
    slider("effects.surface_tilt.angle", "Tilt of the surface, downhill to the right", "°", DEGREE, -15, 15, 0.5),
  ]],
];

// [name in the list, setting, value that it begins with, values that belong to it]
const EFFECTS = [
  ["Ambient field along the surface", slider("effects.ambient_field.Bx", "Field", "mT", 1e-3, -1, 1, 0.01), 0.15e-3],
  ["Ambient field from above", slider("effects.ambient_field.Bz", "Field", "mT", 1e-3, -1, 1, 0.01), 0.15e-3],
  ["Tilted magnetization", slider("effects.misalignment.angle", "Angle to the long axis", "°", DEGREE, -30, 30, 0.5), 10 * DEGREE],
  ["Slow edge of the pulse", slider("drive.edge_time", "Duration", "ms", 1e-3, 0, 10, 0.1), 3e-3],
  ["Eddy currents", slider("effects.eddy_lag.time", "Lag of the field", "ms", 1e-3, 0, 10, 0.1), 2e-3],
  ["Controller in steps", slider("effects.sample_hold.period", "Period", "ms", 1e-3, 0, 5, 0.1), 2e-3],
  ["Amplifiers that clip", slider("effects.amplifier_limit.voltage", "Largest voltage (0: no limit)", "V", 1, 0, 40, 0.5), 10],
  ["Warm coils", slider("effects.coil_heating.coefficient", "Resistance by power", "%/W", 0.01, 0, 10, 0.1), 0.03],
  ["Coils that couple", slider("effects.mutual_inductance.coupling", "Coupling", "", 1, -0.2, 0.2, 0.01), 0.1],
  ["Gain of the coils ahead", slider("effects.field_gain.in_plane", "More field", "%", 0.01, -90, 100, 1), -0.3],
  ["Gain of the coil below", slider("effects.field_gain.clamp", "More field", "%", 0.01, -90, 100, 1), -0.3],
  ["Stronger gradient", slider("effects.gradient_scale.fraction", "More gradient", "%", 0.01, -100, 300, 5), 1],
  ["Friction by direction", slider("effects.friction_anisotropy.fraction", "More friction to the front", "%", 0.01, -90, 90, 1), 0.4],
  ["Friction in patches", slider("effects.friction_patches.amplitude", "Variation, every 0.1 mm", "%", 0.01, 0, 90, 1), 0.5, { "effects.friction_patches.period": 1e-4 }],
  ["Stribeck friction", slider("effects.stribeck_friction.velocity", "Velocity", "mm/s", 1e-3, 0, 50, 0.5), 10e-3],
  ["Viscous friction", slider("effects.viscous_friction.coefficient", "Growth by velocity", "s/m", 1, 0, 100, 1), 20],
  ["Adhesion by angle", slider("effects.angle_adhesion.strength", "Strength", "", 1, -2, 1, 0.05), 1],
  ["Adhesion that ages", slider("effects.adhesion_ageing.rate", "Rate", "", 1, 0, 2, 0.05), 0.5],
  ["Drag by angle", slider("effects.angle_drag.strength", "Strength", "", 1, 0, 30, 0.5), 10],
  ["Quadratic drag", slider("effects.quadratic_drag.coefficient", "Coefficient", "N s²/m²", 1, 0, 0.01, 0.0002), 2e-3],
  ["Surface that is shaken", slider("shake.amplitude_x", "Amplitude", "µm", 1e-6, -60, 60, 1), 20e-6, { "shake.frequency": 80, "shake.harmonic_2_x": 0.25, "shake.phase_2_x": -1.57 }],
  ["Rotational drag", slider("effects.rotational_drag.coefficient", "Coefficient", "pN m s", 1e-12, 0, 10, 0.1), 2e-12],
];

const SETTINGS = new Map(
  [...GROUPS.flatMap(([, settings]) => settings), ...EFFECTS.map(([, setting]) => setting)].map(
    (each) => [each.key, each],
  ),
);

const PRESETS = [
  ["Walks", {}],
  ["Walks by OPP", { "drive.mode": "OPP", "drive.edge": "fall" }],
  ["Slides back", { "drive.mode": "OPP", "drive.frequency": 60 }],
  ["Climbs", { "drive.frequency": 80, "drive.peak": 2.5e-3, "effects.surface_tilt.angle": -10 * DEGREE }],
  ["Flies", { "drive.frequency": 150, "drive.peak": 5e-3, "contact.adhesion": 0, "contact.restitution": 0.6 }],
  ["Tips over", { "drive.base": 0, "drive.peak": 2.5e-3 }],
  ["Stays: weak magnet", { "robot.magnetization": 2e4 }],
  ["Stays: steady field", { "drive.base": 1.5e-3 }],
  ["Stays: adhesion", { "contact.adhesion": 3e-6 }],
  ["Rides a stage", { "drive.frequency": 80, "drive.peak": 0, "drive.base": 0, "drive.hold": 0, "shake.amplitude_x": 20e-6, "shake.frequency": 80, "shake.harmonic_2_x": 0.25, "shake.phase_2_x": -1.57 }],
];

/** Settings of which the first may not exceed the second. */
const ORDERED = [["drive.base", "drive.peak"], ["contact.kinetic_friction", "contact.static_friction"]];

const effectOf = (key) => EFFECTS.find(([, setting]) => setting.key === key);
/** What an effect, or a constant among them, does. */
const meaningOf = (key) => (key.startsWith("effects.") ? core.effectMeaning(key.split(".")[1]) : describe(key).meaning);

/** What `value` is in SI units, without the noise of a product. */
const toSI = (setting, shown) => Number((shown * setting.scale).toPrecision(12));

function shownValue(setting, value) {
  const digits = Math.max(0, Math.ceil(-Math.log10(setting.step) - 1e-9));
  return (value / setting.scale).toFixed(digits);
}
const withUnit = (text, unit) => text + (unit === "" ? "" : unit === "°" ? unit : " " + unit);

/** Throws for a value that a setting of this page does not take. */
function checked(key, text) {
  const setting = SETTINGS.get(key);
  if (!setting) throw new Error(`unknown setting ${key}`);
  if (setting.words) {
    if (!setting.words.some(([word]) => word === text)) throw new Error(`${key} = ${text}: allowed is ${setting.words.map(([word]) => word).join(" or ")}`);
    return text;
  }
  const value = text.trim() === "" ? NaN : Number(text);
  const slack = 1e-9 * setting.max;
  const shown = value / setting.scale;
  if (!(shown >= setting.min - slack && shown <= setting.max + slack)) {
    throw new Error(`${key} = ${text}: allowed is ${setting.min} to ${withUnit(String(setting.max), setting.unit)}`);
  }
  return value;
}
