// What three.js draws of the scene: surface, curves, a level, a graph.

const MANY = 24; // loops, beyond which only the circles around them are shown, and a path once it is pointed at
const LAST = 10; // of the order in which things are drawn: over all else
const KINDS = { handle: "#d55e00", tunnel: "#0072b2", mixed: "#a3246e" };
const POCKETS = { basin: "#0072b2", bell: "#e69f00", sealed: "#a3246e", island: "#009e73" };
const TONES = { creation: "#009e73", union: "#0072b2", separation: "#d55e00", annihilation: "#a3246e", "": "#6b7280" };

// ---------------------------------------------------------------- geometry

/** Geometries of the parts by name, height up (y), around the middle of the model; `turn` leads there. */
function bakeMeshes(scene, { nodes }) {
  const root = scene.children[0];
  root.updateMatrix();
  const meshes = { turn: root.matrix };
  nodes.slice(1).forEach(({ name }, k) => {
    meshes[name] = root.children[k].geometry.applyMatrix4(root.matrix);
    meshes[name].computeBoundingSphere();
  });
  return meshes;
}

/** Where a geometry is in the frame of a camera, across and up. */
function boundsFrom(camera, geometry) {
  const { array } = geometry.attributes.position;
  const e = camera.matrixWorldInverse.elements;
  const bounds = { left: Infinity, right: -Infinity, top: -Infinity, bottom: Infinity };
  for (let k = 0; k < array.length; k += 3) {
    const across = e[0] * array[k] + e[4] * array[k + 1] + e[8] * array[k + 2] + e[12];
    const up = e[1] * array[k] + e[5] * array[k + 1] + e[9] * array[k + 2] + e[13];
    bounds.left = Math.min(bounds.left, across);
    bounds.right = Math.max(bounds.right, across);
    bounds.bottom = Math.min(bounds.bottom, up);
    bounds.top = Math.max(bounds.top, up);
  }
  return bounds;
}

/** First and last place in the index of what has each number in an attribute, which ascends along the index. */
function rangesOf(geometry, name) {
  const numbers = geometry.attributes[name];
  const ranges = {};
  for (let k = 0; k < geometry.index.count; k++) {
    const range = (ranges[numbers.getX(geometry.index.getX(k))] ??= [k, k]);
    range[1] = k + 1;
  }
  return ranges;
}

/** Ends of the lines in a range of the index, as a flat list. */
function pairsOf(geometry, range) {
  const { array } = geometry.attributes.position;
  const places = [];
  for (let k = range?.[0] ?? 0; k < (range?.[1] ?? 0); k++) {
    const first = 3 * geometry.index.getX(k);
    places.push(array[first], array[first + 1], array[first + 2]);
  }
  return places;
}

function fatLines(places, colour, wide, order) {
  const material = new THREE.LineMaterial({ color: colour, linewidth: wide, depthTest: false, transparent: true });
  const lines = new THREE.LineSegments2(new THREE.LineSegmentsGeometry(), material);
  if (places.length) lines.geometry.setPositions(places);
  lines.visible = places.length > 0;
  lines.renderOrder = order;
  return lines;
}

const paint = (colour, opacity, more = {}) =>
  new THREE.MeshLambertMaterial({
    color: colour,
    opacity,
    transparent: true,
    depthWrite: false,
    side: THREE.DoubleSide,
    ...more,
  });

/** A mesh of the triangles that have one of some numbers in an attribute. */
function pickFaces(geometry, name, numbers, material) {
  const ranges = rangesOf(geometry, name);
  const chosen = new THREE.BufferGeometry();
  for (const key of Object.keys(geometry.attributes)) chosen.setAttribute(key, geometry.attributes[key]);
  chosen.setIndex(geometry.index);
  numbers.filter((k) => ranges[k]).forEach((k) => chosen.addGroup(ranges[k][0], ranges[k][1] - ranges[k][0], 0));
  const mesh = new THREE.Mesh(chosen, [material]);
  mesh.renderOrder = 3;
  return mesh;
}

