// A scenario as text that stickslip reads.

const written = (value) => (typeof value === "string" ? `"${value}"` : String(value));

function toml(changes) {
  const sections = new Map([["drive", []]]);
  for (const [key, value] of Object.entries(changes)) {
    const cut = key.lastIndexOf(".");
    const section = key.slice(0, cut);
    if (!sections.has(section)) sections.set(section, []);
    sections.get(section).push(`${key.slice(cut + 1)} = ${written(value)}`);
  }
  const text = [...sections].map(([section, lines]) => `[${section}]\n${lines.join("\n")}\n`);
  return `stickslip = 1\n\n${text.join("\n")}`;
}

function python(changes) {
  const lines = Object.entries(changes).map(([key, value]) => `    "${key}": ${written(value)},\n`);
  return `from stickslip import Scenario, simulate\n\nscenario = Scenario().replace({\n${lines.join("")}})\nprint(simulate(scenario).mean_velocity)  # m/s\n`;
}
