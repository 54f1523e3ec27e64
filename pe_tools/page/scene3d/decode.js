/* Decode arrays from the page's data: base64 of little-endian integers. */

const NUMBERS = { u1: Uint8Array, u2: Uint16Array, u4: Uint32Array };

function unpacked(text, kind) {
  const raw = atob(text);
  const bytes = new Uint8Array(raw.length);
  for (let i = 0; i < raw.length; i += 1) bytes[i] = raw.charCodeAt(i);
  return new NUMBERS[kind](bytes.buffer);
}

/* Points [m], three numbers each. */
function pointsOf(packed) {
  const counted = unpacked(packed.at, "u2");
  const points = new Float32Array(counted.length);
  for (let i = 0; i < points.length; i += 1) points[i] = packed.low[i % 3] + counted[i] * packed.step;
  return points;
}
