"use strict";
// The table of the report: its rows, chosen, sorted and shown some at a time, and the bars that choose among them.

const DATA = JSON.parse(document.querySelector("#data").textContent);
const SHOWN = 50; // rows at a time
const LONG = 150; // letters of a reason, beyond which it is opened by a click
const find = (selector) => document.querySelector(selector);
const all = (selector) => [...document.querySelectorAll(selector)];
const state = { look: null, key: "kind", down: false, page: 0, rows: [] };
const compare = new Intl.Collator("en", { numeric: true }).compare;

function element(name, text, parent, kind = "") {
  const made = document.createElement(name);
  made.textContent = text;
  if (kind) made.className = kind;
  parent?.append(made);
  return made;
}

/** A name as text that may go on in the next line after _, -, / and the like, rather than within a word. */
function addName(name, parent) {
  for (const part of name.split(/(?<=[_./-])(?=\w)/)) {
    if (parent.childNodes.length) element("wbr", "", parent);
    parent.append(part);
  }
}

/** A figure as people read it, with the unit of its model; power 2 is an area, 3 a volume. */
function write({ values, power }, row) {
  const value = values[row];
  if (value === null || value === undefined) return "\u2013";
  const text = Number.isInteger(value) ? value.toLocaleString("en") : String(Number(value.toPrecision(4)));
  const unit = power && DATA.units[row] ? `\u00a0${DATA.units[row]}${["", "", "\u00b2", "\u00b3"][power]}` : "";
  return text.replace("-", "\u2212") + unit;
}

/** The columns: what each is sorted by, and how its cell is filled. */
const COLUMNS = [
  { key: "model", label: "model", shown: true, sort: (a, b) => compare(DATA.models[a], DATA.models[b]), fill: fillModel },
  { key: "kind", label: "verdict, reason", shown: true, sort: (a, b) => DATA.kind[a] - DATA.kind[b], fill: fillKind },
  ...DATA.figures.map((figure) => ({
    key: figure.name,
    label: figure.label,
    words: figure.words,
    shown: figure.shown,
    number: true,
    sort: (a, b) => figure.values[a] - figure.values[b],
    known: (row) => figure.values[row] !== null,
    fill: (cell, row) => {
      cell.className = "number";
      cell.dataset.label = figure.label;
      cell.textContent = write(figure, row);
    },
  })),
];

/** The relative address of a file of a model, or null where it is not there. */
function address(row, place) {
  return DATA.files[row] & (1 << place) ? `${DATA.folder}${encodeURIComponent(DATA.models[row])}/${DATA.linked[place][0]}` : null;
}

function addThumbnail(row, parent) {
  const frame = element("div", DATA.thumbnails[row] ? "" : "no picture", parent, "thumbnail");
  if (!DATA.thumbnails[row]) return;
  const picture = element("img", "", frame);
  picture.loading = "lazy";
  picture.alt = "";
  const own = `${DATA.folder}${encodeURIComponent(DATA.models[row])}/thumbnail.png`;
  picture.src = DATA.thumbnails[row] === 1 ? own : `data:image/png;base64,${DATA.thumbnails[row]}`;
}

function fillModel(cell, row) {
  const links = DATA.linked.map(([, words], place) => [address(row, place), words]).filter(([to]) => to);
  const box = element("div", "", cell, "model");
  addThumbnail(row, box);
  const words = element("div", "", box);
  const name = element(links.length ? "a" : "span", "", words, "name");
  addName(DATA.models[row], name);
  if (links.length) name.href = links[0][0];
  addName(DATA.paths[row], element("small", "", words));
  const more = element("small", "", words);
  for (const [to, what] of links) {
    if (more.childNodes.length) more.append(" \u00b7 ");
    const link = element("a", what, more);
    link.href = to;
    link.setAttribute("aria-label", `${what} of ${DATA.models[row]}`);
  }
}

function fillKind(cell, row) {
  const [kind, words] = DATA.kinds[DATA.kind[row]];
  cell.className = "why";
  element("span", words, cell, `verdict ${kind}`);
  const reason = DATA.reasons[DATA.reason[row]];
  if (reason.length > LONG) element("span", reason, element("summary", "", element("details", "", cell)));
  else if (reason) element("p", reason, cell);
}

// ---------------------------------------------------------------- choosing

function limits() {
  const figure = DATA.figures.find(({ name }) => name === find("#figure").value);
  const [low, high] = ["#low", "#high"].map((field) => (find(field).value === "" ? null : Number(find(field).value)));
  return figure && (low !== null || high !== null) ? { figure, low: low ?? -Infinity, high: high ?? Infinity } : null;
}