// ---------------------------------------------------------------- what is shown

/** The surface, back before front, and once more in the colours of its arcs. */
function addSurface(groups, geometry, PARTS) {
  const smooth = THREE.toCreasedNormals(geometry, 0.7);
  smooth.setIndex([...Array(smooth.attributes.position.count).keys()]);
  const tones = new Float32Array(smooth.attributes.position.count * 3);
  const tone = new THREE.Color();
  for (let k = 0; k < tones.length / 3; k++) {
    const arc = smooth.attributes._arc.getX(k);
    tone.setHSL((arc * 0.618034) % 1, 0.6, arc % 2 ? 0.55 : 0.68).toArray(tones, 3 * k);
  }
  smooth.setAttribute("color", new THREE.BufferAttribute(tones, 3));
  const add = (group, side, opacity, order, more) => {
    const mesh = new THREE.Mesh(smooth, paint("#8fa3bd", opacity, { side, ...more }));
    mesh.renderOrder = order;
    groups[group].add(mesh);
    return mesh;
  };
  add("surface", THREE.BackSide, 0.22, 0);
  const front = add("surface", THREE.FrontSide, 0.34, 1);
  for (const [side, opacity, order] of [
    [THREE.BackSide, 0.25, 0],
    [THREE.FrontSide, 0.5, 1],
  ]) {
    add("parts", side, opacity, order, { color: "#ffffff", vertexColors: true });
  }
  const light = (group, arcs) => group.add(pickFaces(smooth, "_arc", arcs, paint("#ff9a2e", 0.55)));
  return { front, light };
}

function addCurves(groups, meshes, PARTS) {
  if (meshes.contours) {
    const material = new THREE.LineBasicMaterial({ color: "#23527c", transparent: true, opacity: 0.35 });
    groups.contours.add(new THREE.LineSegments(meshes.contours, material));
  }
  for (const [name, wide] of [
    ["loop circles", 4],
    ["loop paths", 1.6],
  ]) {
    if (!meshes[name] || (name === "loop paths" && PARTS[name].loops.length > MANY)) continue;
    const ranges = rangesOf(meshes[name], "_loop");
    for (const [kind, colour] of Object.entries(KINDS)) {
      const own = PARTS[name].loops.flatMap((loop, k) => (loop.kind === kind ? [k] : []));
      groups.loops.add(
        fatLines(
          own.flatMap((k) => pairsOf(meshes[name], ranges[k])),
          colour,
          wide,
          LAST,
        ),
      );
    }
  }
}

function addPockets(group, geometry, pockets) {
  geometry.computeVertexNormals();
  for (const [kind, colour] of Object.entries(POCKETS)) {
    const own = pockets.flatMap((pocket, k) => (pocket.kind === kind ? [k] : []));
    if (own.length) group.add(pickFaces(geometry, "_pocket", own, paint(colour, 0.6)));
  }
}

/** Contours at a level, those of holes apart, and its regions filled. */
function addSlice(group, geometry, { contours, level, region, inner }, shown) {
  const ranges = rangesOf(geometry, "_contour");
  const own = contours.map((_, k) => k).filter((k) => level[k] === shown);
  const rings = own.map((k) => ({
    hole: inner[k] === 1,
    region: region[k],
    places: pairsOf(geometry, ranges[contours[k]]),
  }));
  for (const [hole, colour] of [
    [false, "#0b3d66"],
    [true, "#6a3fb5"],
  ]) {
    group.add(
      fatLines(
        rings.filter((ring) => ring.hole === hole).flatMap((ring) => ring.places),
        colour,
        3,
        LAST - 1,
      ),
    );
  }
  for (const outer of rings.filter((ring) => !ring.hole)) {
    const holes = rings.filter((ring) => ring.hole && ring.region === outer.region);
    const shape = fillRegion(
      outer.places,
      holes.map((ring) => ring.places),
    );
    const fill = new THREE.Mesh(
      shape,
      new THREE.MeshBasicMaterial({
        color: "#3d86c6",
        transparent: true,
        opacity: 0.4,
        depthWrite: false,
        side: THREE.DoubleSide,
      }),
    );
    fill.renderOrder = 2;
    group.add(fill);
  }
}

