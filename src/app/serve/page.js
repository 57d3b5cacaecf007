"use strict";
// The page asks the program for everything that it shows, and inserts texts as plain text.

const $ = (selector, from = document) => from.querySelector(selector);
const $$ = (selector, from = document) => [...from.querySelectorAll(selector)];

/** An element with attributes and children; children that are not elements become text. */
function el(name, attributes = {}, ...children) {
  const svg = ["svg", "line", "rect", "circle", "text"].includes(name);
  const made = svg ? document.createElementNS("http://www.w3.org/2000/svg", name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) {
    if (key === "onclick") made.addEventListener("click", value);
    else if (value !== null && value !== undefined && value !== false) made.setAttribute(key, value === true ? "" : value);
  }
  made.append(...children.flat().filter((child) => child !== null && child !== undefined && child !== ""));
  return made;
}

/** A box that scrolls by itself, also by keys. */
const scrolling = (label, ...children) => el("div", { class: "scroll", tabindex: 0, role: "region", "aria-label": label }, ...children);

function show(node, text) {
  node.textContent = text || "";
  node.hidden = !text;
}

const number = (value) => {
  if (value === null || value === undefined) return "not known";
  return value !== 0 && (Math.abs(value) >= 1e5 || Math.abs(value) < 1e-3) ? value.toExponential(2)
    : String(Number(value.toPrecision(3)));
};

const whole = (value) => String(value).replace(/\B(?=(\d{3})+$)/g, "\u202f");
const percent = (share) => {
  const value = 100 * share;
  return (value === 0 || value >= 10 ? value.toFixed(1) : value.toFixed(2)) + "\u202f%";
};

/** The answer of the program; a problem is an Error with its message. */
async function ask(path, body, type) {
  const request = { cache: "no-store", credentials: "same-origin" };
  if (body !== undefined) {
    request.method = "POST";
    request.body = body instanceof Blob || typeof body === "string" ? body : JSON.stringify(body);
    request.headers = { "Content-Type": type || "application/json" };
  }
  let answer;
  try {
    answer = await fetch(path, request);
  } catch {
    throw new Error("the program does not answer");
  }
  const said = await answer.json();
  if (!answer.ok) throw new Error(said.problem || `status ${answer.status}`);
  return said;
}

const state = { sheets: [], jobs: [], base: "", filter: "", more: [], largest: 32, seen: "", samples: "", examples: {} };

// --- Selection: kept in the address, so that it survives a reload.

function remember() {
  const words = new URLSearchParams({ b: state.base, f: state.filter, m: state.more.join("\n") });
  history.replaceState(null, "", "#" + words);
}

function recall() {
  const words = new URLSearchParams(location.hash.slice(1));
  state.base = words.get("b") || "";
  state.filter = words.get("f") || "";
  state.more = (words.get("m") || "").split("\n").filter(Boolean);
}

/** Every soil of every sheet: its identifier, and its label, which begins with its own name in case a narrow list cuts it. */
function soils() {
  return state.sheets.flatMap((sheet) => sheet.soils.map((soil) => ({
    key: sheet.soils.length > 1 ? `${sheet.id}#${soil.name}` : String(sheet.id),
    label: sheet.soils.length > 1 ? `${soil.name} (${sheet.name})` : sheet.name,
    soil,
  })));
}

const soilOf = (key) => soils().find((one) => one.key === key);

// --- Sheets.

async function add(box, name, content) {
  const problem = $(".problem", box);
  show(problem, "");
  try {
    if (content.size > state.largest * 2 ** 20) throw new Error(`${name}: too large: at most ${state.largest} MB`);
    const sheet = await keep(name, content);
    const pasted = $("details", box);
    if (pasted) pasted.open = false;
    take(box.dataset.role, sheet.soils.length > 1 ? `${sheet.id}#${sheet.soils[0].name}` : String(sheet.id));
  } catch (error) {
    show(problem, error.message);
  }
}

/** A sheet that the program has read and keeps. */
async function keep(name, content) {
  const sheet = await ask(`api/sheet?name=${encodeURIComponent(name)}`, content, "application/octet-stream");
  if (!state.sheets.some((one) => one.id === sheet.id)) state.sheets.push(sheet);
  return sheet;
}

