// State, controls and time.

const $ = (id) => document.getElementById(id);
const SLOWNESS = [5, 10, 20, 40, 80, 160, 320, 640];
const USUAL_SLOWNESS = 40;

const STILL = matchMedia("(prefers-reduced-motion: reduce)");
const state = { changes: {}, effect: null, forces: false, playing: !STILL.matches, slowness: USUAL_SLOWNESS, t: null };
let run = null;
let failure = "";
let curve = null;
let puzzle = null;
let solved = 0, points = 0;

const changesNow = () => ({ ...START, ...state.changes });
const valueOf = (key) => changesNow()[key] ?? (SETTINGS.get(key).words ? SETTINGS.get(key).words[0][0] : describe(key).default);

function say(text) {
  $("alert").textContent = text;
  $("alert").hidden = text === "";
}

// --- settings ---------------------------------------------------------------------------------

function addSlider(parent, setting) {
  const row = document.createElement("div");
  row.className = "row";
  const id = "set-" + setting.key;
  row.innerHTML = `<label for="${id}">${setting.label}</label><output for="${id}"></output><input type="range" id="${id}" min="${setting.min}" max="${setting.max}" step="${setting.step}">`;
  const input = row.querySelector("input");
  input.title = describe(setting.key).meaning;
  input.addEventListener("input", () => change({ [setting.key]: toSI(setting, input.value) }));
  row.show = () => {
    const value = valueOf(setting.key);
    input.value = value / setting.scale;
    const beside = setting.key === "robot.mass" ? `, ${numberOf(densityOf(changesNow()) / 1e3)} g/cm³` : "";
    const text = withUnit(shownValue(setting, value), setting.unit) + beside;
    row.querySelector("output").textContent = text;
    input.setAttribute("aria-valuetext", text);
  };
  parent.append(row);
  return row;
}

function addChoice(parent, setting) {
  const row = document.createElement("div");
  row.className = "row words";
  row.setAttribute("role", "radiogroup");
  row.setAttribute("aria-label", setting.label);
  const options = setting.words.map(([word, text]) => `<label><input type="radio" name="${setting.key}" value="${word}">${text}</label>`);
  row.innerHTML = `<span>${setting.label}</span><div class="choices">${options.join("")}</div>`;
  row.addEventListener("change", (event) => change({ [setting.key]: event.target.value }));
  row.show = () => {
    const word = valueOf(setting.key);
    for (const input of row.querySelectorAll("input")) input.checked = input.value === word;
  };
  parent.append(row);
  return row;
}

let rows = [];
function buildControls() {
  for (const [title, settings] of GROUPS) {
    const group = document.createElement("fieldset");
    group.innerHTML = `<legend>${title}</legend>`;
    for (const setting of settings) rows.push(setting.words ? addChoice(group, setting) : addSlider(group, setting));
    $("controls").append(group);
  }
  const last = $("controls").lastElementChild;
  const box = document.createElement("div");
  box.className = "row words";
  box.innerHTML = `<label for="effect">One more effect</label><select id="effect"><option value="">none</option>${EFFECTS.map(([name, { key }]) => `<option value="${key}">${name}</option>`).join("")}</select><div id="effect-value"></div><p class="muted" id="effect-text"></p>`;
  last.append(box);
  $("effect").addEventListener("change", (event) => chooseEffect(event.target.value));
  for (const [i, [name]] of PRESETS.entries()) {
    const button = document.createElement("button");
    button.textContent = name;
    button.addEventListener("click", () => choosePreset(i));
    $("presets").append(button);
  }
}

function chooseEffect(key) {
  const changes = withoutEffects(state.changes);
  if (key) {
    const [, , value, beside] = effectOf(key);
    Object.assign(changes, { [key]: value }, beside);
  }
  setChanges(changes);
}
function withoutEffects(changes) {
  const dropped = new Set(EFFECTS.flatMap(([, { key }, , beside]) => [key, ...Object.keys(beside ?? {})]));
  return Object.fromEntries(Object.entries(changes).filter(([key]) => !dropped.has(key)));
}

function choosePreset(index) {
  state.t = null;
  setPlaying(!STILL.matches);
  setChanges({ ...PRESETS[index][1] });
}

