/* The 3-D view of a section: renders when something changed, and not otherwise. */

const SKY = 0xf4f6f8, FARTHEST = 400;
const ALONE = ["fov", "occluded"];

function hasWebGL() {
  try {
    return Boolean(document.createElement("canvas").getContext("webgl2"));
  } catch {
    return false;
  }
}

class View {
  constructor(root, data) {
    const find = (name) => root.querySelector(`.v3-${name}`);
    Object.assign(this, { root, data, from: null, waiting: false });
    Object.assign(this, { stage: find("stage"), canvas: find("canvas"), legend: find("legend") });
    Object.assign(this, { names: find("labels"), caption: find("caption"), paper: find("paper") });
    Object.assign(this, { key: find("key"), paperWords: find("paper-words") });
    this.renderer = new T.WebGLRenderer({ canvas: this.canvas, antialias: true });
    this.renderer.setClearColor(SKY);
    this.scene = new T.Scene();
    this.camera = new T.PerspectiveCamera(32, 16 / 9, 0.1, FARTHEST);
    this.camera.up.set(0, 0, 1);
    this.controls = new T.OrbitControls(this.camera, this.canvas);
    this.subject = subjectOf(data);
    this.fill();
    this.controls.addEventListener("change", () => this.draw());
  }

  /* Add everything that is shown to the scene. */
  fill() {
    const { data, scene } = this;
    const front = data.vehicle ? data.vehicle.bounds[1][0] : 0.5;
    scene.add(lights(), gridOf(front));
    this.body = data.vehicle ? bodyOf(data.vehicle) : null;
    if (this.body) scene.add(this.body);
    this.maps = data.maps.map((map) => ({ map, mesh: mapOf(map) }));
    this.sensors = data.sensors.map(sensorOf);
    scene.add(...this.maps.map(({ mesh }) => mesh), ...this.sensors.map(({ group }) => group));
    this.labels = data.sensors.map((sensor, number) => sensorLabel(sensor, () => this.look(number)));
    this.labels.push(...groundWords(front).map(groundLabel));
    this.names.append(...this.labels.map(({ label }) => label));
  }

  show(name) {
    this.leave();
    showFrom(this, name);
    this.draw();
  }

  look(number) {
    this.leave();
    this.from = this.sensors[number];
    this.from.body.visible = this.from.dot.visible = false;
    this.hideOthers();
    this.labels[number].off = true;
    lookFrom(this, this.from.sensor);
    this.caption.hidden = false;
    this.caption.querySelector("span").textContent = captionOf(this.from.sensor);
    this.draw();
  }

  /* Seen from a sensor, the layers of other sensors would only be in the way. */
  hideOthers() {
    this.kept = this.sensors.map(({ layers }) =>
      Object.fromEntries(ALONE.map((name) => [name, layers[name].visible])));
    for (const other of this.sensors.filter((sensor) => sensor !== this.from)) {
      for (const name of ALONE) other.layers[name].visible = false;
    }
    this.from.layers.fov.visible = Boolean(this.from.sensor.field);
  }

  /* Return to a view of the rig from outside. */
  leave() {
    this.caption.hidden = true;
    if (!this.from) return;
    this.from.body.visible = this.from.dot.visible = true;
    this.sensors.forEach(({ layers }, i) => {
      for (const name of ALONE) layers[name].visible = this.kept[i][name];
    });
    this.labels[this.sensors.indexOf(this.from)].off = false;
    this.from = null;
  }

  size(width, height, ratio) {
    const { width: across, height: down } = this.canvas;
    if (across !== Math.round(width) || down !== Math.round(height)) {
      this.renderer.setSize(Math.round(width), Math.round(height), false);
    }
    this.camera.aspect = width / height;
    if (this.from) this.camera.fov = fittingFov(this.from.sensor.field, this.camera.aspect);
    this.camera.updateProjectionMatrix();
    this.camera.updateMatrixWorld();
    const away = this.from ? 4 : this.camera.position.distanceTo(this.controls.target);
    fitLines(this.scene, width, height, ratio, away * 0.011);
    fitDots(this.scene, ratio);
  }

  fit() {
    const ratio = Math.min(window.devicePixelRatio || 1, 2);
    const { clientWidth, clientHeight } = this.stage;
    this.size(Math.max(clientWidth, 1) * ratio, Math.max(clientHeight, 1) * ratio, ratio);
  }

  draw() {
    if (this.waiting) return;
    this.waiting = true;
    requestAnimationFrame(() => {
      this.waiting = false;
      this.fit();
      this.renderer.render(this.scene, this.camera);
      placeLabels(this.labels, this.camera, this.stage.clientWidth, this.stage.clientHeight);
    });
  }
}

/* Return a view, or null if the browser announces WebGL but cannot provide it. */
function viewOf(root, data) {
  try {
    return new View(root, data);
  } catch (error) {
    console.warn("no 3-D view:", error);
    return null;
  }
}

function begin(root) {
  const data = JSON.parse(document.getElementById(`data-${root.dataset.section}-${root.dataset.key}`).textContent);
  texts = data.texts;
  const view = viewOf(root, data);
  if (!view) return;
  root.querySelector(".v3-still").hidden = true;
  root.querySelector(".v3-live").hidden = false;
  listenToInput(view);
  listenToPanel(view);
  listenToPrint(view);
  startAsSwitched(view);
  view.fit();
  view.show("quarter");
  view.canvas.addEventListener("webglcontextrestored", () => view.draw());
  new ResizeObserver(() => view.draw()).observe(view.stage);
}

if (hasWebGL()) document.querySelectorAll('[data-section="view"]').forEach(begin);