/** Takes example sheets, each added once. */
async function tryExample(button) {
  const { base, filter, more } = button.dataset;
  show($("#try-problem"), "");
  try {
    const key = async (name) => {
      // A user's own sheet can have that name, too.
      let sheet = state.sheets.find((one) => one.id === state.examples[name]);
      if (!sheet) {
        const answer = await fetch("examples/" + name, { cache: "no-store", credentials: "same-origin" });
        if (!answer.ok) throw new Error("there is no such example");
        sheet = await keep(name, await answer.blob());
        state.examples[name] = sheet.id;
      }
      return sheet.soils.length > 1 ? `${sheet.id}#${sheet.soils[0].name}` : String(sheet.id);
    };
    [state.base, state.filter, state.more] = [await key(base), await key(filter), more ? [await key(more)] : []];
    remember();
    showSheets();
    showPair();
  } catch (error) {
    show($("#try-problem"), error.message);
  }
}

function take(role, key) {
  if (role === "more") {
    if (key && !state.more.includes(key) && state.more.length < 5) state.more.push(key);
  } else {
    state[role] = key;
  }
  remember();
  showSheets();
  showPair();
}

function setUpSheets() {
  for (const box of $$(".sheet")) {
    const role = box.dataset.role;
    const file = $("input[type=file]", box);
    file.addEventListener("change", async () => {
      for (const one of [...file.files]) await add(box, one.name, one);
      file.value = "";
    });
    for (const kind of ["dragenter", "dragover"]) {
      box.addEventListener(kind, (event) => { event.preventDefault(); box.classList.add("over"); });
    }
    box.addEventListener("dragleave", () => box.classList.remove("over"));
    box.addEventListener("drop", async (event) => {
      event.preventDefault();
      box.classList.remove("over");
      const files = [...event.dataTransfer.files];
      const text = event.dataTransfer.getData("text");
      if (!files.length && text) await add(box, `${role}.csv`, new Blob([text]));
      for (const one of role === "more" ? files : files.slice(0, 1)) await add(box, one.name, one);
    });
    const paste = $(".paste", box);
    if (paste) paste.addEventListener("click", () => add(box, `${role}.csv`, new Blob([$("textarea", box).value])));
    $(".which select", box).addEventListener("change", (event) => take(role, event.target.value));
  }
  for (const button of $$("#try button")) button.addEventListener("click", () => tryExample(button));
  for (const field of ["#dispersion", "#joint", "#as-given"]) $(field).addEventListener("change", showPair);
  for (const kind of ["dragover", "drop"]) document.addEventListener(kind, (event) => event.preventDefault());
}

function showSheets() {
  const all = soils();
  for (const role of ["base", "filter"]) if (!all.some((one) => one.key === state[role])) state[role] = "";
  state.more = state.more.filter((key) => all.some((one) => one.key === key));
  for (const box of $$(".sheet")) {
    const role = box.dataset.role;
    const select = $(".which select", box);
    const none = role === "more" ? "a sheet that is here" : "none yet";
    select.replaceChildren(el("option", { value: "" }, none),
      ...all.map((one) => el("option", { value: one.key, selected: one.key === state[role] }, one.label)));
    $(".which", box).hidden = all.length === 0;
    const several = $(".several", box);
    const sheet = several && state.sheets.find((one) => state[role].startsWith(`${one.id}#`));
    const listed = sheet && sheet.in_all > sheet.soils.length ? ` (the first ${sheet.soils.length} can be chosen)` : "";
    if (several) show(several, sheet ? `This sheet has ${sheet.in_all} soils${listed}: is it this one?` : "");
    box.classList.toggle("taken", role === "more" ? state.more.length > 0 : Boolean(state[role]));
  }
  $("#more").replaceChildren(...state.more.map((key) => el("li", {}, soilOf(key).label, el("button", {
    type: "button", "aria-label": "remove",
    onclick: () => { state.more = state.more.filter((one) => one !== key); take("none", ""); },
  }, "×"))));
  $("#judge-all").disabled = state.more.length === 0;
}

// --- Curves and rules.

