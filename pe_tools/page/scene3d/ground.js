/* The ground: a grid in metres, an arrow that points ahead, and the selected map. */

const GRID_FAR = 30, FINE_FAR = 10;
const FINE_LINE = [90, 100, 112, 60], COARSE_LINE = [90, 100, 112, 120], ARROW = [27, 31, 36, 235];
const MARKS_M = [5, 10, 20];
const MAP_OPACITY = 0.82;

/* Lines along x and y every `step` metres up to `far`, in one colour. */
function gridLines(step, far, color, skip) {
  const points = [], colors = [];
  for (let at = -far; at <= far; at += step) {
    if (skip && at % skip === 0) continue;
    points.push(at, -far, 0, at, far, 0, -far, at, 0, far, at, 0);
    for (let i = 0; i < 4; i += 1) colors.push(...color);
  }
  return [new Float32Array(points), new Uint8Array(colors)];
}

function arrowLines(start, length) {
  const tip = start + length, wing = 0.35;
  const points = [start, 0, 0, tip, 0, 0, tip, 0, 0, tip - wing, wing / 2, 0, tip, 0, 0, tip - wing, -wing / 2, 0];
  return [new Float32Array(points), new Uint8Array(points.length / 3 * 4).map((_, i) => ARROW[i % 4])];
}

function gridOf(front) {
  const group = new T.Group();
  group.add(linesOf(...gridLines(1, FINE_FAR, FINE_LINE, 5), { width: 1, order: 1 }));
  group.add(linesOf(...gridLines(5, GRID_FAR, COARSE_LINE, 0), { width: 1, order: 1 }));
  group.add(linesOf(...arrowLines(front + 0.4, 1.6), { width: 2, order: 1 }));
  return group;
}

/* Text on the ground: the direction of the arrow, and metres ahead and to the left. */
function groundWords(front) {
  const words = [{ text: "x, ahead", at: [front + 2.2, 0, 0] }];
  for (const m of MARKS_M) {
    if (m > front + 2.6) words.push({ text: `${m} m`, at: [m, 0, 0] });
    words.push({ text: `${m} m`, at: [0, m, 0] });
  }
  return words;
}

function mapOf(map) {
  const [columns, rows] = map.size;
  const texture = new T.DataTexture(unpacked(map.colors, "u1"), columns, rows);
  texture.colorSpace = T.SRGBColorSpace;
  texture.magFilter = map.legend.classes.length ? texture.magFilter : T.LinearFilter;
  texture.needsUpdate = true;
  const [width, height] = [map.high[0] - map.low[0], map.high[1] - map.low[1]];
  const material = new T.MeshBasicMaterial({
    map: texture, transparent: true, opacity: MAP_OPACITY, depthWrite: false, side: T.DoubleSide,
  });
  const mesh = new T.Mesh(new T.PlaneGeometry(width, height), material);
  mesh.position.set(map.low[0] + width / 2, map.low[1] + height / 2, -0.004);
  mesh.renderOrder = 0.5;
  mesh.visible = false;
  return mesh;
}

function element(name, css, text) {
  const made = document.createElement(name);
  if (css) made.className = css;
  if (text !== undefined) made.textContent = text;
  return made;
}

function legendOf(legend) {
  const box = element("div");
  box.append(element("b", "", legend.title));
  if (legend.scale.length) {
    const bar = element("i", "v3-scale");
    bar.style.background = `linear-gradient(to right, ${legend.scale.join(", ")})`;
    const ticks = element("span", "v3-ticks");
    ticks.append(...legend.ticks.map((tick) => element("span", "", tick)));
    const values = element("span", "v3-ticks v3-values");
    values.append(...legend.values.map((value) => element("span", "", value)));
    box.append(bar, ticks, values);
  }
  for (const [color, words] of legend.classes) {
    const row = element("span", "v3-class", words);
    const swatch = element("i");
    swatch.style.background = color;
    row.prepend(swatch);
    box.append(row);
  }
  return box;
}
