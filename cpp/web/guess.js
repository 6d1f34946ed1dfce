// Guess the cause: a robot with one unstated effect, measured with noise.

const MOST_EXPERIMENTS = 8;
const NOISE = 0.03, LEAST_NOISE = 0.015e-3; // of a velocity; m/s

const between = (random, low, high) => low + (high - low) * random();
const signed = (random, low, high) => (random() < 0.5 ? -1 : 1) * between(random, low, high);

const CAUSES = [
  { key: "effects.surface_tilt.angle", name: "The surface is tilted", draw: (r) => signed(r, 3, 7) * DEGREE, hint: "Faster downhill than uphill, whichever coil pulses." },
  { key: "effects.ambient_field.Bx", name: "A field from outside", draw: (r) => signed(r, 0.1, 0.25) * 1e-3, hint: "The two ways differ when the coil ahead pulses (IPP), hardly when the coil below does (OPP)." },
  { key: "robot.magnetization", name: "A weaker magnet", draw: (r) => between(r, 0.45, 0.6) * 5e5, hint: "Slow pulses walk as stated; fast ones fall short." },
  { key: "drive.edge_time", name: "A slow edge of the pulse", draw: (r) => between(r, 2e-3, 4e-3), hint: "Slower everywhere; OPP at low frequency loses most." },
  { key: "effects.friction_anisotropy.fraction", name: "Friction by direction", draw: (r) => -between(r, 0.3, 0.6), hint: "All velocities grow by much the same factor, both ways." },
  { key: "effects.angle_drag.strength", name: "Drag by angle", draw: (r) => between(r, 6, 15), hint: "The velocity stops growing with frequency." },
];

const PUZZLE_BASE = { ...START };
const puzzleEdge = { IPP: "rise", OPP: "fall" };
function puzzleScenario(mode, direction, frequency, cause = {}) {
  return { ...PUZZLE_BASE, "drive.mode": mode, "drive.edge": puzzleEdge[mode], "drive.direction": direction, "drive.frequency": frequency, ...cause };
}

/** A generator of numbers from 0 to 1 with a seed (mulberry32). */
function randomFrom(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let word = Math.imul(state ^ (state >>> 15), state | 1);
    word ^= word + Math.imul(word ^ (word >>> 7), word | 61);
    return ((word ^ (word >>> 14)) >>> 0) / 2 ** 32;
  };
}

class Puzzle {
  constructor(seed) {
    this.seed = seed;
    this.random = randomFrom(seed);
    this.cause = CAUSES[Math.floor(this.random() * CAUSES.length)];
    this.value = Number(this.cause.draw(this.random).toPrecision(3));
    this.points = [];
    this.left = MOST_EXPERIMENTS;
    this.answer = null;
    this.lines = {};
    for (const frequency of [20, 50, 90, 130]) this.measure("IPP", "+x", frequency);
  }
  get hidden() {
    return { [this.cause.key]: this.value };
  }
  measure(mode, direction, frequency) {
    const true_velocity = velocityOf(puzzleScenario(mode, direction, frequency, this.hidden));
    const u = Math.max(this.random(), 1e-12), v = this.random();
    const normal = Math.sqrt(-2 * Math.log(u)) * Math.cos(2 * Math.PI * v);
    const error = Math.max(NOISE * Math.abs(true_velocity), LEAST_NOISE);
    this.points.push({ mode, direction, frequency, velocity: true_velocity + error * normal, error });
  }
  experiment(mode, direction, frequency) {
    if (this.left === 0 || this.answer) return;
    this.left -= 1;
    this.measure(mode, direction, frequency);
  }
  /** 20 for the name and 10 for each measurement that was not needed. */
  get score() {
    return this.answer === this.cause ? 20 + 10 * this.left : 0;
  }
}

const PUZZLE_FREQUENCIES = Array.from({ length: 29 }, (_, i) => 10 + 5 * i);

/** Lines of the stated model, and of the truth once it is known, a few runs at a time. */
async function computePuzzleLines(puzzle, changed, current) {
  const wanted = MODES.map((mode) => [mode, "+x", false]);
  if (puzzle.answer) for (const mode of MODES) for (const direction of ["+x", "-x"]) wanted.push([mode, direction, true]);
  for (const [mode, direction, isTrue] of wanted) {
    const name = `${mode}${direction}${isTrue}`;
    if (puzzle.lines[name]) continue;
    const points = [];
    for (const frequency of PUZZLE_FREQUENCIES) {
      points.push([frequency, velocityOf(puzzleScenario(mode, direction, frequency, isTrue ? puzzle.hidden : {}))]);
      await pause();
      if (!current()) return;
    }
    puzzle.lines[name] = points;
    changed();
  }
}

function drawPuzzle(canvas, puzzle) {
  const [ctx, w, h] = begin(canvas);
  const narrow = w < 560;
  const values = [...puzzle.points.map((p) => p.velocity), ...Object.values(puzzle.lines).flat().map(([, v]) => v)];
  const range = velocityRange(values).map((v) => v * 1e3);
  MODES.forEach((mode, i) => {
    const width = w / 2;
    const box = { left: i * width + (narrow ? 36 : 44), right: (i + 1) * width - 12, top: 36, bottom: h - 40 };
    const [px, py] = axes(ctx, box, [0, HIGH], range, "Hz", narrow ? "mm/s" : "mm/s forward");
    label(ctx, mode, box.right, box.top - 10, colours.ink, "right");
    const draw = (name, colour, dash) => puzzle.lines[name] && line(ctx, puzzle.lines[name].map(([f, v]) => [px(f), py(v * 1e3)]), colour, 2, dash);
    draw(`${mode}+xfalse`, colours.soft, []);
    draw(`${mode}+xtrue`, colours.truth, []);
    draw(`${mode}-xtrue`, colours.truth, [5, 4]);
    for (const p of puzzle.points.filter((each) => each.mode === mode)) {
      const x = px(p.frequency);
      line(ctx, [[x, py((p.velocity - p.error) * 1e3)], [x, py((p.velocity + p.error) * 1e3)]], colours.ink, 1.5);
      ctx.beginPath();
      ctx.arc(x, py(p.velocity * 1e3), 4.5, 0, 2 * Math.PI);
      ctx.fillStyle = p.direction === "+x" ? colours.ink : colours.panel;
      ctx.fill();
      ctx.strokeStyle = colours.ink;
      ctx.lineWidth = 2;
      ctx.stroke();
    }
  });
}