const SIZES = [["D5", "d5_mm"], ["D15", "d15_mm"], ["D50", "d50_mm"], ["D85", "d85_mm"], ["D95", "d95_mm"],
  ["D100", "d100_mm"]];

async function showPair() {
  const both = Boolean(state.base && state.filter);
  const any = state.base || state.filter || state.more.length;
  $("#seen").hidden = !any;
  $("#how").hidden = !both;
  $("#judge-all").title = state.more.length ? "" : "add further filters";
  const query = new URLSearchParams();
  if (state.base) query.set("base", state.base);
  if (state.filter) query.set("filter", state.filter);
  if (state.more.length) query.set("more", state.more.join("\n"));
  if (ofSoils().length) query.set("changes", ofSoils().join("\n"));
  if ($("#as-given").checked) query.set("as_given", "1");
  $("#soil-options").hidden = !state.base;
  showSamples(query);
  if (!any || state.seen === String(query)) return;
  state.seen = String(query);
  showCurves(query);
  const shown = [["Base", state.base], ["Filter", state.filter], ...state.more.map((key) => ["More", key])]
    .filter(([, key]) => key).map(([role, key]) => [role, soilOf(key).soil]);
  const row = (name, of, long) => el("tr", { class: long ? "long" : null }, el("th", {}, name), ...shown.map(([, soil]) => el("td", { class: "n" }, of(soil))));
  $("#sizes").replaceChildren(
    el("thead", {}, el("tr", {}, el("th", {}, "Soil"), ...shown.map(([role, soil]) => el("th", { class: "n" }, role, el("br"), soil.name)))),
    el("tbody", {}, ...SIZES.map(([name, field]) => row(`${name}, mm`, (soil) => number(soil[field]))),
      row("Cu", (soil) => number(soil.cu)), row("Cc", (soil) => number(soil.cc)),
      row("fines, %", (soil) => number(soil.fines_percent)),
      row("ASTM D2487", (soil) => soil.class || "–", true),
      ...(shown.some(([, soil]) => soil.notes.length) ? [row("read as", (soil) => soil.notes.join("; ") || "–", true)] : [])));
  show($("#rules-problem"), "");
  if (!both) { $("#rules").replaceChildren(); return; }
  try {
    const pair = await ask("api/rules?" + query);
    if (state.seen === String(query)) showRules(pair);
  } catch (error) {
    $("#rules").replaceChildren();
    show($("#rules-problem"), error.message);
  }
}

/** The filter and all further filters. */
const filters = () => [state.filter, ...state.more];

/** The rules on every soil in the sheet of the base, if there are several. */
async function showSamples(query) {
  const sheet = state.sheets.find((one) => state.base.startsWith(`${one.id}#`));
  const into = $("#samples");
  into.hidden = !(sheet && state.filter);
  const asked = new URLSearchParams(query);
  asked.delete("more");
  asked.set("base", sheet ? String(sheet.id) : "");
  asked.set("filter", filters().join("\n"));
  if (into.hidden || state.samples === String(asked)) return;
  state.samples = String(asked);
  show($("#samples-problem"), "");
  $("#samples-csv").href = "samples.csv?" + asked;
  try {
    const table = await ask("api/samples?" + asked);
    if (state.samples !== String(asked)) return;
    $("#samples-said").replaceChildren(...table.filters.map(([first, ...rest]) => el("div", {}, el("p", {}, el("b", {}, first)), list(rest) || "")),
      ...(table.notes.length ? [list(table.notes)] : []));
    $("#samples-table").replaceChildren(...rowsOf(table));
  } catch (error) {
    for (const part of ["#samples-said", "#samples-table"]) $(part).replaceChildren();
    show($("#samples-problem"), error.message);
  }
}

/** The head of a table, and its body; the result of a row has the colour of its class. */
const headOf = (table) => el("thead", {}, el("tr", {}, ...table.headings.map((text, at) => el("th", { class: table.kinds[at] === "number" ? "n" : null }, text))));
function bodyOf(table, ...first) {
  const marked = (text, name) => (name ? el("span", { class: name }, name === "breaks" ? text.toUpperCase() : text) : text);
  return el("tbody", {}, ...first, ...table.rows.map((row, line) => el("tr", {}, ...row.map((text, at) => el(table.kinds[at] === "name" ? "th" : "td",
    { class: table.kinds[at] === "number" ? "n" : null }, table.kinds[at] === "result" ? marked(text, table.classes[line]) : text)))));
}
const rowsOf = (table) => [headOf(table), bodyOf(table)];