function change(values) {
  setChanges({ ...state.changes, ...inOrder(values) });
}

/** These values, and beside each the one that has to follow it: a base is no higher than the peak. */
function inOrder(values) {
  const result = { ...values };
  for (const [low, high] of ORDERED) {
    if (low in values) result[high] = Math.max(values[low], valueOf(high));
    if (high in values) result[low] = Math.min(values[high], valueOf(low));
  }
  return result;
}

/** Takes these values beside those of the start; one that is the start's or the default is left out. */
function setChanges(changes) {
  const kept = {};
  for (const [key, value] of Object.entries(changes)) {
    const setting = SETTINGS.get(key);
    const usual = START[key] ?? (setting?.words ? setting.words[0][0] : describe(key).default);
    if (value !== usual || effectOf(key)) kept[key] = value;
  }
  state.changes = kept;
  say("");
  $("copied").textContent = "";
  refresh();
}

let refreshing = false;
/** Once a frame at most: a slider gives many values in one. */
function refresh() {
  if (refreshing) return;
  refreshing = true;
  requestAnimationFrame(() => {
    refreshing = false;
    recompute();
  });
}

function recompute() {
  const changes = changesNow();
  const began = performance.now();
  try {
    run = playRun(changes);
    failure = "";
  } catch (error) {
    run = null;
    failure = error.message;
  }
  timing.run = performance.now() - began;
  if (run) state.t = Math.min(state.t ?? run.first, run.end);
  showSettings();
  showWords(changes);
  writeHash();
  if (run) curve.compute(changes);
}
const timing = { run: 0 };

function showSettings() {
  for (const row of rows) row.show();
  const found = EFFECTS.find(([, { key }]) => key in state.changes);
  const key = found ? found[1].key : "";
  if (state.effect !== key) {
    state.effect = key;
    $("effect").value = key;
    $("effect-value").textContent = "";
    $("effect-text").textContent = key ? sentence(meaningOf(key)) : "";
    if (key) $("effect-value").row = addSlider($("effect-value"), found[1]);
  }
  if (key) $("effect-value").row.show();
  const preset = PRESETS.findIndex(([, values]) => sameValues(values, state.changes));
  [...$("presets").children].forEach((button, i) => button.setAttribute("aria-pressed", String(i === preset)));
}
const sentence = (text) => text[0].toUpperCase() + text.slice(1) + ".";
const sameValues = (a, b) => Object.keys(a).length === Object.keys(b).length && Object.keys(a).every((key) => a[key] === b[key]);

function showWords(changes) {
  $("notes").textContent = "";
  if (!run) {
    $("story").textContent = failure;
    return;
  }
  const { story, notes } = storyOf(changes, run);
  $("story").textContent = story;
  $("scene").setAttribute("aria-label", "The robot in motion. " + story);
  for (const { text } of notes) {
    const item = document.createElement("li");
    item.textContent = text;
    $("notes").append(item);
  }
}

// --- address ----------------------------------------------------------------------------------

let hashTimer = 0;
function writeHash() {
  clearTimeout(hashTimer);
  // Browsers refuse to be given an address at every step of a slider.
  hashTimer = setTimeout(() => {
    const text = $("guess").hidden
      ? Object.entries(state.changes).map(([key, value]) => `${key}=${value}`).join("&")
      : `guess=${puzzle.seed}`;
    history.replaceState(null, "", text ? "#" + text : location.pathname + location.search);
  }, 200);
}

function readHash() {
  const text = decodeURIComponent(location.hash.slice(1));
  if (text.startsWith("guess=")) {
    const seed = Number(text.slice(6));
    if (!Number.isInteger(seed) || seed < 0 || seed >= 2 ** 32) throw new Error(`guess = ${text.slice(6)}: allowed is a whole number from 0`);
    return { seed };
  }
  const changes = {};
  for (const part of text.split("&").filter((each) => each !== "")) {
    const cut = part.indexOf("=");
    if (cut < 0) throw new Error(`${part} has no value`);
    const key = part.slice(0, cut);
    changes[key] = checkedAny(key, part.slice(cut + 1));
  }
  const acting = EFFECTS.filter(([, { key }]) => key in changes);
  if (acting.length > 1) throw new Error(`${acting.map(([, { key }]) => key).join(" and ")}: one effect at a time`);
  return { changes };
}
/** As `checked`, also for what belongs to an effect. */
function checkedAny(key, text) {
  const beside = EFFECTS.find(([, , , values]) => values && key in values);
  if (!beside) return checked(key, text);
  if (Number(text) !== beside[3][key]) throw new Error(`${key} = ${text}: allowed is ${beside[3][key]}`);
  return beside[3][key];
}

