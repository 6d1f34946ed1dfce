// What all canvases share.

let colours = {};
function readColours() {
  const style = getComputedStyle(document.documentElement);
  colours = {};
  for (const name of ["stick", "slip", "flight", "truth", "other", "panel", "ink", "soft", "line", "body", "edge"]) {
    colours[name] = style.getPropertyValue("--" + name).trim();
  }
  colours.font = getComputedStyle(document.body).fontFamily;
}

/** A cleared context in CSS pixels, with its width and height. */
function begin(canvas) {
  const scale = window.devicePixelRatio || 1;
  const w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * scale) || canvas.height !== Math.round(h * scale)) {
    canvas.width = Math.round(w * scale);
    canvas.height = Math.round(h * scale);
  }
  const ctx = canvas.getContext("2d");
  ctx.setTransform(scale, 0, 0, scale, 0, 0);
  ctx.clearRect(0, 0, w, h);
  ctx.font = "12px " + colours.font;
  ctx.lineJoin = "round";
  return [ctx, w, h];
}

function line(ctx, points, colour, width = 1.5, dash = []) {
  ctx.beginPath();
  let drawn = false;
  for (const [x, y] of points) {
    if (!Number.isFinite(x) || !Number.isFinite(y)) {
      drawn = false;
      continue;
    }
    ctx[drawn ? "lineTo" : "moveTo"](x, y);
    drawn = true;
  }
  ctx.strokeStyle = colour;
  ctx.lineWidth = width;
  ctx.setLineDash(dash);
  ctx.stroke();
  ctx.setLineDash([]);
}

/** Text that stays readable over lines. */
function label(ctx, text, x, y, colour, align = "left") {
  ctx.textAlign = align;
  ctx.lineWidth = 4;
  ctx.strokeStyle = colours.panel;
  ctx.strokeText(text, x, y);
  ctx.fillStyle = colour;
  ctx.fillText(text, x, y);
}

function arrow(ctx, x, y, dx, dy, colour, width = 2.5) {
  const length = Math.hypot(dx, dy);
  if (length < 2) return;
  const head = Math.min(9, 0.6 * length), ux = dx / length, uy = dy / length;
  line(ctx, [[x, y], [x + dx - 0.7 * head * ux, y + dy - 0.7 * head * uy]], colour, width);
  ctx.beginPath();
  ctx.moveTo(x + dx, y + dy);
  ctx.lineTo(x + dx - head * ux - 0.5 * head * uy, y + dy - head * uy + 0.5 * head * ux);
  ctx.lineTo(x + dx - head * ux + 0.5 * head * uy, y + dy - head * uy - 0.5 * head * ux);
  ctx.closePath();
  ctx.fillStyle = colour;
  ctx.fill();
}

/** Round numbers from low to high, about `count` of them. */
function ticks(low, high, count) {
  const raw = (high - low) / count, power = 10 ** Math.floor(Math.log10(raw));
  const step = power * [1, 2, 5, 10].find((each) => each * power >= raw * 0.999);
  const result = [];
  for (let i = Math.ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i) result.push(i * step);
  return result;
}
const tickText = (value) => String(Number(value.toPrecision(6)));

/** Axes with ticks around a plot; gives the functions from values to pixels. */
function axes(ctx, box, xs, ys, xText, yText) {
  const [x0, x1] = xs, [y0, y1] = ys;
  const px = (x) => box.left + ((x - x0) / (x1 - x0)) * (box.right - box.left);
  const py = (y) => box.bottom - ((y - y0) / (y1 - y0)) * (box.bottom - box.top);
  ctx.fillStyle = colours.soft;
  for (const y of ticks(y0, y1, Math.max(2, (box.bottom - box.top) / 45))) {
    line(ctx, [[box.left, py(y)], [box.right, py(y)]], colours.line, y === 0 ? 2 : 1);
    label(ctx, tickText(y), box.left - 6, py(y) + 4, colours.soft, "right");
  }
  for (const x of ticks(x0, x1, Math.max(2, (box.right - box.left) / 70))) {
    label(ctx, tickText(x), px(x), box.bottom + 16, colours.soft, "center");
  }
  label(ctx, xText, box.right, box.bottom + 30, colours.soft, "right");
  label(ctx, yText, box.left - 34, box.top - 8, colours.soft, "left");
  return [px, py];
}
