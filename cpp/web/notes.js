// A run in words: what moves the robot, and the notes of the table NOTES (notes.toml of the package).

const numberOf = (value, digits = 3) => Number(value.toPrecision(digits)).toLocaleString("en", { maximumSignificantDigits: digits, useGrouping: false });
const mm = (v) => `${numberOf(v * 1e3)} mm/s`;
const um = (x) => `${numberOf(x * 1e6, 2)} µm`;
const ms = (t) => `${numberOf(t * 1e3, 2)} ms`;

const TRIED_PULSES = 12;

const settingOf = (changes, key) => changes[key] ?? SETTINGS.get(key)?.words?.[0][0] ?? describe(key).default;
const volumeOf = (changes) => settingOf(changes, "robot.length") * settingOf(changes, "robot.height") * settingOf(changes, "robot.width");
/** Magnetic moment, A m². */
const momentOf = (changes) => volumeOf(changes) * settingOf(changes, "robot.magnetization");
const densityOf = (changes) => settingOf(changes, "robot.mass") / volumeOf(changes);

/** The names of the table for a run, as note_table.py of the package has them. */
function factsOf(changes, run) {
  const of = (key) => settingOf(changes, key);
  const weight = of("robot.mass") * of("environment.gravity"), adhesion = of("contact.adhesion");
  const friction = of("contact.static_friction"), slope = of("effects.surface_tilt.angle");
  const forward = run.mean_velocity * (of("drive.direction") === "-x" ? -1 : 1);
  const pulse = 1 / of("drive.frequency") / of("robot.length"), pulses = of("drive.pulses");
  const stands = Math.abs(Math.sin(run.theta_max)) > Math.SQRT1_2;
  const torque = Math.abs(momentOf(changes)) * run.field_max;
  const held = 0.5 * of(stands ? "robot.height" : "robot.length") * (weight + adhesion);
  const rocks = Math.abs(run.slip_up) + Math.abs(run.slip_down);
  const facts = {
    ...run, weight, forward, torque, rocks,
    "drive.kind": "sawtooth", // the page offers no other
    "record.pull_share": "no", // the page asks for none
    resting_force: weight + adhesion,
    friction_held: friction * (weight + adhesion),
    density: densityOf(changes),
    moment: Math.abs(momentOf(changes)),
    slope: Math.abs(slope),
    slope_force: weight * Math.sin(Math.abs(slope)),
    slope_hold: friction * (weight * Math.cos(slope) + adhesion),
    downhill: run.mean_velocity * Math.sign(slope),
    swing: of("drive.peak") - of("drive.base"),
    middle_field: 0.5 * (of("drive.base") + of("drive.peak")),
    shaken: Number(["shake.amplitude_x", "shake.amplitude_z", "inner.mass"].some((key) => of(key) > 0)),
    measured_pulses: pulses >= 4 ? pulses - 3 : pulses,
    step: run.status === "ok" ? Math.abs(forward) * pulse : NaN,
    advance: run.status === "ok" ? forward * pulse : NaN,
    slips: rocks + Math.abs(run.slip_flat),
    tilt: Math.max(run.theta_max, -run.theta_min),
    held_torque: held,
    tipping: torque > 0 ? held / torque : Infinity,
    roll_over: run.events.roll_over,
    rolls: of("drive.base") !== 0 ? run.events.roll_over : 0,
  };
  return (name) => facts[name] ?? (name.startsWith("default.") ? describe(name.slice(8)).default : of(name));
}

const isName = (text) => /^[a-z]/i.test(text);
const product = (text, facts) => text.split(" ").reduce((value, each) => value * (isName(each) ? facts(each) : Number(each)), 1);
const COMPARISONS = { ">": (a, b) => a > b, ">=": (a, b) => a >= b, "<": (a, b) => a < b, "<=": (a, b) => a <= b };

const holds = (conditions, facts) => conditions.every((condition) => {
  const [first, how, ...other] = condition.split(" ");
  if (first === "not") return !holds([[how, ...other].join(" ")], facts);
  if (how === undefined) return holds(NOTES.lists[first], facts);
  if (how === "is") return facts(first) === other[0];
  return COMPARISONS[how](facts(first), product(other.join(" "), facts));
});

/** Changes and names of the first trial of a row that does what it says; null without one. */
function afterTrial(row, changes, facts) {
  if (!row.set && !row.fields) return { set: {}, tried: facts };
  for (const factor of row.fields ?? [null]) {
    const set = {};
    if (factor !== null) {
      for (const key of ["drive.peak", "drive.base", "drive.hold"]) set[key] = product(factor, facts) * facts(key);
      set["drive.base"] ||= 0.2 * set["drive.peak"];
    } else {
      for (const [key, text] of Object.entries(row.set)) set[key] = /[ .]/.test(text) ? product(text, facts) : text;
    }
    const all = { ...changes, "drive.pulses": Math.min(facts("drive.pulses"), TRIED_PULSES), ...set };
    try {
      const run = measureRun(all), tried = factsOf(all, run);
      if (run.status === "ok" && holds(row.then ?? ["walks"], tried)) return { set, tried };
    } catch {
      // A value beyond its range.
    }
  }
  return null;
}

