/* The vehicle: a mesh for each look of its parts. */

const LOOKS = {
  body: { color: 0xc3cad2 },
  rubber: { color: 0x3c4248 },
  glass: { color: 0x51626f, opacity: 0.62 },
  light: { color: 0xf2efe2 },
  "rear-light": { color: 0xa8514d },
  plate: { color: 0xf4f4f1 },
};
const SEE_THROUGH = 0.42;
const OVER_THE_GROUND = 2;
const CREASE = 0.6;

function partsByLook(parts) {
  const found = new Map();
  for (const part of parts) found.set(part.look, [...(found.get(part.look) || []), part]);
  return found;
}

function cornersOf(parts, points, numbers) {
  const total = parts.reduce((sum, part) => sum + part.count, 0);
  const corners = new Float32Array(9 * total);
  let next = 0;
  for (const part of parts) {
    for (let i = 3 * part.first; i < 3 * (part.first + part.count); i += 1, next += 3) {
      corners.set(points.subarray(3 * numbers[i], 3 * numbers[i] + 3), next);
    }
  }
  return corners;
}

function partMesh(look, corners) {
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.BufferAttribute(corners, 3));
  const { color, opacity = 1 } = LOOKS[look];
  const material = new T.MeshLambertMaterial({
    color, opacity, transparent: opacity < 1, side: T.DoubleSide,
    polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1,
  });
  const mesh = new T.Mesh(T.toCreasedNormals(geometry, CREASE), material);
  mesh.userData.opacity = opacity;
  mesh.renderOrder = opacity < 1 ? OVER_THE_GROUND : 0;
  return mesh;
}

function bodyOf(vehicle) {
  const group = new T.Group();
  const points = pointsOf(vehicle);
  const numbers = unpacked(vehicle.triangles, vehicle.wide ? "u4" : "u2");
  for (const [look, parts] of partsByLook(vehicle.parts)) {
    group.add(partMesh(look, cornersOf(parts, points, numbers)));
  }
  return group;
}

function makeSeeThrough(group, wanted) {
  for (const mesh of group.children) {
    const own = mesh.userData.opacity;
    mesh.material.opacity = wanted ? SEE_THROUGH * own : own;
    mesh.material.transparent = mesh.material.opacity < 1;
    mesh.material.depthWrite = !wanted;
    mesh.renderOrder = mesh.material.transparent ? OVER_THE_GROUND : 0;
    mesh.material.needsUpdate = true;
  }
}

function lights() {
  const group = new T.Group();
  const sky = new T.HemisphereLight(0xffffff, 0xb9c0c7, 2.1);
  sky.position.set(0, 0, 1);
  const sun = new T.DirectionalLight(0xffffff, 1.5);
  sun.position.set(4, 5, 9);
  group.add(sky, sun);
  return group;
}