/** The samples of a sheet with their walks; the label is unique on the page. */
const samplesTable = (job, table) => scrolling(`the samples of job ${job.id} with their walks`, el("table", { class: "samples" }, ...rowsOf(table)));

/** Inserts the drawing into the page itself, so that its values can be read. */
async function showCurves(query) {
  const request = { cache: "no-store", credentials: "same-origin" };
  const drawn = await fetch("api/curves.svg?" + query, request).then((answer) => (answer.ok ? answer.text() : ""), () => "");
  if (state.seen !== String(query)) return;
  const svg = new DOMParser().parseFromString(drawn, "image/svg+xml").documentElement;
  const isDrawn = svg.nodeName === "svg";
  $("#curves").replaceChildren(...(isDrawn ? [document.importNode(svg, true)] : []));
  $("#read").textContent = isDrawn ? ASK : "The curves are not drawn.";
  if (isDrawn) readCurves($("#curves svg"));
}

const ASK = "Point at a curve, or use the arrow keys, to read its values.";

/** Shows the values of the point of a curve that is nearest to the pointer, or selected by the arrow keys. */
function readCurves(svg) {
  const curves = [...new Set($$("circle[pointer-events]", svg).map((spot) => spot.parentNode))]
    .map((curve) => $$("circle[pointer-events]", curve).map((spot) => {
      const title = $("title", spot);
      title.remove(); // otherwise the browser shows it over the curve as well
      return { x: Number(spot.getAttribute("cx")), y: Number(spot.getAttribute("cy")), text: title.textContent };
    }).sort((a, b) => a.x - b.x));
  if (!curves.length) return;
  const ring = el("circle", { r: 7, class: "ring", visibility: "hidden" });
  svg.append(ring);
  let at = null;
  const nearest = (spots, away) => spots.reduce((best, spot) => (away(spot) < away(best) ? spot : best));
  const read = (spot) => {
    at = spot;
    $("#read").textContent = spot ? spot.text : ASK;
    ring.setAttribute("visibility", spot ? "visible" : "hidden");
    if (spot) for (const [key, value] of [["cx", spot.x], ["cy", spot.y]]) ring.setAttribute(key, value);
  };
  const point = (event) => {
    const here = new DOMPoint(event.clientX, event.clientY).matrixTransform(svg.getScreenCTM().inverse());
    const away = (spot) => Math.hypot(spot.x - here.x, spot.y - here.y);
    const spot = nearest(curves.flat(), away);
    read(away(spot) < 60 ? spot : null);
  };
  for (const kind of ["pointermove", "pointerdown"]) svg.addEventListener(kind, point);
  svg.addEventListener("pointerleave", (event) => { if (event.pointerType === "mouse") read(null); });
  $("#curves").onkeydown = (event) => {
    const [along, across] = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key] || [0, 0];
    if (!along && !across) return;
    event.preventDefault();
    const row = Math.max(0, curves.findIndex((curve) => curve.includes(at)));
    if (!at) read(curves[0][0]);
    else if (along) read(curves[row][Math.min(curves[row].length - 1, Math.max(0, curves[row].indexOf(at) + along))]);
    else read(nearest(curves[(row + across + curves.length) % curves.length], (spot) => Math.abs(spot.x - at.x)));
  };
}

