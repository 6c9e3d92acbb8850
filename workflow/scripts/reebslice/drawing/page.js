"use strict";
// The page around the model: choices, the graph by height, the figures of what is pointed at, the tables.
// The model in space is in page_view.js; without WebGL all else works.

// The scene: binary glTF, its JSON, and what that tells of the whole and of each part.
let [BYTES, SCENE, FACTS, PARTS] = [];
const HINT = "Point at a line, a node or the surface, or touch it, to see its figures; a click keeps them.";
const state = { graph: null, lit: undefined, kept: null, level: 0 };
const find = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];
let view = null;

/** Unpack the scene that the page carries, and read the JSON of its first chunk. */
async function readScene() {
  const packed = Uint8Array.from(atob(find("#glb").textContent), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("deflate"));
  BYTES = new Uint8Array(await new Response(stream).arrayBuffer());
  const length = new DataView(BYTES.buffer).getUint32(12, true);
  SCENE = JSON.parse(new TextDecoder().decode(BYTES.subarray(20, 20 + length)));
  FACTS = SCENE.extras;
  PARTS = Object.fromEntries(SCENE.meshes.map((mesh) => [mesh.name, mesh.extras]));
}

/** Nodes and arcs of a graph. */
function graphOf(name) {
  return { nodes: PARTS[`${name} nodes`]?.nodes ?? [], arcs: PARTS[`${name} arcs`]?.arcs ?? [] };
}

/** A figure with its unit; power 2 is an area, 3 a volume. */
function figure(value, power = 1) {
  if (value === undefined || value === null) return "\u2013";
  const text = String(Number(value.toPrecision(5))).replace("-", "\u2212");
  return FACTS.unit ? `${text}\u00a0${FACTS.unit}${["", "", "\u00b2", "\u00b3"][power]}` : text;
}

function element(name, text, parent) {
  const made = document.createElement(name);
  made.textContent = text;
  parent?.append(made);
  return made;
}

// ---------------------------------------------------------------- figures

function happening(node) {
  return FACTS.happenings[node.change] ?? (node.operation || "several events");
}

function nameNode(node) {
  return `${node.operation || "several events"} ${node.handle}: ${happening(node)}, at ${figure(node.height)}`;
}

/** Title and rows of what is pointed at: {kind, number}. */
function tell({ kind, number }) {
  const { nodes, arcs } = graphOf(state.graph);
  const words = (state.graph ?? "").replace("_", ", ");
  if (kind === "arc") {
    const arc = arcs[number];
    const rows = [
      ["from", nameNode(nodes[arc.ends[0]])],
      ["to", nameNode(nodes[arc.ends[1]])],
    ];
    rows.push(["heights", `${figure(arc.lower)} to ${figure(arc.upper)}`]);
    if (arc.length !== undefined) rows.push(["length", figure(arc.length)]);
    if (arc.volume !== undefined) rows.push(["volume", figure(arc.volume, 3)]);
    if (arc.area !== undefined) rows.push(["area", figure(arc.area, 2)]);
    if (arc.inner !== undefined) rows.push(["it is", arc.inner ? "the wall of a hole" : "an outer wall"]);
    return [`Arc ${number} of the ${words} graph`, rows];
  }
  if (kind === "node") {
    const node = nodes[number];
    const side = node.side === "B" ? "B: void appears as the height rises" : "A: material appears as the height rises";
    const rows = [
      ["event", happening(node)],
      ["side", side],
      ["height", figure(node.height)],
    ];
    if (node.n_handles > 1) rows.push(["stands for", `${node.n_handles} events`]);
    rows.push(["vertex", vertexOf(node)]);
    return [`Node ${node.handle}: ${node.operation || "several events"}`, rows];
  }
  if (kind === "loop") {
    const loop = PARTS["loop circles"].loops[number];
    const rows = [
      ["thinnest at", figure(loop.height)],
      ["widest round bar or pin", figure(2 * loop.inscribed_radius)],
    ];
    rows.push(["perimeter there", figure(loop.perimeter)], ["section", figure(loop.section, 2)]);
    rows.push(["length of the path", figure(loop.length)]);
    rows.push(["heights", `${figure(loop.bottom_height)} to ${figure(loop.top_height)}`]);
    return [`Loop ${number}: ${loop.kind}${loop.inner ? ", around a hole" : ", around material"}`, rows];
  }
  const pocket = PARTS[kind].pockets[number];
  const rows = [["heights", `${figure(pocket.begin_height)} to ${figure(pocket.end_height)}`]];
  return [`${pocket.kind} ${number}`, [...rows, ["volume", figure(pocket.volume, 3)]]];
}

