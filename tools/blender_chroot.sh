#!/usr/bin/env bash
# A Blender that lives in a Debian folder of its own, beside whatever the host is.
#
# build:  tools/blender_chroot.sh --build SUITE FOLDER
# run:    FOLDER.sh ARGUMENTS...        a copy of this file, standing beside FOLDER
# ask:    tools/blender_chroot.sh --archive   where a build would take its packages from
#
# The run behaves like `blender ARGUMENTS`: same directory, same files, same environment, Blender's
# exit status. Mounts are made in a namespace of this process alone: they end with it, also when it
# is killed, and two runs do not meet.
set -euo pipefail

# Debian's package leaves out NumPy and what sid's Blender imports and opens on top; the last
# draws without a graphics card.
readonly PACKAGES=(
    blender python3-numpy python3-requests python3-zstandard python3-cattr
    libegl1 libgl1 libgl1-mesa-dri
)

in_private_mounts() {
    if [ "$(id -u)" -eq 0 ]; then
        exec unshare --mount "$0" "$@"
    fi
    exec unshare --map-root-user --mount "$0" "$@"
}

# What the system in the folder has of its own; everything else is the host's.
is_system_folder() {
    case "$1" in
        /bin | /boot | /etc | /lib* | /lost+found | /run | /sbin | /usr | /var) return 0 ;;
    esac
    return 1
}

share() {
    mkdir -p "$root$1" 2>/dev/null || [ -d "$root$1" ] || return 0
    mount --rbind "$1" "$root$1"
}

share_host_folders() {
    local folder
    for folder in /*; do
        [ -d "$folder" ] && [ ! -L "$folder" ] || continue
        is_system_folder "$folder" || share "$folder"
    done
    # A checkout or a temporary folder may yet stand below one of the system's.
    for folder in "$PWD" "${TMPDIR:-/tmp}" "${BLENDER_USER_RESOURCES:-/tmp}"; do
        case "$folder" in
            /usr/local/* | /usr/src/* | /var/* | /run/*) share "$folder" ;;
        esac
    done
}

# The addresses of apt's sources of packages, one a line; arguments narrow them down.
apt_sources() {
    # shellcheck disable=SC2016  # for apt to expand
    apt-get indextargets --format '$(REPO_URI)' 'Created-By: Packages' "$@" | sort -u
}

# The Debian archive that this machine's own packages come from: the suite alone is another.
# Apt knows which source that is once it has fetched lists; before, the address has to tell.
archive() {
    local found
    found=${DEBIAN_ARCHIVE:-$(apt_sources 'Origin: Debian' 'Label: Debian' | sed -n 1p)}
    [ -n "$found" ] || found=$(apt_sources --no-release-info | sed -nE '\#/debian(\.list)?/?$#p' | sed -n 1p)
    case "$found" in
        mirror+file:*) # a list of mirrors, the best first
            found=${found#mirror+file:}
            found=$(sed -nE 's#^([a-z]+://[^[:space:]]+).*#\1#p' "${found%/}" | sed -n 1p)
            ;;
    esac
    if [ -z "$found" ]; then
        echo "blender_chroot: no Debian archive among apt's sources; set DEBIAN_ARCHIVE" >&2
        return 1
    fi
    echo "$found"
}

# Apt's own proxy for all that fetches, unless the environment has one.
use_apt_proxy() {
    local proxy
    eval "$(apt-config shell proxy Acquire::http::Proxy)"
    [ -z "${proxy:-}" ] || [ "$proxy" = DIRECT ] || export http_proxy="${http_proxy:-$proxy}"
    proxy=
    eval "$(apt-config shell proxy Acquire::https::Proxy)"
    [ -z "${proxy:-}" ] || [ "$proxy" = DIRECT ] || export https_proxy="${https_proxy:-$proxy}"
}

build() {
    local suite=$1 from
    root=$2
    from=$(archive)
    use_apt_proxy
    debootstrap --variant=minbase "$suite" "$root" "$from"
    mount --rbind /dev "$root/dev"
    mount -t proc proc "$root/proc" || mount --rbind /proc "$root/proc"
    export DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8
    # The release file of a suite that moves may be older than its own limit says.
    chroot "$root" apt-get -y -o Acquire::Check-Valid-Until=false update
    chroot "$root" apt-get -y install --no-install-recommends "${PACKAGES[@]}"
    chroot "$root" apt-get clean
    ln -sf /proc/self/mounts "$root/etc/mtab"  # Blender complains without
    chroot "$root" blender --version
}

run() {
    root=${0%.sh}
    share_host_folders
    # The host's PATH could lead to a Python that does not run in there.
    export PATH=/usr/sbin:/usr/bin:/sbin:/bin LC_ALL=C.UTF-8
    # shellcheck disable=SC2016  # for the inner shell to expand
    exec chroot "$root" /bin/sh -c 'cd "$1" && shift && exec blender "$@"' sh "$PWD" "$@"
}

case "${1:-}" in
    --build) shift && in_private_mounts --build-inside "$@" ;;
    --build-inside) shift && build "$@" ;;
    --archive) archive && use_apt_proxy && echo "proxy ${http_proxy:-none}" ;;
    --run-inside) shift && run "$@" ;;
    *) in_private_mounts --run-inside "$@" ;;
esac