/** A setting by its label, and with a value if one is given. */
function settingText(key, value) {
  const setting = SETTINGS.get(key);
  if (!setting) return value === undefined ? key : `${key} = ${numberOf(value)} ${describe(key).unit}`;
  if (setting.words) return value === undefined ? setting.label : `“${setting.label}: ${setting.words.find(([word]) => word === value)[1]}”`;
  const label = setting.label.split(",")[0].toLowerCase();
  return value === undefined ? label : withUnit(`${label} = ${numberOf(value / setting.scale)}`, setting.unit);
}

function textOf(row, facts, { set, tried }) {
  const filled = (text) => text.replace(/\{([\w.-]+)(?:(=)([^}]*)|:([^}]*))?\}/g, (_, name, given, other, unit) => {
    if (name === "advice") return filled(row.advice.find(({ when }) => holds(when, facts))?.text ?? "");
    if (name === "set") return Object.entries(set).map(([key, value]) => settingText(key, value)).join(", ");
    if (given) return settingText(name, other && typeof facts(name) === "string" ? other : product(other || name, facts));
    if (unit === undefined) return settingText(name);
    const value = name.startsWith("tried.") ? tried(name.slice(6)) : facts(name);
    return `${numberOf(value * NOTES.units[unit])} ${unit}`.trim();
  });
  return sentence(filled(row.text));
}

/** What holds of a run: code and sentence, the most serious first. */
function notesOf(changes, run) {
  const facts = factsOf(changes, run), notes = [], told = new Set();
  for (const row of NOTES.notes) {
    if (told.has(row.first_of) || !holds(row.when, facts)) continue;
    const found = afterTrial(row, changes, facts);
    if (!found) continue;
    if (row.first_of) told.add(row.first_of);
    notes.push({ code: row.code, text: textOf(row, facts, found) });
  }
  return notes;
}

/** The robot in a sentence or two, and the notes that these leave. */
function storyOf(changes, run) {
  if (run.status !== "ok") return { story: `The run ended early: ${run.message}.`, notes: [] };
  const facts = factsOf(changes, run), notes = notesOf(changes, run);
  if (!holds(["moves"], facts)) {
    const still = "The robot stays in its place", [{ text }, ...others] = notes;
    return { story: text.startsWith(still) ? text : `${still}. ${text}`, notes: others };
  }
  const period = run.period, forward = facts("forward");
  const noseDown = run.theta_min + run.theta_max > 0;
  const dropping = (noseDown ? run.slip_down : run.slip_up) * run.direction * period;
  const rising = (noseDown ? run.slip_up : run.slip_down) * run.direction * period;
  const flown = forward * period - dropping - rising - run.slip_flat * run.direction * period;
  const edge = noseDown ? "front edge" : "rear edge";
  const way = forward > 0 ? "forward" : "backward";
  const parts = [`the ${edge} holds for ${ms(run.shares.stick * period)}`];
  const slips = [[dropping, "while the body drops"], [rising, "while it rises"]]
    .filter(([x]) => Math.abs(x) > 0.04 * Math.abs(forward * period))
    .sort((a, b) => Math.abs(b[0]) - Math.abs(a[0]))
    .map(([x, when]) => `slips ${um(Math.abs(x))} ${x > 0 ? "forward" : "backward"} ${when}`);
  parts.push(...slips);
  if (run.shares.flight > 0.01) parts.push(`is in the air for ${ms(run.shares.flight * period)}${Math.abs(flown) > 0.04 * Math.abs(forward * period) ? `, which moves it ${um(Math.abs(flown))} ${flown > 0 ? "forward" : "backward"}` : ""}`);
  const list = parts.length > 1 ? parts.slice(0, -1).join(", ") + " and " + parts[parts.length - 1] : parts[0];
  const codes = new Set(notes.map(({ code }) => code));
  const [, verb] = [
    [codes.has("steep-surface") && facts("downhill") > 0, "It slides downhill"],
    [settingOf(changes, "shake.amplitude_x") !== 0 && run.field_max === 0, "The stage carries it"],
    [codes.has("no-friction"), "It is pulled along"],
    [codes.has("roll-over"), "It tips over"],
    [holds(["goes_back"], facts), "It slides back"],
    [codes.has("flight"), "It hops"],
    [true, "It walks"],
  ].find(([does]) => does);
  const story = `${verb}: ${mm(Math.abs(forward))} ${way}, ${um(Math.abs(forward) * period)} a pulse.`;
  if (["It slides downhill", "The stage carries it"].includes(verb)) return { story, notes };
  return { story: `${story} In each pulse of ${ms(period)} ${list}.`, notes };
}
