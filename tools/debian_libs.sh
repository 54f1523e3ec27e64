#!/usr/bin/env bash
# Installs the Debian packages named, or says which single line would.
#
# usage: tools/debian_libs.sh [--tests | --window] [PACKAGE...]
#
# Without names: the libraries that bpy, Blender as a Python module, is linked to. With --tests: all
# that `make test` needs, with --window: what installs a real Blender and shows its window.
set -euo pipefail

# The wheel carries the rest. Without libegl1 the first render ends the whole process.
readonly BPY_LIBS=(
    libx11-6 libxrender1 libxfixes3 libxi6 libxkbcommon0 libsm6 libgl1 libegl1
)
# Pages are opened in the first; Playwright's node, which drives it, is linked to the second.
readonly BROWSER_PACKAGES=(chromium libatomic1)
readonly WINDOW_PACKAGES=(debootstrap xvfb xdotool imagemagick libgl1-mesa-dri)

is_installed() {
    [ "$(dpkg-query --show --showformat='${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

# How to become root without a question: empty for root itself, fails when there is no way.
root_prefix() {
    [ "$(id -u)" -eq 0 ] && return 0
    sudo -n true 2>/dev/null && echo "sudo -n"
}

apt_quietly() {
    local log
    log=$(mktemp)
    # shellcheck disable=SC2086  # $prefix is no word, or two
    if ! $prefix env DEBIAN_FRONTEND=noninteractive apt-get -qq -y "$@" >"$log" 2>&1 </dev/null; then
        tail -n 5 "$log" >&2
        rm -f "$log"
        return 1
    fi
    rm -f "$log"
}

case "${1:-}" in
    "") wanted=("${BPY_LIBS[@]}") ;;
    --tests) wanted=("${BPY_LIBS[@]}" "${BROWSER_PACKAGES[@]}" "${WINDOW_PACKAGES[@]}" "${@:2}") ;;
    --window) wanted=("${WINDOW_PACKAGES[@]}" "${@:2}") ;;
    *) wanted=("$@") ;;
esac

if ! command -v dpkg-query >/dev/null; then
    echo "debian_libs: not a Debian system; what is needed goes there by the names ${wanted[*]}"
    exit 0
fi

missing=()
for package in "${wanted[@]}"; do
    is_installed "$package" || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

if ! prefix=$(root_prefix); then
    echo "debian_libs: packages are missing; run: sudo apt-get install -y ${missing[*]}" >&2
    exit 1
fi
echo "debian_libs: installing ${missing[*]}"
apt_quietly update || echo "debian_libs: apt-get update failed, going on with the old lists" >&2
apt_quietly install --no-install-recommends "${missing[@]}" || {
    echo "debian_libs: apt-get could not install ${missing[*]}" >&2
    exit 1
}
