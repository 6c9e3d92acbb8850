// The model in space: what three.js draws of the scene, and what of it the pointer is on.

/** Load the scene and show it in `host`; what the page can ask for is returned. */
async function makeView(host, bytes, { FACTS, PARTS, SCENE }, { point, keep }) {
  const renderer = new THREE.WebGLRenderer({ antialias: true, preserveDrawingBuffer: true });
  renderer.localClippingEnabled = true;
  renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
  renderer.setClearColor(0xffffff);
  const canvas = renderer.domElement;
  canvas.tabIndex = 0;
  canvas.setAttribute("role", "img");
  canvas.setAttribute("aria-label", `${FACTS.model} in space; arrow keys turn it, + and - come closer and go away`);
  host.append(canvas);
  const loaded = await new THREE.GLTFLoader().parseAsync(bytes.buffer, "");
  const meshes = bakeMeshes(loaded.scene, SCENE);
  const world = new THREE.Scene();
  world.add(new THREE.HemisphereLight(0xffffff, 0x8a93a0, 2.2));
  const sun = new THREE.DirectionalLight(0xffffff, 1.6);
  const size = meshes.surface.boundingSphere.radius;
  const camera = new THREE.OrthographicCamera(-size, size, size, -size, -10 * size, 20 * size);
  camera.add(sun);
  sun.position.set(-0.4, 0.8, 1);
  world.add(camera);
  const controls = new THREE.OrbitControls(camera, canvas);
  const middle = new THREE.Vector3(...FACTS.origin).applyMatrix4(meshes.turn).y;
  const plane = new THREE.Plane(new THREE.Vector3(0, -1, 0), 0);
  const groups = Object.fromEntries(
    ["surface", "parts", "contours", "slice", "graph", "loops", "pockets", "islands", "lit"].map((name) => [
      name,
      new THREE.Group(),
    ]),
  );
  world.add(...Object.values(groups));
  const body = addSurface(groups, meshes.surface, PARTS);
  addCurves(groups, meshes, PARTS);
  for (const name of ["pockets", "islands"])
    if (meshes[name]) addPockets(groups[name], meshes[name], PARTS[name].pockets);
  let graph = null;
  let frame = 0;

  const draw = () => {
    frame ||= requestAnimationFrame(() => {
      frame = 0;
      renderer.render(world, camera);
    });
  };
  controls.addEventListener("change", draw);

  /** Have the model fill the picture as it is seen now. */
  function fit() {
    const { clientWidth: wide, clientHeight: high } = host;
    const { left, right, top, bottom } = boundsFrom(camera, meshes.surface);
    const reach = 0.54 * Math.max(top - bottom, ((right - left) * high) / wide);
    const [x, y] = [(left + right) / 2, (top + bottom) / 2];
    Object.assign(camera, {
      left: x - (reach * wide) / high,
      right: x + (reach * wide) / high,
      top: y + reach,
      bottom: y - reach,
    });
    camera.updateProjectionMatrix();
    renderer.setSize(wide, high);
    draw();
  }

  /** Look from an azimuth and an elevation, in degrees, in the tilted frame. */
  function look(azimuth, elevation) {
    const [a, e] = [azimuth, elevation].map((angle) => (angle * Math.PI) / 180);
    const way = new THREE.Vector3(Math.cos(e) * Math.cos(a), Math.sin(e), -Math.cos(e) * Math.sin(a));
    controls.target.set(0, 0, 0);
    camera.position.copy(way.multiplyScalar(5 * size));
    camera.zoom = 1;
    controls.update();
    camera.updateMatrixWorld();
    fit();
  }

  function setGraph(name) {
    groups.graph.clear();
    graph = name && meshes[`${name} nodes`] ? addGraph(groups.graph, meshes, PARTS, name, host.clientWidth) : null;
    light(null);
  }

  function setLevel(place) {
    groups.slice.clear();
    plane.constant = PARTS.contours.heights[place] - middle;
    addSlice(groups.slice, meshes.contours, PARTS.contours, PARTS.contours.levels[place]);
    draw();
  }

  function setCut(cut) {
    const planes = cut ? [plane] : [];
    for (const name of ["surface", "parts", "contours"]) {
      groups[name].traverse((part) => {
        if (part.material) part.material.clippingPlanes = planes;
      });
    }
    draw();
  }

  function setLayer(name, shown) {
    groups[name].visible = shown;
    draw();
  }

  /** Light an arc with the faces around it, a node, a loop or a pocket. */
  function light(what) {
    groups.lit.clear();
    if (what?.kind === "arc" && graph) {
      body.light(groups.lit, graph.arcs[what.number].surface);
      groups.lit.add(fatLines(pairsOf(graph.lines, graph.ranges[what.number]), "#e66a00", 6, LAST + 3));
    } else if (what?.kind === "node" && graph) {
      const spot = graph.spots.slice(3 * what.number, 3 * what.number + 3);
      groups.lit.add(sprites(spot, drawMark("ring", "#e66a00", "B"), 26, LAST + 6));
    } else if (what?.kind === "loop") {
      for (const [name, wide] of [
        ["loop circles", 7],
        ["loop paths", 4],
      ]) {
        groups.lit.add(
          fatLines(pairsOf(meshes[name], rangesOf(meshes[name], "_loop")[what.number]), "#e66a00", wide, LAST + 3),
        );
      }
    } else if (what) {
      groups.lit.add(pickFaces(meshes[what.kind], "_pocket", [what.number], paint("#e66a00", 0.8)));
    }
    draw();
  }

  listenToPointer(canvas, { camera, body, groups, graphNow: () => graph, meshes, FACTS, point, keep });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    const zoom = { "+": 1.15, "=": 1.15, "-": 1 / 1.15 }[event.key];
    if (!turns && !zoom) return;
    event.preventDefault();
    if (zoom) camera.zoom *= zoom;
    else rotateCamera(camera, controls.target, turns[0] * 0.12, turns[1] * 0.12);
    camera.updateProjectionMatrix();
    controls.update();
    draw();
  });
  new ResizeObserver(fit).observe(host);
  look(FACTS.azimuth, FACTS.elevation);
  const turn = (way) => (way === "start" ? look(FACTS.azimuth, FACTS.elevation) : look(...way.split(" ").map(Number)));
  return { light, setGraph, setLevel, setCut, setLayer, turn };
}
