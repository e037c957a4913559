# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# To be sourced by root, who needs mmdebstrap: a bare Debian of a release in $root, which goes when the script ends.
[ "$(id -u)" = 0 ] || { echo "${0##*/}: skipped: not root"; exit 77; }
unshare --mount --net true 2>/dev/null || { echo "${0##*/}: skipped: mounts are forbidden here"; exit 77; }
command -v mmdebstrap >/dev/null || { echo "${0##*/}: no mmdebstrap; ci/install_deps installs it" >&2; exit 2; }
root=$(mktemp -d)
trap 'umount -R "$root/proc" "$root/dev" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
bare_debian() {  # a mirror that is kept as it was on one day has lists that are out of date
  mmdebstrap --quiet --variant=minbase --aptopt='Acquire::Check-Valid-Until "false"' --include=ca-certificates,git "$1" "$root"
  mount -t proc proc "$root/proc"
  mount --rbind --make-rslave /dev "$root/dev"
}
within() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"; }
