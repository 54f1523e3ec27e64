/* A sensor: housing, a dot at its position, and the layers that the check boxes show. */

const STYLES = {
  fov: { width: 1.25, order: 3 },
  occluded: { width: 1.7, order: 4, dashed: true },
  ground: { width: 1.6, order: 2 },
};
const GHOST = { width: 1.7, order: 4, dashed: true, through: true, strength: 0.28 };
const OCCLUDED_COLOR = "rgb(214 94 0)";
const UNKNOWN_SIZE = 0.035;
const POST_RADIUS = 0.014;
const POST_COLOR = 0x767c85;

function matrixOf(sensor) {
  const [[a, b, c], [d, e, f], [g, h, i]] = sensor.axes;
  const [x, y, z] = sensor.at;
  return new T.Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

function housingShape(housing) {
  if (!housing) return new T.SphereGeometry(UNKNOWN_SIZE, 20, 12);
  const [length, width, height] = housing.size;
  const shape = housing.shape === "box"
    ? new T.BoxGeometry(length, width, height)
    : new T.CylinderGeometry(length / 2, length / 2, height, 40).rotateX(Math.PI / 2);
  return shape.translate(...housing.center);
}

/* Return the post that holds a sensor off the vehicle. */
function postOf([foot, head]) {
  const way = new T.Vector3(...head).sub(new T.Vector3(...foot));
  const length = way.length();
  const shape = new T.CylinderGeometry(POST_RADIUS, POST_RADIUS, length, 16).translate(0, length / 2, 0);
  const post = new T.Mesh(shape, new T.MeshLambertMaterial({ color: POST_COLOR }));
  post.quaternion.setFromUnitVectors(new T.Vector3(0, 1, 0), way.normalize());
  post.position.set(...foot);
  return post;
}

function housingOf(sensor) {
  const material = new T.MeshLambertMaterial({ color: 0x39414a });
  const mesh = new T.Mesh(housingShape(sensor.housing), material);
  mesh.applyMatrix4(matrixOf(sensor));
  return mesh;
}

/* Return every second point: the ends of lines. */
function endsOf(points) {
  return pairs(points, 3, 1);
}

function layerOf(layer, style) {
  const group = new T.Group();
  if (layer.faces) {
    group.add(areasOf(pointsOf(layer.faces), unpacked(layer.faces.colors, "u1"), style.order - 0.5));
  }
  if (!layer.lines) return group;
  const points = pointsOf(layer.lines), colors = unpacked(layer.lines.colors, "u1");
  group.add(linesOf(points, colors, style));
  if (style.dashed) {
    group.add(linesOf(points, colors, GHOST));
    group.add(dotsOf(endsOf(points), plainColor(OCCLUDED_COLOR), { size: 4.5, order: 5 }));
  }
  return group;
}

function sensorOf(sensor) {
  const layers = {};
  for (const name of Object.keys(STYLES)) layers[name] = layerOf(sensor.layers[name] || {}, STYLES[name]);
  const body = new T.Group();
  body.add(housingOf(sensor));
  if (sensor.post) body.add(postOf(sensor.post));
  const dot = dotsOf(new Float32Array(sensor.at), plainColor(sensor.color), {
    size: 12, edge: 0.2, through: true, order: 6,
  });
  const group = new T.Group();
  group.add(body, dot, ...Object.values(layers));
  return { sensor, group, layers, body, dot };
}
