/* Lines of a width in pixels, solid or dashed: each segment is a rectangle that faces the eye. */

const LINE_VERTEX = `
  attribute vec3 first, second;
  attribute vec4 firstColor, secondColor;
  uniform vec2 resolution;
  uniform float width;
  varying vec4 shade;
  varying float along;

  void main() {
    vec4 a = modelViewMatrix * vec4(first, 1.0);
    vec4 b = modelViewMatrix * vec4(second, 1.0);
    float near = -projectionMatrix[3][2] / (projectionMatrix[2][2] - 1.0);
    if (a.z > near && b.z > near) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
    float from = a.z > near ? (near - a.z) / (b.z - a.z) : 0.0;
    float to = b.z > near ? (near - a.z) / (b.z - a.z) : 1.0;
    vec4 start = projectionMatrix * mix(a, b, from);
    vec4 end = projectionMatrix * mix(a, b, to);
    vec2 way = (end.xy / end.w - start.xy / start.w) * resolution;
    way = dot(way, way) > 1e-8 ? normalize(way) : vec2(1.0, 0.0);
    vec4 place = position.x < 0.5 ? start : end;
    place.xy += vec2(-way.y, way.x) * position.y * width / resolution * place.w;
    gl_Position = place;
    float share = mix(from, to, position.x);
    shade = mix(firstColor, secondColor, share);
    along = share * distance(first, second);
  }`;

const LINE_FRAGMENT = `
  uniform float dash, strength;
  varying vec4 shade;
  varying float along;

  void main() {
    if (dash > 0.0 && fract(along / dash) > 0.6) discard;
    gl_FragColor = vec4(shade.rgb, shade.a * strength);
  }`;

/* Two triangles: x from end to end, y from side to side. */
const CORNERS = new Float32Array([0, -1, 0, 1, -1, 0, 1, 1, 0, 0, -1, 0, 1, 1, 0, 0, 1, 0]);

function pairs(values, size, which) {
  const count = values.length / (2 * size);
  const found = new values.constructor(count * size);
  for (let i = 0; i < count; i += 1) {
    const from = (2 * i + which) * size;
    found.set(values.subarray(from, from + size), i * size);
  }
  return found;
}

function lineGeometry(points, colors) {
  const geometry = new T.InstancedBufferGeometry();
  const each = (values, size, which, whole) =>
    new T.InstancedBufferAttribute(pairs(values, size, which), size, whole);
  geometry.setAttribute("position", new T.BufferAttribute(CORNERS, 3));
  geometry.setAttribute("first", each(points, 3, 0, false));
  geometry.setAttribute("second", each(points, 3, 1, false));
  geometry.setAttribute("firstColor", each(colors, 4, 0, true));
  geometry.setAttribute("secondColor", each(colors, 4, 1, true));
  geometry.instanceCount = points.length / 6;
  return geometry;
}

function lineMaterial(look) {
  return new T.ShaderMaterial({
    vertexShader: LINE_VERTEX,
    fragmentShader: LINE_FRAGMENT,
    uniforms: {
      resolution: { value: new T.Vector2(1, 1) },
      width: { value: look.width || 1.5 },
      dash: { value: look.dashed ? 0.1 : 0 },
      strength: { value: look.strength || 1 },
    },
    transparent: true,
    depthWrite: false,
    depthTest: !look.through,
    side: T.DoubleSide,
  });
}

/* Lines between pairs of points; `look`: width [px], dashed, strength, through, order. */
function linesOf(points, colors, look) {
  const mesh = new T.Mesh(lineGeometry(points, colors), lineMaterial(look));
  mesh.frustumCulled = false;
  mesh.renderOrder = look.order || 3;
  mesh.userData.look = look;
  return mesh;
}

/* Set size of the picture and length of a dash [m] for all lines below an object. */
function fitLines(root, width, height, ratio, dash) {
  root.traverse((thing) => {
    const look = thing.userData.look;
    if (!look) return;
    const uniforms = thing.material.uniforms;
    uniforms.resolution.value.set(width, height);
    uniforms.width.value = (look.width || 1.5) * ratio;
    if (look.dashed) uniforms.dash.value = dash;
  });
}