function openHash() {
  try {
    const { changes, seed } = readHash();
    if (seed !== undefined) {
      startPuzzle(seed);
      show("guess");
      return;
    }
    show("play");
    setChanges(changes);
    measureRun(changesNow()); // what the core refuses, the address gets wrong
  } catch (error) {
    show("play");
    setChanges({});
    say(`The address of this page cannot be read (${error.message}). It shows the default.`);
  }
}

// --- time -------------------------------------------------------------------------------------

let lastFrame = 0;
function frame(now) {
  const passed = Math.min((now - lastFrame) / 1e3, 0.1);
  lastFrame = now;
  if (!$("play").hidden) {
    if (run && state.playing) {
      state.t += passed / state.slowness;
      if (state.t >= run.end) state.t = run.first;
    }
    drawAll();
  }
  requestAnimationFrame(frame);
}

function drawAll() {
  const changes = changesNow();
  drawScene($("scene"), run, state.t, {
    length: settingOf(changes, "robot.length"),
    height: settingOf(changes, "robot.height"),
    tilt: settingOf(changes, "effects.surface_tilt.angle"),
    weight: settingOf(changes, "robot.mass") * describe("environment.gravity").default,
    adhesion: settingOf(changes, "contact.adhesion"),
    moment: momentOf(changes),
    forces: state.forces,
  });
  drawStrips($("strips"), run, state.t);
  drawCurve($("curve"), curve, valueOf("drive.mode"), valueOf("drive.frequency"), run ? run.mean_velocity * run.direction : NaN);
  if (run) $("clock").textContent = `t = ${(state.t * 1e3).toFixed(1)} ms`;
}

function setSlowness(step) {
  const index = SLOWNESS.indexOf(state.slowness) + step;
  state.slowness = SLOWNESS[Math.min(Math.max(index, 0), SLOWNESS.length - 1)];
  showPlayback();
}
function setPlaying(playing) {
  state.playing = playing;
  showPlayback();
}
function setForces(forces) {
  state.forces = forces;
  showPlayback();
}
function step(by) {
  setPlaying(false);
  if (run) state.t = Math.min(Math.max(state.t + by * run.period * 0.01, 0), run.end);
}
function showPlayback() {
  $("pause").textContent = state.playing ? "Pause" : "Play";
  $("slowness").textContent = `${state.slowness} times slower`;
  $("slower").disabled = state.slowness === SLOWNESS[SLOWNESS.length - 1];
  $("faster").disabled = state.slowness === SLOWNESS[0];
  $("forces").setAttribute("aria-pressed", String(state.forces));
  $("force-legend").hidden = !state.forces;
}
function reset() {
  state.t = null;
  state.slowness = USUAL_SLOWNESS;
  state.forces = false;
  setPlaying(!STILL.matches);
  setChanges({});
}

const SAVE_AS = "Save it as robot.toml, then: stickslip run robot.toml";
async function copy(text, what, where) {
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    // Without the right to the clipboard, as from a file in some browsers.
    const area = document.createElement("textarea");
    area.value = text;
    document.body.append(area);
    area.select();
    document.execCommand("copy");
    area.remove();
  }
  $("copied").textContent = `${what} copied. ${where}`;
}

/** What a copied scenario holds: all that is not stickslip's default. */
function scenarioChanges() {
  const changes = changesNow();
  return Object.fromEntries(
    Object.entries(changes).filter(([key, value]) => SETTINGS.get(key)?.words || value !== describe(key).default),
  );
}

// --- guess ------------------------------------------------------------------------------------

