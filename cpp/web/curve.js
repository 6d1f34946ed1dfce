// Mean velocity over frequency, computed a few runs at a time so that the page stays alive.

const LOW = 5, HIGH = 150;
const MODES = ["IPP", "OPP"];
const pause = () => new Promise((resolve) => setTimeout(resolve));

/** Frequencies (Hz), coarse ones first. */
const CURVE_FREQUENCIES = (() => {
  const all = [];
  for (const step of [20, 10, 5, 2.5]) {
    for (let f = step === 20 ? LOW : step; f <= HIGH; f += step) if (f >= LOW && !all.includes(f)) all.push(f);
    if (step === 20 && !all.includes(HIGH)) all.push(HIGH);
  }
  return all;
})();
const COARSE = 18; // of these, before a curve takes the place of the last one

class Curve {
  constructor(changed) {
    this.shown = {}; // mode: [[frequency, velocity], ...] in the order of the frequencies
    this.changed = changed;
    this.turn = 0;
  }
  async compute(changes) {
    const turn = ++this.turn;
    const mode = changes["drive.mode"] || "IPP";
    const began = performance.now();
    for (const each of [mode, ...MODES.filter((other) => other !== mode)]) {
      const points = [];
      let until = performance.now() + 12;
      for (const frequency of CURVE_FREQUENCIES) {
        points.push([frequency, velocityOf({ ...changes, "drive.mode": each, "drive.frequency": frequency })]);
        if (performance.now() < until) continue;
        if (points.length >= COARSE) this.show(each, points);
        await pause();
        if (turn !== this.turn) return;
        until = performance.now() + 12;
      }
      this.show(each, points);
    }
    this.took = performance.now() - began;
  }
  show(mode, points) {
    this.shown = { ...this.shown, [mode]: [...points].sort((a, b) => a[0] - b[0]) };
    this.changed();
  }
}

/** Mean velocity towards the front, m/s; NaN where a run does not come to its end. */
function velocityOf(changes) {
  try {
    const run = measureRun(changes);
    return run.mean_velocity * (changes["drive.direction"] === "-x" ? -1 : 1);
  } catch {
    return NaN;
  }
}

/** Range of velocities (m/s) that holds all of these and zero. */
function velocityRange(values) {
  const known = values.filter(Number.isFinite);
  const low = Math.min(0, ...known), high = Math.max(0, ...known);
  const room = 0.08 * Math.max(high - low, 1e-5);
  return [low < 0 ? low - room : 0, high + room];
}

function curveBox(w, h) {
  return { left: 44, right: w - 16, top: 30, bottom: h - 38 };
}

function drawCurve(canvas, curve, mode, frequency, velocity) {
  const [ctx, w, h] = begin(canvas);
  const box = curveBox(w, h);
  const all = Object.values(curve.shown).flat().map(([, v]) => v);
  const range = velocityRange([...all, velocity]).map((v) => v * 1e3);
  const [px, py] = axes(ctx, box, [0, HIGH], range, "frequency, Hz", "mm/s forward");
  for (const each of MODES.filter((other) => other !== mode).concat(mode)) {
    const points = curve.shown[each];
    if (!points) continue;
    const colour = each === mode ? colours.ink : colours.flight;
    line(ctx, points.map(([f, v]) => [px(f), py(v * 1e3)]), colour, each === mode ? 2.2 : 1.5);
    const near = points[points.length - 1];
    if (Number.isFinite(near[1])) label(ctx, each, px(near[0]) - 4, py(near[1] * 1e3) - 8, colour, "right");
  }
  if (!Number.isFinite(velocity)) return;
  ctx.beginPath();
  ctx.arc(px(frequency), py(velocity * 1e3), 6, 0, 2 * Math.PI);
  ctx.fillStyle = colours.truth;
  ctx.fill();
  const left = frequency > 0.7 * HIGH;
  label(ctx, `${(velocity * 1e3).toFixed(2)} mm/s at ${frequency} Hz`, px(frequency) + (left ? -10 : 10), py(velocity * 1e3) + 18, colours.truth, left ? "right" : "left");
}
