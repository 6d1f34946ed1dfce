// Runs of the core, and samples of a recorded one.

let core = null;

// A page may not hang: no run that is worth a look needs so many steps.
const LIMITS = { "solver.max_steps": 300000 };

function answered(result) {
  if (result.error) throw new Error(result.error);
  return result;
}
const measureRun = (changes) => answered(core.measure({ ...LIMITS, ...changes }));

/** A run with its record, and numbers over its measuring window. */
function playRun(changes) {
  const frequency = changes["drive.frequency"];
  const rate = Math.max(4000, 150 * frequency);
  const run = answered(core.play({ ...LIMITS, ...changes }, rate));
  run.rate = rate;
  run.period = 1 / frequency;
  run.direction = changes["drive.direction"] === "-x" ? -1 : 1;
  run.end = run.t[run.t.length - 1];
  // Where it is shown from: the ramp before the pulses only if the robot rolls over in it or nothing follows.
  const steps = Math.abs(run.mean_velocity) > 0 && !run.events.roll_over;
  run.first = steps ? Math.min(settingOf(changes, "drive.ramp"), run.end) : 0;
  run.kind = Array.from(run.contact, (code) => kindOf(code));
  const shares = { stick: 0, slip: 0, flight: 0 };
  let counted = 0;
  for (let i = 0; i < run.t.length; ++i) {
    if (run.t[i] < run.window_start || run.t[i] > run.window_end) continue;
    shares[run.kind[i]] += 1;
    counted += 1;
  }
  for (const kind in shares) shares[kind] /= Math.max(counted, 1);
  run.shares = shares;
  run.smooth_x = smoothed(run.x, Math.round(rate * run.period));
  return run;
}

const described = new Map();
/** Default, unit and meaning of a numeric key; without the table of the paper. */
function describe(key) {
  if (!described.has(key)) {
    const { meaning, ...rest } = answered(core.describe(key));
    described.set(key, { ...rest, meaning: meaning.replace(/, Tables? .*/, "") });
  }
  return described.get(key);
}

let contactNames = [];
function kindOf(code) {
  const name = contactNames[code];
  return name === "flight" ? "flight" : name.endsWith("stick") ? "stick" : "slip";
}

/** Mean over `width` samples about each, fewer at the ends: what the camera follows. */
function smoothed(values, width) {
  const sums = new Float64Array(values.length + 1);
  values.forEach((value, i) => (sums[i + 1] = sums[i] + value));
  const half = Math.ceil(width / 2);
  return values.map((_, i) => {
    const from = Math.max(0, i - half), to = Math.min(values.length, i + half + 1);
    return (sums[to] - sums[from]) / (to - from);
  });
}

const INTERPOLATED = ["x", "z", "theta", "vx", "bx", "bz", "smooth_x", "normal_force", "friction_force", "magnetic_x", "magnetic_z"];

/** The motion at a time (s): numbers between two samples, the contact of the earlier one. */
function sampleAt(run, t) {
  const place = Math.min(Math.max(t * run.rate, 0), run.t.length - 1);
  const i = Math.floor(place), j = Math.min(i + 1, run.t.length - 1);
  const sample = { index: i, kind: run.kind[i], contact: contactNames[run.contact[i]] };
  for (const name of INTERPOLATED) sample[name] = run[name][i] + (place - i) * (run[name][j] - run[name][i]);
  return sample;
}