function startPuzzle(seed) {
  puzzle = new Puzzle(seed);
  showPuzzle();
}
function showPuzzle() {
  const { left, answer, cause } = puzzle;
  $("experiment").querySelector("button").disabled = left === 0 || answer !== null;
  $("experiment").querySelector("output.left").textContent = `${left} of ${MOST_EXPERIMENTS} left`;
  for (const input of $("answer").querySelectorAll("input, button")) input.disabled = answer !== null;
  if (!answer) for (const input of $("answer").querySelectorAll("input")) input.checked = false;
  $("truth-legend").hidden = $("see").hidden = answer === null;
  $("score").textContent = solved ? `${points} points from ${solved} robot${solved > 1 ? "s" : ""}` : "";
  $("verdict").textContent = answer ? verdict(answer, cause) : "";
  drawPuzzle($("puzzle"), puzzle);
  const shown = puzzle;
  computePuzzleLines(puzzle, () => drawPuzzle($("puzzle"), puzzle), () => puzzle === shown);
}
function verdict(answer, cause) {
  const setting = SETTINGS.get(cause.key);
  const value = withUnit(String(Number((puzzle.value / setting.scale).toPrecision(3))), setting.unit);
  const truth = `${cause.name.toLowerCase()}, ${cause.key} = ${value}`;
  const take = `“See it walk” drives this robot, and there “Copy as TOML” copies it. ${SAVE_AS}`;
  if (answer === cause) return `Right: ${truth}. ${puzzle.score} points: 20 for the name, 10 for each measurement that you did not need. ${take}`;
  return `It was another one: ${truth}. ${cause.hint} No points. ${take}`;
}

function buildGuess() {
  $("experiment").innerHTML = `<fieldset><legend>Measure one more velocity</legend>
<div class="row words" role="radiogroup" aria-label="Pulses come from"><div class="choices"><label><input type="radio" name="mode" value="IPP" checked>coil ahead (IPP)</label><label><input type="radio" name="mode" value="OPP">coil below (OPP)</label></div></div>
<div class="row words" role="radiogroup" aria-label="Direction"><div class="choices"><label><input type="radio" name="direction" value="+x" checked>towards +x</label><label><input type="radio" name="direction" value="-x">towards -x</label></div></div>
<div class="row"><label for="at">Frequency</label><output for="at" class="at">60 Hz</output><input type="range" id="at" min="5" max="150" step="5" value="60"></div>
<div class="bar"><button>Measure</button><output class="muted left"></output></div></fieldset>`;
  const form = $("experiment");
  form.querySelector("output.at").textContent = "60 Hz";
  $("at").addEventListener("input", () => (form.querySelector("output.at").textContent = `${$("at").value} Hz`));
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    const data = new FormData(form);
    puzzle.experiment(data.get("mode"), data.get("direction"), Number($("at").value));
    showPuzzle();
  });
  const causes = CAUSES.map(({ name, key }, i) => `<label><input type="radio" name="cause" value="${i}" required><span>${name}<small>${sentence(meaningOf(key))}</small></span></label>`);
  const hints = CAUSES.map(({ name, hint }) => `<li>${name}: ${hint[0].toLowerCase() + hint.slice(1)}</li>`);
  $("answer").innerHTML = `<fieldset><legend>What is it?</legend>${causes.join("")}<div class="bar"><button>That is it</button></div><details><summary>Hints</summary><ul>${hints.join("")}</ul></details></fieldset>`;
  $("answer").addEventListener("submit", (event) => {
    event.preventDefault();
    puzzle.answer = CAUSES[Number(new FormData($("answer")).get("cause"))];
    solved += 1;
    points += puzzle.score;
    showPuzzle();
  });
  $("next-puzzle").addEventListener("click", () => {
    startPuzzle((puzzle.seed + 1) % 2 ** 32);
    writeHash();
  });
  $("see").addEventListener("click", () => {
    const cause = { [puzzle.cause.key]: puzzle.value };
    show("play");
    setChanges(cause);
  });
}

// --- together ---------------------------------------------------------------------------------