/** Choose the rows that the form asks for, and sort them. */
function choose() {
  const words = find("#search").value.toLowerCase().split(/\s+/).filter(Boolean);
  const kinds = new Set(all("#kinds input:checked").map((box) => Number(box.value)));
  const range = limits();
  const within = state.look === null ? DATA.models.map((_, row) => row) : DATA.looks[state.look];
  state.rows = within.filter((row) => {
    if (!kinds.has(DATA.kind[row])) return false;
    if (range) {
      const value = range.figure.values[row];
      if (value === null || value < range.low || value > range.high) return false;
    }
    if (!words.length) return true;
    const text = `${DATA.models[row]} ${DATA.paths[row]} ${DATA.reasons[DATA.reason[row]]}`.toLowerCase();
    return words.every((word) => text.includes(word));
  });
  const column = COLUMNS.find(({ key }) => key === state.key);
  const known = column.known ?? (() => true);
  state.rows.sort((a, b) => known(b) - known(a) || (state.down ? column.sort(b, a) : column.sort(a, b)) || a - b);
  state.page = 0;
  for (const bar of all("#charts g[role]")) {
    const { figure, low, high } = bar.dataset;
    const own = range && range.figure.name === figure && range.low === Number(low) && range.high === Number(high);
    bar.setAttribute("aria-pressed", Boolean(own));
  }
  show();
}

function show() {
  const shown = COLUMNS.filter((column) => column.shown);
  const head = element("tr", "");
  for (const column of shown) {
    const cell = element("th", "", head, column.number ? "number" : "");
    cell.scope = "col";
    if (column.key === state.key) cell.setAttribute("aria-sort", state.down ? "descending" : "ascending");
    const mark = column.key === state.key ? (state.down ? " \u25be" : " \u25b4") : "";
    const button = element("button", column.label + mark, cell);
    button.type = "button";
    button.dataset.sort = column.key;
    if (column.words) button.title = column.words;
  }
  const first = state.page * SHOWN;
  const rows = state.rows.slice(first, first + SHOWN).map((row) => {
    const line = element("tr", "");
    shown.forEach((column, place) => {
      const cell = element(place ? "td" : "th", "", line);
      if (!place) cell.scope = "row";
      column.fill(cell, row);
    });
    return line;
  });
  find("#table thead").replaceChildren(head);
  find("#table tbody").replaceChildren(...rows);
  find("#table").scrollTop = 0;
  const count = (number) => number.toLocaleString("en");
  const part = rows.length ? `, ${count(first + 1)} to ${count(first + rows.length)} here` : "";
  const look = state.look === null ? "" : " with the same reason";
  find("#count").value = `${count(state.rows.length)} of ${count(DATA.models.length)} models${look}${part}`;
  for (const button of all("[data-go]")) {
    const page = state.page + Number(button.dataset.go);
    button.disabled = page < 0 || page * SHOWN >= state.rows.length;
    button.hidden = state.rows.length <= SHOWN;
  }
}

// ---------------------------------------------------------------- the form

function addCheckbox(parent, words, value, checked) {
  const label = element("label", "", parent);
  const box = element("input", "", label);
  box.type = "checkbox";
  box.value = value;
  box.defaultChecked = checked;
  label.append(` ${words}`);
  return box;
}

function fillForm() {
  DATA.kinds.forEach(([, words], place) => {
    const count = DATA.kind.filter((kind) => kind === place).length;
    if (count) addCheckbox(find("#kinds"), `${words} (${count.toLocaleString("en")})`, place, true);
  });
  for (const figure of DATA.figures) {
    const option = element("option", figure.label, find("#figure"));
    option.value = figure.name;
    option.title = figure.words;
  }
  find("#range").hidden = !DATA.figures.length;
  for (const column of COLUMNS.slice(1)) {
    const box = addCheckbox(find("#columns fieldset"), column.label, column.key, column.shown);
    if (column.words) box.parentNode.title = column.words;
    box.addEventListener("change", () => {
      column.shown = box.checked;
      show();
    });
  }
}

/** Choose what a bar counts; the bar that is chosen already, all. */
function press(bar) {
  const taken = bar.getAttribute("aria-pressed") === "true";
  find("#figure").value = bar.dataset.figure;
  find("#low").value = taken ? "" : bar.dataset.low;
  find("#high").value = taken ? "" : bar.dataset.high;
  choose();
}

function sortBy(key) {
  const column = COLUMNS.find((one) => one.key === key);
  state.down = state.key === key ? !state.down : Boolean(column.number); // of figures the largest first
  state.key = key;
  choose();
  find(`[data-sort="${key}"]`).focus();
}

function lookAt(look) {
  find("#choice").reset();
  state.look = look;
  choose();
  find("#choice").scrollIntoView();
  find("#table").focus({ preventScroll: true });
}

function listen() {
  const form = find("#choice");
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(() => { // once the fields are as they were
    for (const column of COLUMNS.slice(1)) {
      column.shown = all("#columns input").find((box) => box.value === column.key).checked;
    }
    choose();
  }));
  find("#all").addEventListener("click", () => (state.look = null));
  for (const field of ["#search", "#kinds", "#range"]) find(field).addEventListener("input", choose);
  for (const bar of all("#charts g[role]")) {
    bar.addEventListener("click", () => press(bar));
    bar.addEventListener("keydown", (event) => {
      if (event.key !== "Enter" && event.key !== " ") return;
      event.preventDefault();
      press(bar);
    });
  }
  document.addEventListener("click", (event) => {
    const { sort, go, look } = event.target.dataset ?? {};
    if (sort) sortBy(sort);
    if (look) lookAt(Number(look));
    if (go) {
      state.page += Number(go);
      show();
      find("#count").scrollIntoView({ block: "nearest" });
    }
  });
}

fillForm();
listen();
choose();
document.body.dataset.ready = "yes";