/** A level region as triangles; rings are ends of lines, of which every other one is taken. */
function fillRegion(outer, holes) {
  const corners = (ring) =>
    Array.from({ length: ring.length / 6 }, (_, k) => new THREE.Vector2(ring[6 * k], ring[6 * k + 2]));
  const rings = [outer, ...holes].map(corners);
  const shape = new THREE.BufferGeometry();
  const flat = rings.flat().flatMap((corner) => [corner.x, outer[1], corner.y]);
  shape.setAttribute("position", new THREE.BufferAttribute(new Float32Array(flat), 3));
  shape.setIndex(rings[0].length < 3 ? [] : THREE.ShapeUtils.triangulateShape(rings[0], rings.slice(1)).flat());
  return shape;
}

/** A graph: its arcs, white underneath, and its nodes. */
function addGraph(group, meshes, PARTS, name, wide) {
  const lines = meshes[`${name} arcs`];
  const places = lines ? pairsOf(lines, [0, lines.index.count]) : [];
  const small = Math.max(4.2 / PARTS[`${name} nodes`].nodes.length ** 0.4, 0.45);
  const scale = Math.min(small, 0.5 + wide / 1400, 1);
  group.add(fatLines(places, "#ffffff", 6 * scale, LAST + 1), fatLines(places, "#1b1f24", 3 * scale, LAST + 2));
  if (scale > 0.8) {
    const leaders = new THREE.LineBasicMaterial({ color: "#5b6470", depthTest: false, transparent: true });
    group.add(new THREE.LineSegments(meshes[`${name} leaders`], leaders));
    group.children.at(-1).renderOrder = LAST + 1;
  }
  const { nodes } = PARTS[`${name} nodes`];
  const spots = meshes[`${name} nodes`].attributes.position.array;
  for (const operation of Object.keys(TONES)) {
    for (const side of "AB") {
      const own = nodes.flatMap((node, k) =>
        (node.operation in TONES ? node.operation : "") === operation && (node.side === "B" ? "B" : "A") === side
          ? [k]
          : [],
      );
      const where = own.flatMap((k) => [...spots.slice(3 * k, 3 * k + 3)]);
      if (own.length) group.add(sprites(where, drawMark(operation, TONES[operation], side), 16 * scale, LAST + 4));
    }
  }
  return { lines, spots, arcs: PARTS[`${name} arcs`]?.arcs ?? [], ranges: lines ? rangesOf(lines, "_arc") : {} };
}

function sprites(places, picture, wide, order) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(places), 3));
  const material = new THREE.PointsMaterial({
    map: picture,
    size: wide,
    sizeAttenuation: false,
    transparent: true,
    depthTest: false,
  });
  const points = new THREE.Points(geometry, material);
  points.renderOrder = order;
  return points;
}

/** The mark of a node as the flat graph has it, hollow on side B. */
function drawMark(operation, colour, side) {
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = 64;
  const pen = canvas.getContext("2d");
  pen.translate(32, 32);
  pen.scale(3.9, 3.9);
  const path = document.querySelector(`#mark-${operation || "other"}`)?.getAttribute("d");
  const shape = path ? new Path2D(path) : new Path2D("M-5.5 0a5.5 5.5 0 1 0 11 0a5.5 5.5 0 1 0-11 0Z");
  pen.lineWidth = 3.4;
  pen.strokeStyle = "#ffffff";
  pen.stroke(shape);
  if (operation !== "ring") {
    pen.fillStyle = side === "B" ? "#ffffff" : colour;
    pen.fill(shape);
  }
  pen.lineWidth = 1.8;
  pen.strokeStyle = colour;
  pen.stroke(shape);
  const picture = new THREE.CanvasTexture(canvas);
  picture.colorSpace = THREE.SRGBColorSpace;
  return picture;
}