function showRules(pair) {
  const parts = pair.notes.map((note) => el("p", { class: "problem" }, note));
  const { base } = pair;
  parts.push(el("p", {}, `The base as practice reads it: D85 ${number(base.d85_mm)} mm, `, base.regraded
    ? `regraded on ${number(base.regraded_at_mm)} mm (as sampled ${number(base.d85_as_sampled_mm)} mm)` : "as sampled",
  `; ${pair.why}.`));
  parts.push(el("p", {}, el("b", {}, "Practice: "), `${pair.practice}.`));
  const { not_met: broken, open } = pair;
  if (broken.length) parts.push(el("p", {}, el("b", { class: "breaks" }, `${broken.length} not met: `), broken.join("; ")));
  if (open.length) parts.push(el("p", {}, el("b", {}, "No result: "), open.join("; ")));
  if (!broken.length && !open.length) parts.push(el("p", {}, "Every rule that was made for these soils is met. What the walk says is another question."));
  parts.push(el("p", {}, el("button", { type: "button", onclick: () => $("#how").scrollIntoView({ block: "start" }) }, "On to the walk")));
  const title = (part) => el("tr", {}, el("th", { colspan: part.headings.length }, el("b", {}, part.title)));
  const table = el("table", { class: "rules" }, headOf(pair.parts[0]), ...pair.parts.map((part) => bodyOf(part, title(part))));
  parts.push(el("details", { open: true }, el("summary", {}, "Every rule"), el("p", { class: "small" }, pair.rounded), scrolling("every rule", table)));
  $("#rules").replaceChildren(...parts);
}

// --- The form: every setting of a scene.

const FIRST = [["replicates", "Replicates"], ["seed", "Seed"], ["network.nz", "Layers"],
  ["network.thickness_mm", "Thickness to walk, mm"], ["filter.thickness_mm", "Real thickness, mm"],
  ["filter.grains_per_void", "Grains per void"], ["stop.decide_percent", "Certain to, % (adds replicates)"],
  ["base.mass_ratio", "Base by mass of filter"]];

async function setUpForm() {
  const form = await ask("api/form");
  const about = Object.fromEntries(form.keys.map((key) => [key.name, key]));
  const input = (key) => el("input", { type: "text", "data-key": key.name, title: key.doc, autocomplete: "off",
    placeholder: (key.is_set ? "" : "e.g. ") + key.shown });
  $("#density").append(...form.densities.map((word) => el("option", { value: word }, word)));
  $("#first").append(
    el("label", {}, "Published curve", el("select", { "data-key": "filter.curve", title: about["filter.curve"].doc },
      el("option", { value: "" }, "none"), ...form.curves.map((curve) => el("option", { value: curve.name }, `${curve.name}: ${curve.title}`)))),
    ...FIRST.filter(([name]) => about[name]).map(([name, label]) => el("label", {}, label, input(about[name]))));
  const own = ["base.sieve", "filter.sieve", "filter.measured", "filter.density", "filter.library", "filter.curve", "base.dispersive", "base.regrade", "filter.joint_mm", ...FIRST.map(([name]) => name)];
  const sections = [...new Set(form.keys.map((key) => key.section))];
  $("#all").append(...sections.map((section) => {
    const keys = form.keys.filter((key) => key.section === section && !own.includes(key.name));
    return keys.length ? el("div", {}, el("h3", {}, section || "of the whole walk"), el("div", { class: "fields" },
      ...keys.map((key) => el("label", {}, el("code", {}, key.name), input(key), el("span", {}, key.doc))))) : null;
  }).filter(Boolean));
  $("#form").addEventListener("submit", (event) => { event.preventDefault(); start("judge"); });
  $("#judge-all").addEventListener("click", () => walkFilters("filters", "#form-problem"));
  $("#walk-samples").addEventListener("click", () => walkFilters($("#samples-walks").value, "#walk-problem"));
  $("#check").addEventListener("click", check);
}

/** The facts stated about the soils beside the rules, as settings. */
function ofSoils() {
  const joint = $("#joint").value.trim();
  return [...($("#dispersion").value ? [`base.dispersive=${$("#dispersion").value}`] : []), ...(joint ? [`filter.joint_mm=${joint}`] : [])];
}

/** The options for reading the two sheets. */
const taken = () => ({ as_sampled: $("#as-sampled").checked, as_given: $("#as-given").checked });

function asked() {
  const changes = $$("[data-key]").filter((field) => field.value.trim())
    .map((field) => `${field.dataset.key}=${field.value.trim()}`);
  changes.push(...ofSoils());
  changes.push(...$("#free").value.split("\n").map((line) => line.trim()).filter(Boolean));
  return { base: state.base, filter: state.filter, density: $("#density").value, pack: $("#pack").checked, quick: $("#quick").checked, ...taken(), changes };
}

