// A run in words: what moves the robot, or why it stays.

const numberOf = (value, digits = 3) => Number(value.toPrecision(digits)).toLocaleString("en", { maximumSignificantDigits: digits, useGrouping: false });
const mm = (v) => `${numberOf(v * 1e3)} mm/s`;
const um = (x) => `${numberOf(x * 1e6, 2)} µm`;
const ms = (t) => `${numberOf(t * 1e3, 2)} ms`;

// Parts of its length in a pulse: by less it is at rest, by more a trial walks (run_notes.py).
const AT_REST = 1e-3, WALKS = 2e-3;

const settingOf = (changes, key) => changes[key] ?? describe(key).default;

function stepOf(changes, run) {
  return Math.abs(run.mean_velocity) / changes["drive.frequency"] / settingOf(changes, "robot.length");
}

/** The robot in a sentence or two. */
function storyOf(changes, run) {
  if (run.status !== "ok") return `The run ended early: ${run.message}.`;
  if (!(stepOf(changes, run) >= AT_REST)) return whyItStays(changes, run);
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
  const verb = isFrictionless(changes) ? "It is pulled along" : run.events.roll_over ? "It tips over" : forward < 0 ? "It slides back" : run.shares.flight > 0.2 ? "It hops" : "It walks";
  return `${verb}: ${mm(Math.abs(forward))} ${way}, ${um(Math.abs(forward) * period)} a pulse. In each pulse of ${ms(period)} ${list}.`;
}

/** What a reader of the velocity should know. */
function notesOf(changes, run) {
  const notes = [];
  if (run.status !== "ok") return notes;
  const moves = stepOf(changes, run) >= AT_REST;
  const forward = run.mean_velocity * run.direction;
  if (moves && forward < 0) {
    const edge = settingWord(changes, "drive.edge") === "rise" ? "fall" : "rise";
    const other = velocityOf({ ...changes, "drive.edge": edge });
    if (other > 0) notes.push(`The sudden stroke pushes the edge the wrong way. With a sudden ${edge} it walks ${mm(other)} forward.`);
  }
  if (run.shares.flight > 0.2) {
    notes.push(`It is in the air for ${numberOf(100 * run.shares.flight, 2)} % of the time: it hops rather than walks, and its velocity depends on how it lands. A base field nearer to the peak keeps it down.`);
  }
  if (moves && isFrictionless(changes)) {
    notes.push("Without friction nothing holds the edge: it goes where the pull of the field or a tilt of the surface takes it, which is no walk.");
  }
  if (moves && run.events.roll_over) {
    notes.push(`It tipped over: ${run.events.roll_over} times it went from one edge over a face to the next.` + (changes["drive.base"] === 0 ? " At base field 0 the holding field alone stands it up on end; a base field keeps it lying." : ""));
  }
  if (Math.max(run.theta_max, -run.theta_min) > Math.PI / 2) notes.push("It tilted beyond upright.");
  if (moves && run.slip_up === 0 && run.slip_down === 0 && run.slip_flat === 0) {
    notes.push("The edge never slipped: the robot rolls or hops.");
  }
  if (moves && run.pull_ratio > 0.5) {
    notes.push(`The field is stronger near the coil and pulls the robot along, with up to ${numberOf(100 * run.pull_ratio, 2)} % of what friction can hold: a part of its velocity is no walk.`);
  }
  return notes;
}

function isFrictionless(changes) {
  return settingOf(changes, "contact.static_friction") === 0;
}

function settingWord(changes, key) {
  return changes[key] ?? SETTINGS.get(key).words[0][0];
}

/** The reason why it does not move: that whose change makes it walk, as tried. */
function whyItStays(changes, run) {
  if (run.field_max === 0) return "It stays where it is: there is no field.";
  if (changes["drive.base"] === changes["drive.peak"]) {
    return "It stays where it is: base and peak are equal, so the field is steady and has no pulses. A steady field turns the magnet once and then holds it.";
  }
  if (settingOf(changes, "robot.magnetization") === 0) return "It stays where it is: it has no magnetic moment for the field to turn.";
  const usual = (key) => describe(key).default;
  const stronger = (factor) => ({
    "drive.peak": factor * changes["drive.peak"],
    "drive.base": factor * changes["drive.base"],
    "drive.hold": factor * settingOf(changes, "drive.hold"),
  });
  const friction = settingOf(changes, "contact.static_friction"), hold = settingOf(changes, "drive.hold");
  const base = changes["drive.base"], peak = changes["drive.peak"], lower = Number((peak / 3).toPrecision(2));
  const trials = [
    [{ "contact.adhesion": usual("contact.adhesion") }, settingOf(changes, "contact.adhesion") > 2 * usual("contact.adhesion"),
      `adhesion of ${numberOf(settingOf(changes, "contact.adhesion") * 1e9)} nN holds the edge against every stroke. With ${numberOf(usual("contact.adhesion") * 1e9)} nN it walks.`],
    [{ "robot.magnetization": usual("robot.magnetization") }, settingOf(changes, "robot.magnetization") < 0.5 * usual("robot.magnetization"),
      `the magnet is too weak. The field turns it with at most ${numberOf(momentOf(changes) * run.field_max * 1e9, 2)} nN m, too little to shake the edge loose. With ${numberOf(usual("robot.magnetization") / 1e3)} kA/m it walks.`],
    [{ "drive.hold": usual("drive.hold") }, hold < 0.5 * usual("drive.hold"),
      `the holding field is ${numberOf(hold * 1e3)} mT, so the pulses change the field's size and hardly its direction, and do not rock the magnet. With ${numberOf(usual("drive.hold") * 1e3)} mT it walks.`],
    [{ "drive.base": lower }, base > 0.5 * peak,
      `base and peak differ by ${numberOf((peak - base) * 1e3)} mT, so the pulses are too small to break the edge loose. With a base field of ${numberOf(lower * 1e3)} mT it walks.`],
    [{ "contact.static_friction": 0.25 * friction, "contact.kinetic_friction": 0.25 * settingOf(changes, "contact.kinetic_friction") }, true,
      `friction holds the edge (coefficient ${numberOf(friction)}). With a quarter of the friction it walks.`],
    [stronger(2), true, "the field rocks it too little. With twice the field it walks."],
    [stronger(5), true, "the field rocks it too little. With five times the field it walks."],
  ];
  for (const [change, sensible, text] of trials) {
    if (sensible && walksWith({ ...changes, ...change })) return "It stays where it is: " + text;
  }
  return "It stays where it is: neither a quarter of the friction nor five times the field makes it walk.";
}

function walksWith(changes) {
  try {
    const run = measureRun({ ...changes, "drive.pulses": 12 });
    const rocks = run.slip_up !== 0 || run.slip_down !== 0;
    return run.status === "ok" && rocks && run.airborne_fraction < 0.5 && stepOf(changes, run) > WALKS;
  } catch {
    return false;
  }
}

/** Magnetic moment, A m². */
function momentOf(changes) {
  const volume = settingOf(changes, "robot.length") * settingOf(changes, "robot.height") * settingOf(changes, "robot.width");
  return volume * settingOf(changes, "robot.magnetization");
}
