#!/usr/bin/env bash
# Makes pe_tools/page/scene3d/_vendor/three.min.js again: what the review's 3-D view uses of three.js, as
# one file. Needs npm. The same versions give the same bytes; a test holds the file's hash.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly THREE=0.187.0 ESBUILD=0.28.2
readonly TARGET=pe_tools/page/scene3d/_vendor

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cat >"$work/package.json" <<'JSON'
{ "private": true }
JSON
cat >"$work/entry.js" <<'JS'
export {
    BoxGeometry, BufferAttribute, BufferGeometry, Color, CylinderGeometry, DataTexture,
    DirectionalLight, DoubleSide, Group, HemisphereLight, InstancedBufferAttribute,
    InstancedBufferGeometry, LinearFilter, Matrix4, Mesh, MeshBasicMaterial, MeshLambertMaterial,
    PerspectiveCamera, PlaneGeometry, Points, SRGBColorSpace, Scene, ShaderMaterial, Sphere,
    SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
export { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
export { toCreasedNormals } from "three/examples/jsm/utils/BufferGeometryUtils.js";
JS

(cd "$work" && npm install --no-audit --no-fund --save-exact "three@$THREE" "esbuild@$ESBUILD")
"$work/node_modules/.bin/esbuild" "$work/entry.js" --bundle --minify --format=iife \
    --target=es2020 --global-name=PE_THREE --legal-comments=none \
    --banner:js="/* three.js $THREE, MIT licence, Copyright 2010-2026 three.js authors */" \
    --outfile="$TARGET/three.min.js"
cp "$work/node_modules/three/LICENSE" "$TARGET/LICENSE"
sha256sum "$TARGET/three.min.js"