/** Walks the base, or every sample of its sheet, against every filter, with the settings of the form. */
async function walkFilters(walks, problem) {
  show($(problem), "");
  const { density, pack, as_sampled, as_given, changes } = asked();
  const quick = walks === "filters" && $("#quick").checked;
  try {
    await ask("api/batch", { base: state.base, filters: filters(), walks, density, pack, quick, as_sampled, as_given, changes });
    await poll();
    $("#results").scrollIntoView({ block: "start" });
  } catch (error) {
    show($(problem), error.message);
  }
}

async function start(kind) {
  show($("#form-problem"), "");
  $("#checked").hidden = true;
  try {
    await ask("api/" + kind, asked());
    await poll();
    $("#results").scrollIntoView({ block: "start" });
  } catch (error) {
    show($("#form-problem"), error.message);
  }
}

async function check() {
  show($("#form-problem"), "");
  const into = $("#checked");
  into.hidden = true;
  try {
    const check = await ask("api/check", asked());
    const rows = [["base particles", whole(check.n_base) + " a run"], ["runs to walk", whole(check.runs_to_walk)],
      ["voids", whole(check.inputs.network.voids)], ["memory", check.memory],
      ["time to walk", `about ${number(check.core_seconds)} s of one core, a rough guess`]];
    if (check.packing) {
      rows.push(["packing", check.packing.is_made ? "made already"
        : `${whole(check.packing.grains)} grains, about ${number(check.packing.core_seconds)} s of one core, once`]);
    }
    into.replaceChildren(el("table", {}, el("tbody", {}, ...rows.map(([name, value]) => el("tr", {}, el("th", {}, name), el("td", {}, value))))),
      ...(check.refusal ? [el("p", { class: "problem" }, check.refusal)] : []),
      ...(check.notes.length ? [el("ul", {}, ...check.notes.map((note) => el("li", {}, note)))] : []));
    into.hidden = false;
  } catch (error) {
    show($("#form-problem"), error.message);
  }
}

// --- Jobs.

const RUNS = ["first run", "second run"];

/** A drawing of the eroded mass of each run with its interval, and of the threshold. */
function plot(runs) {
  const bottom = 26 * runs.length + 16;
  const x = (share) => 84 + 290 * Math.min(1, Math.max(0, share));
  const parts = [el("rect", { x: 84, y: 8, width: 290, height: bottom - 8, fill: "none", stroke: "#888" })];
  for (const share of [0, 0.25, 0.5, 0.75, 1]) {
    parts.push(el("text", { x: x(share), y: bottom + 16, "text-anchor": "middle" }, `${100 * share}`));
  }
  parts.push(el("line", { x1: x(0.075), x2: x(0.075), y1: 8, y2: bottom, stroke: "#1a1a1a", "stroke-dasharray": "5 4" }));
  runs.forEach((run, at) => {
    const [y, colour] = [25 + 26 * at, at ? "#8E3F6C" : "#00598C"];
    parts.push(el("text", { x: 78, y: y + 4, "text-anchor": "end" }, RUNS[at]));
    if (run.low !== null) {
      parts.push(el("line", { x1: x(run.low), x2: x(run.high), y1: y, y2: y, stroke: colour, "stroke-width": 3 }));
      for (const end of [run.low, run.high]) parts.push(el("line", { x1: x(end), x2: x(end), y1: y - 7, y2: y + 7, stroke: colour, "stroke-width": 1.5 }));
    }
    parts.push(el("circle", { cx: x(run.mean), cy: y, r: 3.5, fill: run.low === null ? "#fff" : colour, stroke: colour, "stroke-width": 1.5 }));
  });
  const label = runs.map((run, at) => `${RUNS[at]} ${eroded(run)}`).join(", ");
  return [el("svg", { class: "plot", viewBox: `0 0 390 ${bottom + 24}`, role: "img", "aria-label": label }, ...parts),
    el("p", { class: "small" }, "Base eroded, percent by mass; dashed: 7.5\u202f%, which divides the classes.")];
}

