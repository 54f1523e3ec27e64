/* The view in print: rendered again, into a canvas that browsers print. */

const PRINT_SIZE = [1600, 900];

function write(context, text, x, y, css) {
  context.font = css;
  context.lineWidth = 6;
  context.strokeStyle = "#fff";
  context.strokeText(text, x, y);
  context.fillStyle = "#1b1f24";
  context.fillText(text, x, y);
}

function writeNames(view, context, width, height) {
  context.textAlign = "center";
  const rows = [];
  for (const { sensor } of view.sensors) {
    const place = onScreen(new T.Vector3(...sensor.at), view.camera, width, height);
    if (!place.seen || view.from) continue;
    let y = place.y - 22;
    while (rows.some((row) => Math.abs(row.x - place.x) < 130 && Math.abs(row.y - y) < 26)) y -= 6;
    rows.push({ x: place.x, y });
    write(context, sensor.name, place.x, y, "600 22px system-ui, sans-serif");
  }
}

function drawForPrint(view) {
  const [width, height] = PRINT_SIZE;
  view.size(width, height, 1.6);
  view.renderer.render(view.scene, view.camera);
  view.paper.width = width;
  view.paper.height = height;
  const context = view.paper.getContext("2d");
  context.drawImage(view.canvas, 0, 0, width, height);
  writeNames(view, context, width, height);
  view.paperWords.replaceChildren(view.legend.cloneNode(true), view.key.cloneNode(true));
  view.fit();
}

function listenToPrint(view) {
  window.addEventListener("beforeprint", () => drawForPrint(view));
  window.addEventListener("afterprint", () => view.draw());
}
