// What of the model in space the pointer is on.

const NEAR = 9; // pixels within which a node or an arc is pointed at

function rotateCamera(camera, target, around, up) {
  const arm = camera.position.clone().sub(target);
  const at = new THREE.Spherical().setFromVector3(arm);
  at.theta += around;
  at.phi = Math.min(Math.max(at.phi - up, 0.01), Math.PI - 0.01);
  camera.position.copy(arm.setFromSpherical(at).add(target));
  camera.lookAt(target);
}

/** What is within reach of a place on the canvas: a node, else an arc, else the arc of the surface there. */
function pick(canvas, event, { camera, body, groups, graphNow, FACTS }) {
  const box = canvas.getBoundingClientRect();
  const at = new THREE.Vector2(event.clientX - box.left, event.clientY - box.top);
  const graph = graphNow();
  if (graph && groups.graph.visible) {
    const node = nearest(graph.spots, camera, box, at);
    if (node >= 0) return { what: { kind: "node", number: node } };
    const place = graph.lines ? nearest(graph.lines.attributes.position.array, camera, box, at, graph.lines.index) : -1;
    if (place >= 0) return { what: { kind: "arc", number: graph.lines.attributes._arc.getX(place) } };
  }
  if (!groups.surface.visible && !groups.parts.visible) return {};
  const ray = new THREE.Raycaster();
  ray.setFromCamera(new THREE.Vector2((2 * at.x) / box.width - 1, 1 - (2 * at.y) / box.height), camera);
  const planes = body.front.material.clippingPlanes ?? [];
  const hit = ray
    .intersectObject(body.front)
    .find(({ point }) => planes.every((plane) => plane.distanceToPoint(point) >= 0));
  if (!hit) return {};
  const arc = body.front.geometry.attributes._arc.getX(hit.face.a);
  const height = hit.point.y + new THREE.Vector3(...FACTS.origin).dot(new THREE.Vector3(...FACTS.rotation[2]));
  const own = graph?.arcs.flatMap((one, k) => (one.surface.includes(arc) ? [k] : [])) ?? [];
  const inside = own.find((k) => graph.arcs[k].lower <= height && height <= graph.arcs[k].upper) ?? own[0];
  return { what: inside === undefined ? null : { kind: "arc", number: inside }, place: nameplace(hit.point, FACTS) };
}

/** The number of the point, or a point of the line (of `index`), within reach of a place on the canvas; or -1. */
function nearest(places, camera, box, at, index) {
  const matrix = camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse).elements;
  const seen = (k) => {
    const [x, y, z] = [places[3 * k], places[3 * k + 1], places[3 * k + 2]];
    return [0, 1]
      .map((row) => matrix[row] * x + matrix[4 + row] * y + matrix[8 + row] * z + matrix[12 + row])
      .map((ndc, row) => (row ? ((1 - ndc) * box.height) / 2 : ((1 + ndc) * box.width) / 2));
  };
  let [best, away] = [-1, NEAR];
  const count = index ? index.count / 2 : places.length / 3;
  for (let k = 0; k < count; k++) {
    const [x0, y0] = seen(index ? index.getX(2 * k) : k);
    let [dx, dy] = [at.x - x0, at.y - y0];
    if (index) {
      const [x1, y1] = seen(index.getX(2 * k + 1));
      const length = (x1 - x0) ** 2 + (y1 - y0) ** 2;
      const along = length ? Math.min(Math.max((dx * (x1 - x0) + dy * (y1 - y0)) / length, 0), 1) : 0;
      [dx, dy] = [dx - along * (x1 - x0), dy - along * (y1 - y0)];
    }
    const distance = Math.hypot(dx, dy);
    if (distance < away) [best, away] = [index ? index.getX(2 * k) : k, distance];
  }
  return best;
}

/** A point of the scene in the frame of the mesh file, to six digits of the model's size. */
function nameplace(point, FACTS) {
  const tilted = [point.x, -point.z, point.y];
  const digits = Math.max(0, 5 - Math.floor(Math.log10(FACTS.high - FACTS.low || 1)));
  return [0, 1, 2]
    .map((axis) => FACTS.origin[axis] + tilted.reduce((sum, value, row) => sum + FACTS.rotation[row][axis] * value, 0))
    .map((value) => value.toFixed(Math.min(digits, 12)))
    .join(" ");
}

/** Point at what is under the pointer; keep it on a click or a tap, which is a press without a move. */
function listenToPointer(canvas, scene) {
  let pressed = null;
  canvas.addEventListener("pointermove", (event) => {
    if (!event.buttons) scene.point(pick(canvas, event, scene).what ?? null);
  });
  canvas.addEventListener("pointerleave", () => scene.point(null));
  canvas.addEventListener("pointerdown", (event) => {
    pressed = [event.clientX, event.clientY];
  });
  canvas.addEventListener("pointerup", (event) => {
    if (!pressed || Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 4) return;
    const { what, place } = pick(canvas, event, scene);
    scene.keep(what ?? null, place);
  });
}