const eroded = (run) => percent(run.mean) + (run.low === null ? ", no interval from one replicate"
  : ` (95 % interval ${percent(run.low)} to ${percent(run.high)})`);

/** The colour of a card, from the colour of the first page. */
const COLOURS = { none: "green", some: "amber", doubted: "amber", continuing: "red" };

const list = (items) => (items && items.length ? el("ul", {}, ...items.map((item) => el("li", {}, item))) : null);

/** The result of a walk so far, which is never a verdict. */
function soFar(job) {
  const live = job.live;
  const parts = [];
  if (live.packing) {
    parts.push(el("p", {}, `Packing the filter: ${whole(live.packing.grains)} grains, step ${whole(live.packing.steps)} of about ${whole(live.packing.usual)}`),
      el("progress", { max: Math.max(1, live.packing.usual), value: Math.min(live.packing.steps, live.packing.usual) }));
  } else if (live.waits_for_packing) {
    parts.push(el("p", {}, "Another process packs this filter; it is waited for."));
  } else if (live.cases) {
    parts.push(el("p", {}, `${live.cases_done} of ${live.cases} cases are done` + (live.case && !live.walking.length && live.cases_done < live.cases ? `; at ${live.case}` : "")),
      el("progress", { max: live.cases, value: live.cases_done + live.walking.reduce((sum, one) => sum + one.done / Math.max(1, one.runs), 0) }),
      list(live.walking.map((one) => `${one.case}: ${whole(one.done)} of ${whole(one.runs)} runs are walked`)));
  } else if (live.runs) {
    parts.push(el("p", {}, `${whole(live.runs_done)} of ${whole(live.runs)} runs are walked`), el("progress", { max: live.runs, value: live.runs_done }));
  } else {
    parts.push(el("p", {}, "Begins."));
  }
  if (live.table) parts.push(samplesTable(job, live.table));
  if (live.so_far) {
    const { replicates, runs, few } = live.so_far;
    const of = job.replicates ? ` of ${job.replicates}` : "";
    const words = live.so_far.class ? `So far: ${live.so_far.class}, by the curve itself` : `Too few replicates for a class (fewer than ${few})`;
    parts.push(el("p", { class: "so-far" }, words), el("p", { class: "small" },
      `${replicates}${of} replicates. This is no verdict: more are to come, and so are the rules, the doubts and what else is walked.`),
      ...plot(runs), list(runs.map((run, at) => `${RUNS[at]}: ${eroded(run)}`)));
  }
  return parts;
}

/** The lines with which every interface begins. */
const answer = (lines) => lines.map(([name, words]) => el("p", { class: "practice" }, el("b", {}, name), `: ${words}.`));

/** At most three notes; the rest is collapsed. */
const notes = (all) => [list(all.slice(0, 3)),
  all.length > 3 ? el("details", {}, el("summary", {}, `and ${all.length - 3} more`), list(all.slice(3))) : null];

function verdictOf(job) {
  const done = job.result;
  if (job.kind === "batch") {
    return [...done.filters.map(([first, ...rest]) => el("div", {}, el("p", {}, el("b", {}, first)), list(rest) || "")), samplesTable(job, done),
      list(done.notes), el("p", { class: "small" }, done.leaves_out)];
  }
  return [...answer(done.lines), ...plot(done.runs), ...notes(done.notes)];
}

