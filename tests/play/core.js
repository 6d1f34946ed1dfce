// Runs the core of the page in node: `node core.js page.html`, with scenarios as a list of objects of
// keys and values on standard input; gives a list of {mean_velocity, ...} or {error}.
const { readFileSync } = require("fs");

const page = readFileSync(process.argv[2], "utf8");
const script = page.split("<script>")[1].split("</script>")[0];
const loadCore = new Function(`${script}; return loadCore;`)();
loadCore().then((core) => {
  const scenarios = JSON.parse(readFileSync(0, "utf8"));
  process.stdout.write(JSON.stringify(scenarios.map((changes) => core.measure(changes))));
});
