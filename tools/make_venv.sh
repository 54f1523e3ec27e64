#!/usr/bin/env bash
# Makes .venv, with Blender as a Python module (bpy) where there is one, and installs the project.
#
# usage: tools/make_venv.sh EXTRAS STAMP      EXTRAS as pip takes them: blender,test
#
# STAMP is a file that is made when nothing is missing. Without it the next `make` comes here again.
#
# PYTHON=... names the interpreter. Otherwise: the first that runs, 3.11 and 3.13 before others,
# because those are the two that bpy is published for.
set -euo pipefail
cd "$(dirname "$0")/.."

readonly extras=${1:?usage: tools/make_venv.sh EXTRAS STAMP}
readonly stamp=${2:?usage: tools/make_venv.sh EXTRAS STAMP}
readonly venv=.venv

fail() {
    echo "make_venv: $*" >&2
    exit 1
}

# Prints the version when the interpreter runs. A pyenv shim may exist and yet not run.
version_of() {
    "$1" -c 'import sys; print("%d.%d" % sys.version_info[:2])' 2>/dev/null
}

candidates() {
    local version
    for version in 3.11 3.13; do
        echo "python$version"
        echo "/usr/bin/python$version"
        ls -d "$HOME/.pyenv/versions/$version".*/bin/python3 2>/dev/null || true
        echo python3 /usr/bin/python3 | tr ' ' '\n'
    done
}

# The first candidate of the version wanted ("any": of 3.11 or later) that can make environments.
find_python() {
    local python version
    for python in $(candidates); do
        version=$(version_of "$python") || continue
        if [ "$1" = any ]; then
            [ "${version#3.}" -ge 11 ] || continue
        elif [ "$version" != "$1" ]; then
            continue
        fi
        "$python" -c 'import ensurepip, venv' 2>/dev/null || continue
        echo "$python"
        return
    done
    return 1
}

choose_python() {
    if [ -n "${PYTHON:-}" ]; then
        version_of "$PYTHON" >/dev/null || fail "PYTHON=$PYTHON does not run"
        echo "$PYTHON"
    else
        find_python 3.11 || find_python 3.13 || find_python any
    fi
}

make_environment() {
    local python
    if ! python=$(choose_python); then
        # Debian keeps ensurepip in a package of its own.
        tools/debian_libs.sh python3-venv
        python=$(choose_python) || fail "no Python 3.11 or later found; set PYTHON=..."
    fi
    echo "make_venv: $venv from $python ($(version_of "$python"))"
    "$python" -m venv --clear "$venv"
}

install() {
    "$venv/bin/python" -m pip install -qq --disable-pip-version-check --no-input \
        --editable ".[$1]" </dev/null
}

# Fails where bpy does not start, or a library is missing that only rendering needs: the import
# alone would not miss it. The last line then names what to install.
check_bpy() {
    local version hint reason has_libs=
    version=$(version_of "$venv/bin/python")
    case "$version" in
        3.11 | 3.13) ;;
        *)
            echo "make_venv: no bpy for Python $version; the engine works, Blender parts do not"
            return
            ;;
    esac
    { hint=$(tools/debian_libs.sh 2>&1 >&3) && has_libs=yes; } 3>&1 || true
    if ! reason=$("$venv/bin/python" -c 'import bpy' 2>&1 >/dev/null); then
        echo "make_venv: bpy does not start (${reason##*$'\n'});" \
            "the engine works, Blender parts do not" >&2
    elif [ -n "$has_libs" ]; then
        return
    fi
    [ -z "$hint" ] || echo "$hint" >&2
    return 1
}

is_complete() {
    case ",$extras," in
        *,blender,*) check_bpy ;;
    esac
}

version_of "$venv/bin/python" >/dev/null || make_environment
install "$extras" || fail "pip could not install .[$extras]"
if is_complete; then touch "$stamp"; fi
