// The robot in motion, to scale, in the frame of the surface.

/** Corners about the centre (m, x right, z up) of a body at theta, nose-down positive. */
function cornersOf(length, height, theta, direction) {
  const c = Math.cos(theta), s = Math.sin(theta);
  return [[1, -1], [1, 1], [-1, 1], [-1, -1]].map(([a, b]) => {
    const x = (a * length) / 2, z = (b * height) / 2;
    return [direction * (x * c + z * s), -x * s + z * c];
  });
}
const lowest = (corners) => corners.reduce((a, b) => (b[1] < a[1] ? b : a));

function drawScene(canvas, run, t, shown) {
  const [ctx, w, h] = begin(canvas);
  if (!run) return;
  const { length, height, tilt } = shown;
  const diagonal = Math.hypot(length, height);
  const ground = Math.round(0.73 * h);
  const scale = Math.min((ground - 16) / (1.08 * diagonal), w / (1.9 * diagonal));
  const now = sampleAt(run, t);
  const px = (x) => (x - now.smooth_x) * scale, pz = (z) => -z * scale;

  ctx.save();
  ctx.translate(0.5 * w, ground);
  ctx.rotate(tilt);
  drawGround(ctx, w, h - ground, now.smooth_x, scale);
  drawTrace(ctx, run, t, h - ground - 10, px, shown);
  const corners = cornersOf(length, height, now.theta, run.direction);
  const body = corners.map(([x, z]) => [px(now.x + x), pz(now.z + z)]);
  drawBody(ctx, body, now, scale, length, run, px, pz);
  drawContact(ctx, corners, now, px, pz, diagonal);
  if (shown.forces) drawForces(ctx, run, now, corners, px, pz, w, h, shown);
  ctx.restore();
  drawCompass(ctx, now, run, tilt);
  drawScaleBar(ctx, w, scale);
}

function drawGround(ctx, w, depth, centre, scale) {
  ctx.fillStyle = colours.line;
  ctx.globalAlpha = 0.35;
  ctx.fillRect(-w, 0, 2 * w, 3 * depth);
  ctx.globalAlpha = 1;
  line(ctx, [[-w, 0], [w, 0]], colours.edge, 1.5);
  const mark = 50e-6;
  const from = Math.floor((centre - w / scale) / mark), to = Math.ceil((centre + w / scale) / mark);
  for (let i = from; i <= to; ++i) {
    const x = (i * mark - centre) * scale;
    line(ctx, [[x, 0], [x, i % 2 ? 4 : 8]], colours.soft, 1);
  }
}

/** Where the contact was: now at the surface, earlier further down. */
function drawTrace(ctx, run, t, depth, px, shown) {
  const span = 3 * run.period;
  const last = Math.min(Math.floor(t * run.rate), run.t.length - 1);
  const first = Math.max(0, Math.ceil((t - span) * run.rate));
  const stride = Math.max(1, Math.floor((last - first) / 500));
  let points = [], kind = null;
  const flush = () => line(ctx, points, colours[kind], kind === "flight" ? 1.5 : 3, kind === "flight" ? [2, 3] : []);
  for (let i = last; i >= first; i -= stride) {
    let x = run.contact_x[i];
    if (Number.isNaN(x)) {
      x = run.x[i] + lowest(cornersOf(shown.length, shown.height, run.theta[i], run.direction))[0];
    }
    const point = [px(x), 2 + ((t - run.t[i]) / span) * depth];
    if (run.kind[i] !== kind) {
      if (points.length) {
        points.push(point);
        flush();
      }
      points = [];
      kind = run.kind[i];
    }
    points.push(point);
  }
  if (points.length) flush();
}

function drawBody(ctx, body, now, scale, length, run, px, pz) {
  ctx.beginPath();
  body.forEach(([x, y], i) => ctx[i ? "lineTo" : "moveTo"](x, y));
  ctx.closePath();
  ctx.fillStyle = colours.body;
  ctx.fill();
  ctx.strokeStyle = colours.edge;
  ctx.lineWidth = 2;
  ctx.stroke();
  // The moment, from the south to the north end.
  const { direction } = run, angle = now.theta + run.misalignment;
  const half = 0.32 * length, c = Math.cos(angle), s = Math.sin(angle);
  const tail = [px(now.x - direction * half * c), pz(now.z + half * s)];
  arrow(ctx, tail[0], tail[1], 2 * direction * half * c * scale, 2 * half * s * scale, colours.soft, 2);
}