function card(job) {
  const act = (what) => async () => {
    let problem = "";
    try { await ask(`api/${what}?id=${job.id}`, ""); } catch (error) { problem = error.message; }
    await poll();
    const shown = $(`.job[data-id="${job.id}"] .actions .small`);
    if (problem && shown) shown.textContent = problem;
  };
  const isDone = job.state === "done" && job.result;
  const kind = isDone && job.kind === "judge" ? COLOURS[job.result.colour] || ""
    : job.state;
  const words = { waiting: `waits, ${job.before} before it`, running: job.stopping ? "stops, and saves what is done" : "is walked", stopped: "stopped",
    done: "", refused: "refused", failed: "failed" }[job.state];
  const parts = [el("h3", {}, job.title, words ? el("span", { class: "small" }, ` ${words}`) : "")];
  if (job.message) parts.push(el("p", { class: job.state === "stopped" ? "small" : "problem" }, job.message));
  if (job.state === "running") parts.push(...soFar(job));
  if (job.state === "done" && job.result) parts.push(...verdictOf(job));
  const warnings = job.live.warnings;
  if (job.state === "running" && warnings.length) parts.push(el("details", {}, el("summary", {}, `${warnings.length} to know`), list(warnings)));
  parts.push(el("p", { class: "actions" },
    job.page ? el("a", { href: job.page, target: "_blank", rel: "noopener" }, "The page, to read or print") : null,
    job.page ? el("button", { type: "button", onclick: () => printPage(job.page) }, "Print, or save as PDF") : null,
    ["done", "stopped", "failed"].includes(job.state) ? el("a", { href: `zip/${job.folder}.zip` }, "The folder (.zip)") : null,
    ["waiting", "running"].includes(job.state) && !job.stopping ? el("button", { type: "button", onclick: act("stop") }, "Stop") : null,
    job.can_continue ? el("button", { type: "button", onclick: act("continue") }, "Continue") : null,
    el("span", { class: "small" }, job.path)));
  return el("article", { class: `job ${kind}`, "data-id": job.id, "data-state": job.state }, ...parts);
}

/** Opens a page of results and the browser's print dialog, which also saves PDFs; the page itself runs no script. */
function printPage(page) {
  const opened = open(page, "_blank");
  if (opened) opened.addEventListener("load", () => opened.print());
}

const cards = new Map();

// A card replaced between a press and its release would lose the click.
let pressed = false;
addEventListener("pointerdown", () => { pressed = true; });
for (const kind of ["pointerup", "pointercancel"]) addEventListener(kind, () => setTimeout(() => { pressed = false; }, 50));

function showJobs() {
  if (pressed) return;
  $("#results").hidden = state.jobs.length === 0;
  const shown = state.jobs.map((job) => {
    const text = JSON.stringify(job);
    const old = cards.get(job.id);
    if (old && old.text === text) return old.card;
    const made = card(job);
    // Details opened or closed by hand stay so while the numbers change.
    if (old) $$("details", made).forEach((one, at) => { const before = $$("details", old.card)[at]; if (before && old.state === job.state) one.open = before.open; });
    cards.set(job.id, { text, card: made, state: job.state });
    return made;
  });
  const into = $("#jobs");
  if (shown.length === into.children.length && shown.every((one, at) => into.children[at] === one)) return;
  // Keyboard users keep their place, too.
  const at = document.activeElement;
  const held = at && into.contains(at) ? [at.closest(".job").dataset.id, at.textContent] : null;
  into.replaceChildren(...shown);
  const same = held && $$("a, button, summary", into).find((one) => one.closest(".job").dataset.id === held[0] && one.textContent === held[1]);
  if (same) same.focus();
}

let timer = 0;

async function poll() {
  clearTimeout(timer);
  let wait = 2500;
  try {
    const said = await ask(`api/state?have=${state.sheets.length}`);
    $("#gone").hidden = true;
    show($("#version"), said.version);
    show($("#folder"), said.folder);
    show($("#again"), said.folder);
    show($("#largest"), String(said.largest_mb));
    state.largest = said.largest_mb;
    $("#template").hidden = !said.has_template;
    state.jobs = said.jobs;
    if (said.sheets) {
      state.sheets = said.sheets;
      showSheets();
    }
    showJobs();
    if (said.jobs.some((job) => ["running", "waiting"].includes(job.state))) wait = 500;
  } catch {
    $("#gone").hidden = false;
  }
  timer = setTimeout(poll, wait);
}

async function begin() {
  recall();
  setUpSheets();
  await poll();
  // A new tab takes the sheets of the newest job.
  const newest = state.jobs.find((job) => job.asked);
  if (!state.base && !state.filter && newest) [state.base, state.filter] = [newest.asked.base, newest.asked.filter];
  showSheets();
  try { await setUpForm(); } catch (error) { show($("#form-problem"), error.message); }
  showPair();
}

begin();