function showFigures(what) {
  const box = find("#told");
  const [title, rows] = tell(what);
  box.replaceChildren();
  element("h3", title, box);
  const list = element("dl", "", box);
  for (const [name, value] of rows) {
    element("dt", name, list);
    element("dd", value, list);
  }
}

// ---------------------------------------------------------------- lighting

/** Light one thing everywhere: in space, in the flat graph, in the tables. */
function light(what) {
  const same = JSON.stringify(what) === JSON.stringify(state.lit);
  if (same) return;
  state.lit = what;
  all(".lit:not(.line)").forEach((lit) => lit.classList.remove("lit"));
  if (what) {
    const place = what.kind === "arc" || what.kind === "node" ? `[data-graph="${state.graph}"] ` : "";
    all(`${place}[data-${what.kind}="${what.number}"]:not(.hit)`).forEach((lit) => lit.classList.add("lit"));
    showFigures(what);
  } else {
    find("#told").replaceChildren();
    element("p", HINT, find("#told"));
  }
  view?.light(what);
}

/** Light what is pointed at, or, where nothing is, what was kept. */
const point = (what) => light(what ?? state.kept);

/** The critical vertex of a node; a node of the solid's graph lies in the material, apart from it. */
function vertexOf(node) {
  return [node.vertex_x ?? node.x, node.vertex_y ?? node.y, node.vertex_z ?? node.z].join(" ");
}

/** Keep what was clicked lit; copy the vertex of a node. */
function keep(what, place) {
  state.kept = what;
  light(what);
  const node = what?.kind === "node" ? graphOf(state.graph).nodes[what.number] : null;
  if (node) copy(vertexOf(node), "Vertex");
  else if (place) copy(place, "Point on the surface");
}

async function copy(text, name) {
  let done = true;
  try {
    await navigator.clipboard.writeText(text);
  } catch {
    const area = element("textarea", text, document.body);
    area.select();
    done = document.execCommand("copy");
    area.remove();
  }
  find("#told .copied")?.remove();
  element("p", done ? `${name} copied: ${text}` : `${name}, to be copied by hand: ${text}`, find("#told")).className =
    "copied";
}

// ---------------------------------------------------------------- level, graph, layers

function setLevel(place) {
  const { levels, heights, contours, level, region } = PARTS.contours;
  state.level = place;
  const own = contours.map((_, k) => k).filter((k) => level[k] === levels[place]);
  const regions = new Set(own.map((k) => region[k])).size;
  const counts = `${own.length} contour${own.length === 1 ? "" : "s"}, ${regions} region${regions === 1 ? "" : "s"}`;
  find("#height").value = `${figure(heights[place])} \u2014 ${counts}`;
  find("#level").setAttribute("aria-valuetext", find("#height").value);
  for (const drawing of all("svg.flat")) {
    const { low, high, top, bottom } = drawing.dataset;
    const row = +bottom - ((heights[place] - low) / (high - low || 1)) * (bottom - top);
    drawing.querySelector(".level").setAttribute("transform", `translate(0 ${row - top})`);
  }
  view?.setLevel(place);
}

function setGraph(name) {
  state.graph = name;
  state.kept = null;
  light(null);
  all("svg.flat, .arcs").forEach((part) => part.toggleAttribute("hidden", part.dataset.graph !== name));
  sayWhichGraph();
  view?.setGraph(name);
}

/** Say what the graph is, and whether there is more of its drawing than can be seen at once. */
function sayWhichGraph() {
  const { scrollWidth, clientWidth } = find("#flat");
  const more = scrollWidth > clientWidth ? "The drawing is wider than its frame: scroll it sideways." : "";
  find("#graph-words").textContent = `${find("#graph").selectedOptions[0]?.dataset.words ?? ""} ${more}`.trim();
}

