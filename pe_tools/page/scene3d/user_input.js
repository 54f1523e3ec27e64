/* Mouse, touch and keys. Scrolling the page by touch or wheel does not move the view: the view takes
   touches after a tap and the wheel after a click, until something else is clicked. */

const TURN = Math.PI / 24, ZOOM = 1.15;

function activate(view, on) {
  view.controls.enabled = on;
  view.stage.classList.toggle("v3-active", on);
  view.canvas.style.touchAction = on ? "none" : "pan-y pinch-zoom";
}

function listenToInput(view) {
  const { stage, canvas } = view;
  activate(view, false);
  stage.addEventListener("pointerdown", (event) => {
    if (event.pointerType === "mouse" && event.target === canvas) activate(view, true);
  }, true);
  canvas.addEventListener("click", () => activate(view, true));
  document.addEventListener("pointerdown", (event) => {
    if (!stage.contains(event.target)) activate(view, false);
  });
  stage.addEventListener("keydown", (event) => onKey(view, event));
  document.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || event.defaultPrevented || !view.from) return;
    event.preventDefault();
    view.show("quarter");
  });
}

function turn(view, left, up) {
  const { camera, controls } = view;
  const offset = camera.position.clone().sub(controls.target);
  const level = Math.hypot(offset.x, offset.y);
  const azimuth = Math.atan2(offset.y, offset.x) + left;
  const far = offset.length();
  const least = view.from ? -1.5 : 0.02;
  const height = Math.min(Math.max(Math.atan2(offset.z, level) + up, least), 1.55);
  offset.set(Math.cos(azimuth) * Math.cos(height), Math.sin(azimuth) * Math.cos(height), Math.sin(height));
  camera.position.copy(controls.target).addScaledVector(offset, far);
}

function nearer(view, factor) {
  if (view.from) return;
  const offset = view.camera.position.clone().sub(view.controls.target);
  view.camera.position.copy(view.controls.target).addScaledVector(offset, factor);
}

function onKey(view, event) {
  const keys = {
    ArrowLeft: () => turn(view, -TURN, 0),
    ArrowRight: () => turn(view, TURN, 0),
    ArrowUp: () => turn(view, 0, TURN / 2),
    ArrowDown: () => turn(view, 0, -TURN / 2),
    "+": () => nearer(view, 1 / ZOOM),
    "=": () => nearer(view, 1 / ZOOM),
    "-": () => nearer(view, ZOOM),
    0: () => view.show("quarter"),
    Escape: () => view.show("quarter"),
  };
  if (event.target !== view.stage || !keys[event.key] || event.ctrlKey || event.metaKey) return;
  event.preventDefault();
  keys[event.key]();
  view.controls.update();
  view.draw();
}
