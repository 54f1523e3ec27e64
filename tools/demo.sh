#!/usr/bin/env bash
# The demo: better places for the sensors of the sedan, in a Blender when there is one, else in bpy.
#
# usage: tools/demo.sh [OPTION...]       options go to `pe optimize` after the demo's own
set -euo pipefail
cd "$(dirname "$0")/.."

readonly python=.venv/bin/python
readonly vehicle=blend_assets/sedan.blend
readonly output=demo_output
# Enough to see it work within a minute or two; the defaults of `pe optimize` take their time.
readonly OPTIONS=(--candidates 150 --samples 65536 --seed 0 --output "$output")

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
    "$blender" --factory-startup --addons bl_ext.user_default.perception_entropy \
        -b "$vehicle" --command pe "$@" </dev/null
}

in_bpy() {
    "$python" -m blender_addon "$vehicle" "$@" </dev/null
}

[ -e "$vehicle" ] || fail "$vehicle is missing"
mkdir -p "$output"
if blender=$("$python" tools/real_blender.py --host-only 2>/dev/null); then
    echo "demo: optimizing $vehicle in $blender"
    in_blender optimize "${OPTIONS[@]}" "$@"
elif "$python" -c 'import bpy' >/dev/null 2>&1; then
    echo "demo: optimizing $vehicle in bpy"
    in_bpy optimize "${OPTIONS[@]}" "$@"
else
    fail "needs Blender 4.2 or later in PATH, or a Python 3.11 or 3.13, which bpy exists for"
fi
"$python" tools/show_result.py "$output"