function addLayers() {
  const count = (name, rows) => PARTS[name]?.[rows]?.length ?? 0;
  const sealed = PARTS.pockets?.pockets.some((pocket) => pocket.kind === "sealed");
  const kinds = [
    ["surface", "surface", true, 1],
    ["parts", "colour its parts", false, count("surface arcs", "arcs") > 1],
    ["contours", "all contours", false, count("contours", "levels")],
    ["slice", "level", true, count("contours", "levels")],
    ["graph", "graph", true, Boolean(state.graph)],
    ["loops", `loops (${count("loop circles", "loops")})`, true, count("loop circles", "loops")],
    ["pockets", `pockets (${count("pockets", "pockets")})`, Boolean(sealed), count("pockets", "pockets")],
    ["islands", `islands (${count("islands", "pockets")})`, false, count("islands", "pockets")],
  ];
  for (const [name, words, shown, there] of kinds.filter((kind) => kind[3])) {
    const label = element("label", "", find("#layers"));
    const box = element("input", "", label);
    box.type = "checkbox";
    box.checked = shown;
    label.append(` ${words}`);
    box.addEventListener("change", () => view?.setLayer(name, box.checked));
    view?.setLayer(name, shown);
  }
}

/** Have the flat drawings and the tables light what they are about. */
function listen() {
  for (const drawing of all("svg.flat")) {
    for (const arc of drawing.querySelectorAll(".arc")) {
      const hit = arc.cloneNode();
      hit.setAttribute("class", "hit");
      arc.before(hit);
    }
    drawing.addEventListener("click", (event) => pickLevel(event, drawing));
  }
  const targets = ["arc", "node", "loop", "pockets", "islands"];
  for (const target of all(targets.map((kind) => `[data-${kind}]`).join())) {
    const kind = targets.find((name) => target.dataset[name] !== undefined);
    const what = { kind, number: Number(target.dataset[kind]) };
    for (const name of ["pointerenter", "focus"]) target.addEventListener(name, () => point(what));
    for (const name of ["pointerleave", "blur"]) target.addEventListener(name, () => point(null));
    target.addEventListener("click", (event) => {
      event.stopPropagation();
      keep(what);
    });
    target.addEventListener("keydown", (event) => {
      if (event.key === "Enter") keep(what);
    });
  }
}

/** Go to the level nearest to where an empty place of the flat drawing was clicked. */
function pickLevel(event, drawing) {
  const heights = PARTS.contours?.heights;
  if (!heights) return;
  const { low, high, top, bottom } = drawing.dataset;
  const box = drawing.getBoundingClientRect(); // where there is little room, the drawing is smaller than it was made
  const row = ((event.clientY - box.top) * drawing.viewBox.baseVal.height) / box.height;
  const height = Number(low) + ((bottom - row) / (bottom - top)) * (high - low);
  const away = heights.map((one) => Math.abs(one - height));
  find("#level").value = away.indexOf(Math.min(...away));
  setLevel(Number(find("#level").value));
}

async function start() {
  await readScene();
  listen();
  state.graph = find("#graph").value || null;
  try {
    view = await makeView(find("#stage"), BYTES, { FACTS, PARTS, SCENE }, { point, keep });
  } catch (fault) {
    find("#nothing").textContent = `The model cannot be shown in space here, all else can: ${fault.message}`;
    find("#nothing").hidden = false;
  }
  addLayers();
  setGraph(state.graph);
  find("#graph").addEventListener("change", (event) => setGraph(event.target.value));
  addEventListener("resize", sayWhichGraph);
  find("#cut").addEventListener("change", (event) => view?.setCut(event.target.checked));
  all("[data-turn]").forEach((button) => button.addEventListener("click", () => view?.turn(button.dataset.turn)));
  if (PARTS.contours) {
    const slider = find("#level");
    slider.max = PARTS.contours.levels.length - 1;
    slider.value = Math.floor(slider.max / 2);
    slider.addEventListener("input", () => setLevel(Number(slider.value)));
    setLevel(Number(slider.value));
  }
  document.body.dataset.ready = "yes";
}

document.addEventListener("DOMContentLoaded", start);
