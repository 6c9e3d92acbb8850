// The map of the report: a thumbnail for each model, those that are alike near each other, and beside it who is like whom.

const LARGE = 60; // models, up to which thumbnails are large
const [CARD, MOST] = [7, 8]; // pixels from card to card of models at one place, and cards until it begins anew
const PICTURED = 600; // models, up to which they have thumbnails; of more there are dots

/** Place the models, so that the map fills its frame, and have each tell who is like it. */
function fillMap({ rows, x, y, near }) {
  const frame = find("#spots");
  frame.classList.add(rows.length > LARGE ? "small" : "large");
  const share = (values, value) => {
    const [least, most] = [Math.min(...values), Math.max(...values)];
    return most > least ? (value - least) / (most - least) : 0.5;
  };
  const stacks = new Map(); // models at one place lie like cards, so that each can be pointed at
  rows.forEach((row, place) => {
    const link = address(row, DATA.linked.findIndex((_, file) => address(row, file)));
    const spot = element(link ? "a" : "span", "", frame, "spot");
    if (link) spot.href = link;
    else spot.tabIndex = 0;
    spot.ariaLabel = DATA.models[row];
    const [left, top] = [100 * share(x, x[place]), 100 * (1 - share(y, y[place]))];
    const under = stacks.get(`${left.toFixed(1)} ${top.toFixed(1)}`) ?? 0;
    stacks.set(`${left.toFixed(1)} ${top.toFixed(1)}`, under + 1);
    spot.style.left = `${left}%`;
    spot.style.top = `${top}%`;
    const [right, down] = [left, top].map((where) => (where > 50 ? -CARD : CARD) * (under % MOST));
    spot.style.translate = `${right}px ${down}px`;
    if (under) spot.classList.add("card");
    spot.title = DATA.models[row];
    if (rows.length <= PICTURED && DATA.thumbnails[row]) addThumbnail(row, spot);
    else spot.classList.add("dot");
    for (const event of ["pointerenter", "focus"]) spot.addEventListener(event, () => tellAlike(place, rows, near, spot));
  });
  tellAlike(0, rows, near, find(".spot"));
}

/** Show a model and those that are most like it, beside the map and on it. */
function tellAlike(place, rows, near, spot) {
  all(".spot").forEach((each, other) => each.classList.toggle("near", near[place].includes(other)));
  find(".spot.lit")?.classList.remove("lit");
  spot.classList.add("lit");
  const list = element("ol");
  for (const other of near[place]) fillModel(element("li", "", list), rows[other]);
  const own = element("div", "");
  fillModel(own, rows[place]);
  find("#alike").replaceChildren(own, element("p", near[place].length ? "Most like it:" : "There is no other model."), list);
}

fillMap(DATA.map);