function show(name) {
  for (const each of ["play", "guess"]) {
    $(each).hidden = each !== name;
    $("tab-" + each).setAttribute("aria-selected", String(each === name));
    $("tab-" + each).tabIndex = each === name ? 0 : -1;
  }
  if (name === "play" && core && !run) refresh();
  if (name === "guess") {
    if (!puzzle) startPuzzle(1 + Math.floor(Math.random() * 9999));
    showPuzzle();
  }
}

function seek(event) {
  if (!run || (event.type === "pointermove" && !event.buttons)) return;
  const box = stripBox($("strips").clientWidth, $("strips").clientHeight);
  if (event.type === "pointerdown") {
    setPlaying(false);
    seek.from = [event.offsetX, state.t];
    $("strips").setPointerCapture(event.pointerId);
    return;
  }
  const [from, to] = stripSpan(run, seek.from[1]);
  const moved = ((event.offsetX - seek.from[0]) / (box.right - box.left)) * (to - from);
  state.t = Math.min(Math.max(seek.from[1] - moved, 0), run.end);
}
function pickFrequency(event) {
  if (event.type === "pointermove" && !event.buttons) return;
  const box = curveBox($("curve").clientWidth, $("curve").clientHeight);
  const frequency = Math.round(((event.offsetX - box.left) / (box.right - box.left)) * HIGH);
  change({ "drive.frequency": Math.min(Math.max(frequency, LOW), HIGH) });
}

function onKey(event) {
  // Where a space has a meaning of its own.
  const typing = event.target.closest("input[type=radio], select, button, summary");
  if (event.ctrlKey || event.metaKey || event.altKey || $("play").hidden) return;
  const keys = {
    ",": () => step(-1), ".": () => step(1), "-": () => setSlowness(1), "+": () => setSlowness(-1), "=": () => setSlowness(-1),
    f: () => setForces(!state.forces), r: reset,
  };
  PRESETS.forEach((_, i) => (keys[i + 1] = () => choosePreset(i)));
  if (event.key === " " && !typing) keys[" "] = () => setPlaying(!state.playing);
  if (event.target.closest("select")) return; // which takes letters itself
  const action = keys[event.key.toLowerCase()];
  if (!action) return;
  event.preventDefault();
  action();
}

function wire() {
  for (const name of ["play", "guess"]) {
    $("tab-" + name).addEventListener("click", () => {
      show(name);
      writeHash();
    });
    $("tab-" + name).addEventListener("keydown", (event) => {
      if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
      const other = name === "play" ? "guess" : "play";
      show(other);
      writeHash();
      $("tab-" + other).focus();
    });
  }
  $("pause").addEventListener("click", () => setPlaying(!state.playing));
  $("slower").addEventListener("click", () => setSlowness(1));
  $("faster").addEventListener("click", () => setSlowness(-1));
  $("forces").addEventListener("click", () => setForces(!state.forces));
  $("reset").addEventListener("click", reset);
  $("controls").addEventListener("submit", (event) => event.preventDefault());
  for (const type of ["pointerdown", "pointermove"]) {
    $("strips").addEventListener(type, seek);
    $("curve").addEventListener(type, pickFrequency);
  }
  $("copy-toml").addEventListener("click", () => copy(toml(scenarioChanges()), "TOML", SAVE_AS));
  $("copy-python").addEventListener("click", () => copy(python(scenarioChanges()), "Python", "Save it as robot.py, then: python robot.py"));
  $("copy-link").addEventListener("click", () => copy(location.href, "Link", "It opens this page with these settings."));
  document.addEventListener("keydown", onKey);
  window.addEventListener("hashchange", openHash);
  window.addEventListener("resize", () => puzzle && !$("guess").hidden && drawPuzzle($("puzzle"), puzzle));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
    readColours();
    if (puzzle) drawPuzzle($("puzzle"), puzzle);
  });
}

async function main() {
  try {
    core = await loadCore();
  } catch (error) {
    say(`The simulator does not run in this browser (${error.message}).`);
    return;
  }
  contactNames = core.contactNames();
  $("version").textContent = `Version ${VERSION}, sources of the core ${CORE_SOURCES}.`;
  readColours();
  curve = new Curve(() => {});
  buildControls();
  buildGuess();
  wire();
  showPlayback();
  openHash();
  requestAnimationFrame(frame);
}
main();
