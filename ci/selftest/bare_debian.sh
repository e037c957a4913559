# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# To be sourced by root, who needs mmdebstrap: a bare Debian of a release in $root, which goes when the script ends.
[ "$(id -u)" = 0 ] || { echo "${0##*/}: skipped: not root"; exit 77; }
unshare --mount --net true 2>/dev/null || { echo "${0##*/}: skipped: mounts are forbidden here"; exit 77; }
command -v mmdebstrap >/dev/null || { echo "${0##*/}: no mmdebstrap; ci/install_deps installs it" >&2; exit 2; }
root=$(mktemp -d)
trap 'umount -R "$root" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT
bare_debian() {  # a mirror that is kept as it was on one day has lists that are out of date
  mmdebstrap --quiet --variant=minbase --aptopt='Acquire::Check-Valid-Until "false"' --include=ca-certificates,git "$1" "$root"
  [ -e "$root/etc/hosts" ] || echo '127.0.0.1 localhost' >"$root/etc/hosts"  # as an installer writes
  mount --bind "$root" "$root"
  mount -t proc proc "$root/proc"
  mount --rbind --make-rslave /dev "$root/dev"
}
within() {  # a root of its own: in a chroot nobody may have a network of his own, as tests want it
  unshare --mount bash -c 'cd "$0" && pivot_root . mnt && umount -l /mnt && exec env -i "$@"' "$root" \
    PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root DEBIAN_FRONTEND=noninteractive "$@"
}
