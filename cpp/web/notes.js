// A run in words: what moves the robot, and the notes of the core.

const numberOf = (value, digits = 3) => Number(value.toPrecision(digits)).toLocaleString("en", { maximumSignificantDigits: digits, useGrouping: false });
const mm = (v) => `${numberOf(v * 1e3)} mm/s`;
const um = (x) => `${numberOf(x * 1e6, 2)} µm`;
const ms = (t) => `${numberOf(t * 1e3, 2)} ms`;

const settingOf = (changes, key) => changes[key] ?? SETTINGS.get(key)?.words?.[0][0] ?? describe(key).default;
const volumeOf = (changes) => settingOf(changes, "robot.length") * settingOf(changes, "robot.height") * settingOf(changes, "robot.width");
/** Magnetic moment, A m². */
const momentOf = (changes) => volumeOf(changes) * settingOf(changes, "robot.magnetization");
const densityOf = (changes) => settingOf(changes, "robot.mass") / volumeOf(changes);

/** A setting by its label, and with a value if one is given. */
function settingText(key, value) {
  const setting = SETTINGS.get(key);
  if (!setting) return value === undefined ? key : withUnit(`${key} = ${numberOf(value)}`, describe(key).unit.replace("-", ""));
  if (setting.words) return value === undefined ? setting.label : `“${setting.label}: ${setting.words.find(([word]) => word === value)[1]}”`;
  const label = setting.label.split(",")[0].toLowerCase();
  return value === undefined ? label : withUnit(`${label} = ${numberOf(value / setting.scale)}`, setting.unit);
}

/** How the core names settings and numbers in the notes of this page. */
const WORDING = {
  key: (key) => settingText(key),
  setting: settingText,
  number: (value, digits, unit) => `${numberOf(value, digits)} ${unit}`.trim(),
};

/** What the core says of a run: notes, the most serious first, and whether it moves and goes back. */
function judged(changes, run) {
  const { moves, goes_back, notes } = answered(core.notes({ ...LIMITS, ...changes }, run, WORDING));
  return { moves, goes_back, notes: notes.map(({ code, text }) => ({ code, text: sentence(text) })) };
}
const notesOf = (changes, run) => judged(changes, run).notes;

/** The robot in a sentence or two, and the notes that these leave. */
function storyOf(changes, run) {
  if (run.status !== "ok") return { story: `The run ended early: ${run.message}.`, notes: [] };
  const { moves, goes_back, notes } = judged(changes, run);
  if (!moves) {
    const still = "The robot stays in its place", [{ text } = { text: "" }, ...others] = notes;
    return { story: text.startsWith(still) ? text : `${still}. ${text}`.trim(), notes: others };
  }
  const period = run.period, forward = run.mean_velocity * run.direction;
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
    [codes.has("steep-surface") && run.mean_velocity * settingOf(changes, "effects.surface_tilt.angle") > 0, "It slides downhill"],
    [settingOf(changes, "shake.amplitude_x") !== 0 && run.field_max === 0, "The stage carries it"],
    [codes.has("no-friction"), "It is pulled along"],
    [codes.has("roll-over"), "It tips over"],
    [goes_back, "It slides back"],
    [codes.has("flight"), "It hops"],
    [true, "It walks"],
  ].find(([does]) => does);
  const story = `${verb}: ${mm(Math.abs(forward))} ${way}, ${um(Math.abs(forward) * period)} a pulse.`;
  if (["It slides downhill", "The stage carries it"].includes(verb)) return { story, notes };
  return { story: `${story} In each pulse of ${ms(period)} ${list}.`, notes };
}
