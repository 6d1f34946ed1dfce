// Field, velocity and contact over the last pulses.

const PULSES_SHOWN = 3;

/** Times between which the strips show a run, s. */
function stripSpan(run, t) {
  const width = Math.min(PULSES_SHOWN * run.period, run.end);
  const from = Math.min(Math.max(t - 0.75 * width, 0), run.end - width);
  return [from, from + width];
}

function stripBox(w, h) {
  return { left: 44, right: w - 14, top: 26, bottom: h - 44 };
}

function drawStrips(canvas, run, t) {
  const [ctx, w, h] = begin(canvas);
  if (!run) return;
  const box = stripBox(w, h), [from, to] = stripSpan(run, t);
  const px = (time) => box.left + ((time - from) / (to - from)) * (box.right - box.left);
  const first = Math.max(0, Math.floor(from * run.rate)), last = Math.min(run.t.length - 1, Math.ceil(to * run.rate));
  const middle = box.top + 0.43 * (box.bottom - box.top);
  ctx.save();
  ctx.beginPath();
  ctx.rect(box.left, 0, box.right - box.left, h);
  ctx.clip();
  for (let i = first; i < last; ++i) {
    ctx.fillStyle = colours[run.kind[i]];
    ctx.fillRect(px(run.t[i]), box.bottom + 2, px(run.t[i + 1]) - px(run.t[i]) + 0.6, 10);
  }
  ctx.restore();
  run.ranges ??= { field: rangeOf(run, ["bx", "bz"]), speed: rangeOf(run, ["vx"], run.window_start) };
  const row = (top, bottom, range, factor, names, text) => {
    const py = (value) => bottom - ((value - range[0]) / (range[1] - range[0])) * (bottom - top);
    for (const value of ticks(range[0] * factor, range[1] * factor, 3)) {
      line(ctx, [[box.left, py(value / factor)], [box.right, py(value / factor)]], colours.line, value === 0 ? 2 : 1);
      label(ctx, tickText(value), box.left - 6, py(value / factor) + 4, colours.soft, "right");
    }
    ctx.save();
    ctx.beginPath();
    ctx.rect(box.left, top - 4, box.right - box.left, bottom - top + 8);
    ctx.clip();
    names.forEach(([name, , dash]) => {
      const points = [];
      for (let i = first; i <= last; ++i) points.push([px(run.t[i]), py(run[name][i])]);
      line(ctx, points, colours.ink, 1.7, dash);
    });
    ctx.restore();
    label(ctx, text, box.left - 34, top - 8, colours.soft);
    names.forEach(([, caption], i) => label(ctx, caption, box.right - 130 + 78 * i, top - 8, colours.soft));
  };
  row(box.top, middle - 14, run.ranges.field, 1e3, [["bx", "— along", []], ["bz", "- - up", [5, 4]]], "field, mT");
  row(middle + 18, box.bottom - 6, run.ranges.speed, 1e3, [["vx", "", []]], "velocity of the centre, mm/s");
  line(ctx, [[px(t), box.top], [px(t), box.bottom + 14]], colours.truth, 1.5);
  for (const time of ticks(from * 1e3, to * 1e3, Math.max(2, w / 110))) {
    label(ctx, tickText(time), px(time * 1e-3), box.bottom + 28, colours.soft, "center");
  }
  label(ctx, "ms", box.right, box.bottom + 40, colours.soft, "right");
}

function rangeOf(run, names, from = 0) {
  let low = 0, high = 0;
  for (const name of names) {
    for (let i = Math.floor(from * run.rate); i < run.t.length; ++i) {
      low = Math.min(low, run[name][i]);
      high = Math.max(high, run[name][i]);
    }
  }
  return high - low > 0 ? [low, high] : [-1e-4, 1e-4];
}
