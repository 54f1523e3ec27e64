#!/usr/bin/env bash
# The demo: better places for a LiDAR and a camera on a sedan, in a Blender if there is one, else in
# bpy, by the default search.
#
# usage: tools/demo.sh [OPTION...]       options go to `pe optimize` after the demo's own
set -euo pipefail
cd "$(dirname "$0")/.."

readonly python=.venv/bin/python
readonly output=demo_output
readonly start=$output/start.blend
readonly scene=tools/demo_scene.py
readonly told=$output/optimize.txt # all lines of the search
# Enough to see it work within a minute; without them a search takes its time.
readonly OPTIONS=(
    --evaluations 240 --set optimize.samples=32768 --samples 1048576 --seed 0 --output "$output"
)

fail() {
    echo "demo: $*" >&2
    exit 1
}

# Runs our command in a Blender with the extension, without touching its user's settings.
in_blender() {
    local archive
    archive=$("$python" tools/build_extension.py)
    resources=$(mktemp -d)
    trap 'rm -rf "$resources"' EXIT
    export BLENDER_USER_RESOURCES=$resources
    "$blender" --command extension install-file -r user_default --enable "$archive" \
        >"$resources/install.log" 2>&1 </dev/null ||
        { cat "$resources/install.log" >&2; fail "the extension could not be installed"; }
    local -r alone=(--factory-startup --addons bl_ext.user_default.perception_entropy -b)
    "$blender" "${alone[@]}" --python "$scene" -- "$start" >"$resources/scene.log" 2>&1 </dev/null
    [ -e "$start" ] || { cat "$resources/scene.log" >&2; fail "the scene could not be made"; }
    "$blender" "${alone[@]}" "$start" --command pe "$@" </dev/null
}

in_bpy() {
    "$python" "$scene" "$start" >/dev/null </dev/null
    "$python" -m blender_addon "$start" "$@" </dev/null
}

mkdir -p "$output"
rm -f "$start"
if blender=$("$python" tools/real_blender.py --host-only 2>/dev/null); then
    echo "demo: better places for a LiDAR and a camera on a sedan, in $blender"
    in_blender optimize "${OPTIONS[@]}" "$@" >"$told"
elif "$python" -c 'import bpy' >/dev/null 2>&1; then
    echo "demo: better places for a LiDAR and a camera on a sedan, in bpy"
    in_bpy optimize "${OPTIONS[@]}" "$@" >"$told"
elif "$python" -c 'import importlib.util as util; assert util.find_spec("bpy")' 2>/dev/null; then
    tools/debian_libs.sh || exit 1 # its last line says what to install
    fail "bpy does not start: $("$python" -c 'import bpy' 2>&1 | tail -n 1)"
else
    fail "needs Blender 4.2 or later in PATH, or a Python 3.11 or 3.13, which bpy exists for"
fi
"$python" tools/show_result.py "$output"
