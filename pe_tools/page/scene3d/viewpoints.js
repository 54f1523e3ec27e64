/* Viewpoints: around the vehicle, or from one of its sensors. */

const FOV = 32, SENSOR_FOV = 75, WIDEST = 115, AHEAD = 0.01;
const VIEWS = {
  quarter: [1, 0.66, 0.52],
  above: [-0.0001, 0, 1],
  front: [1, 0, 0.04],
  rear: [-1, 0, 0.04],
  left: [0, 1, 0.04],
  right: [0, -1, 0.04],
};

/* Centre and radius of what the view shows: vehicle and sensors, with a margin. */
function subjectOf(data) {
  const points = data.sensors.map((sensor) => new T.Vector3(...sensor.at));
  if (data.vehicle) points.push(...data.vehicle.bounds.map((corner) => new T.Vector3(...corner)));
  const sphere = new T.Sphere().setFromPoints(points.length ? points : [new T.Vector3()]);
  sphere.radius = Math.max(sphere.radius, 1.5) * 1.22;
  return sphere;
}

/* Distance from which a sphere fills the narrower side of the picture. */
function distanceFor(radius, camera) {
  const half = camera.fov * Math.PI / 360;
  const across = Math.atan(Math.tan(half) * camera.aspect);
  return radius / Math.sin(Math.min(half, across));
}

function showFrom(view, name) {
  const { camera, controls, subject } = view;
  setFov(camera, FOV);
  const way = new T.Vector3(...VIEWS[name]).normalize();
  controls.target.copy(subject.center);
  camera.position.copy(subject.center).addScaledVector(way, distanceFor(subject.radius, camera));
  controls.rotateSpeed = 1;
  controls.enableZoom = controls.enablePan = true;
  controls.maxPolarAngle = Math.PI * 0.497;
  camera.near = 0.1;
  camera.updateProjectionMatrix();
  controls.update();
}

function setFov(camera, degrees) {
  camera.fov = degrees;
  camera.updateProjectionMatrix();
}

/* The vertical angle at which a sensor's image fills the view, with a margin. */
function fittingFov(field, aspect) {
  if (!field) return SENSOR_FOV;
  const [across, down] = field.map((degrees) => Math.tan(Math.min(degrees, WIDEST) * Math.PI / 360));
  return Math.min(2 * Math.atan(1.12 * Math.max(down, across / aspect)) * 180 / Math.PI, WIDEST);
}

function captionOf(sensor) {
  const wider = sensor.field && Math.max(...sensor.field) > WIDEST;
  return textWith(wider ? "from_middle" : "from", sensor.name);
}

/* Look from a sensor; dragging turns the view about a point just ahead of the eye. */
function lookFrom(view, sensor) {
  const { camera, controls } = view;
  setFov(camera, fittingFov(sensor.field, camera.aspect));
  const ahead = new T.Vector3(...sensor.axes.map((row) => row[0]));
  camera.position.set(...sensor.at);
  controls.target.copy(camera.position).addScaledVector(ahead, AHEAD);
  controls.rotateSpeed = -0.35;
  controls.enableZoom = controls.enablePan = false;
  controls.maxPolarAngle = Math.PI;
  camera.near = 0.03;
  camera.updateProjectionMatrix();
  controls.update();
}