function drawContact(ctx, corners, now, px, pz, diagonal) {
  const low = lowest(corners);
  const colour = colours[now.kind];
  const near = corners.filter((each) => each[1] < low[1] + 0.004 * diagonal);
  if (now.contact.startsWith("face") && near.length > 1) {
    line(ctx, near.map(([x]) => [px(now.x + x), -1]), colour, 6);
  }
  ctx.beginPath();
  ctx.arc(px(now.x + low[0]), pz(now.z + low[1]), 8, 0, 2 * Math.PI);
  ctx.fillStyle = colour;
  ctx.fill();
  ctx.strokeStyle = colours.panel;
  ctx.lineWidth = 2;
  ctx.stroke();
}

function drawForces(ctx, run, now, corners, px, pz, w, h, shown) {
  const longest = 0.42 * h;
  const perNewton = (0.3 * h) / Math.max(shown.weight + shown.adhesion, 1e-9);
  const force = (x, z, fx, fz, colour, text) => {
    const size = Math.hypot(fx, fz) * perNewton;
    if (size < 2) return;
    const factor = (perNewton * Math.min(size, longest)) / size;
    arrow(ctx, x, z, fx * factor, -fz * factor, colour, 3);
    if (w < 480 || size < 16) return; // where words would hide more than they say; the legend has their colours
    const side = fx * factor < -4 ? "right" : "left";
    label(ctx, text, x + fx * factor + (side === "left" ? 6 : -6), z - fz * factor + (fz > 0 ? -4 : 12), colour, side);
  };
  const centre = [px(now.x), pz(now.z)];
  const foot = lowest(corners);
  const contact = [px(now.x + foot[0]), pz(now.z + foot[1])];
  const { weight, tilt } = shown;
  if (now.kind !== "flight") {
    force(contact[0], contact[1], 0, now.normal_force, colours.other, "normal");
    force(contact[0], contact[1], now.friction_force, 0, colours.truth, "friction");
  }
  force(centre[0], centre[1], weight * Math.sin(tilt), -weight * Math.cos(tilt), colours.ink, "weight");
  force(centre[0], centre[1], now.magnetic_x, now.magnetic_z, colours.stick, "magnetic");
  drawTorque(ctx, centre, now, run, shown, w);
}

/** The magnetic torque as an arc about the centre, of three quarters of a turn at its largest. */
function drawTorque(ctx, centre, now, run, shown, w) {
  const angle = now.theta + run.misalignment;
  const mx = run.direction * Math.cos(angle), mz = -Math.sin(angle);
  // About +y, which turns the nose of a robot that faces +x down: clockwise on the screen.
  const torque = (mz * now.bx - mx * now.bz) * shown.moment;
  const span = Math.min(1, Math.abs(torque) / Math.max(shown.moment * run.field_max, 1e-30)) * 1.5 * Math.PI;
  if (span < 0.05) return;
  const radius = 26, sign = Math.sign(torque), start = -0.5 * Math.PI;
  ctx.beginPath();
  ctx.arc(centre[0], centre[1], radius, start, start + sign * span, sign < 0);
  ctx.strokeStyle = colours.stick;
  ctx.lineWidth = 3;
  ctx.stroke();
  const end = start + sign * span;
  const x = centre[0] + radius * Math.cos(end), y = centre[1] + radius * Math.sin(end);
  arrow(ctx, x, y, -sign * 8 * Math.sin(end), sign * 8 * Math.cos(end), colours.stick, 3);
  if (w >= 480) label(ctx, "torque", centre[0] + radius + 6, centre[1] - 12, colours.stick);
}

/** The field at the robot, its length in proportion to the largest of the run. */
function drawCompass(ctx, now, run, tilt) {
  const x = 46, y = 42, radius = 30;
  ctx.beginPath();
  ctx.arc(x, y, radius, 0, 2 * Math.PI);
  ctx.strokeStyle = colours.line;
  ctx.lineWidth = 1;
  ctx.stroke();
  const size = Math.hypot(now.bx, now.bz);
  if (run.field_max > 0) {
    const angle = Math.atan2(-now.bz, now.bx) + tilt, length = (radius * size) / run.field_max;
    arrow(ctx, x, y, length * Math.cos(angle), length * Math.sin(angle), colours.ink, 2.5);
  }
  label(ctx, `field ${(size * 1e3).toFixed(2)} mT`, x - radius, y + radius + 16, colours.soft);
}

function drawScaleBar(ctx, w, scale) {
  const size = [500e-6, 200e-6, 100e-6, 50e-6, 20e-6].find((each) => each * scale < 0.3 * w) || 10e-6;
  const length = size * scale, x = w - 14 - length, y = 20;
  line(ctx, [[x, y - 4], [x, y + 4]], colours.soft);
  line(ctx, [[x, y], [x + length, y]], colours.soft);
  line(ctx, [[x + length, y - 4], [x + length, y + 4]], colours.soft);
  label(ctx, `${Math.round(size * 1e6)} µm`, x + length / 2, y + 18, colours.soft, "center");
}
