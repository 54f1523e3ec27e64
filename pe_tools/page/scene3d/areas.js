/* Translucent triangles, and round dots of a size in pixels. */

const AREA_VERTEX = `
  attribute vec4 shadeOf;
  varying vec4 shade;
  void main() {
    shade = shadeOf;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
  }`;
const AREA_FRAGMENT = "varying vec4 shade; void main() { gl_FragColor = shade; }";

function areasOf(points, colors, order) {
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.BufferAttribute(points, 3));
  geometry.setAttribute("shadeOf", new T.BufferAttribute(colors, 4, true));
  const material = new T.ShaderMaterial({
    vertexShader: AREA_VERTEX,
    fragmentShader: AREA_FRAGMENT,
    transparent: true,
    depthWrite: false,
    side: T.DoubleSide,
  });
  const mesh = new T.Mesh(geometry, material);
  mesh.renderOrder = order;
  mesh.frustumCulled = false;
  return mesh;
}

const DOT_VERTEX = `
  uniform float size;
  void main() {
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_PointSize = size;
  }`;
const DOT_FRAGMENT = `
  uniform vec3 color;
  uniform float edge;
  void main() {
    float away = 2.0 * distance(gl_PointCoord, vec2(0.5));
    if (away > 1.0) discard;
    gl_FragColor = vec4(away > 1.0 - edge ? vec3(0.11, 0.12, 0.14) : color, 1.0);
  }`;

/* `look`: size [px], edge (share that is dark), through, order. */
function dotsOf(points, color, look) {
  const geometry = new T.BufferGeometry();
  geometry.setAttribute("position", new T.BufferAttribute(points, 3));
  const material = new T.ShaderMaterial({
    vertexShader: DOT_VERTEX,
    fragmentShader: DOT_FRAGMENT,
    uniforms: { size: { value: look.size }, color: { value: color }, edge: { value: look.edge || 0 } },
    transparent: true,
    depthTest: !look.through,
    depthWrite: false,
  });
  const dots = new T.Points(geometry, material);
  dots.renderOrder = look.order || 4;
  dots.frustumCulled = false;
  dots.userData.dots = look.size;
  return dots;
}

function fitDots(root, ratio) {
  root.traverse((thing) => {
    if (thing.userData.dots) thing.material.uniforms.size.value = thing.userData.dots * ratio;
  });
}

/* A colour in CSS notation, "rgb(0 115 178)", as numbers without colour conversion. */
function plainColor(css) {
  const [r, g, b] = css.match(/\d+/g).map((part) => Number(part) / 255);
  return new T.Vector3(r, g, b);
}
