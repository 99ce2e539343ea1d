#!/bin/sh
# Prints the files of the kernel's modules that modules.txt lists, and of those that they need: one path a line,
# such as usr/lib/modules/RELEASE/kernel/fs/fat/fat.ko, each once.
# Exits with 1 and a line for each listed module that the kernel does not have, neither as a file nor built in.
#
#   module_files.sh ROOT RELEASE [initrd]      ROOT has usr/lib/modules/RELEASE; with `initrd` only those of the initial RAM disk
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$1" && pwd) release=$2 kind=${3:-}
PATH=$PATH:/usr/sbin:/sbin
. "$here/arch.sh"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# A line is for every architecture, or for the one at the end of its first word.
awk -v arch="$ISOTHERM_ARCH" -v kind="$kind" '!/^#/ {
    line = $1
    sub("-" arch "$", "", line)
    if ((kind == "" && line ~ /^(initrd|root)$/) || (kind != "" && line == kind)) { $1 = ""; print }
}' "$here/modules.txt" | tr -s ' ' '\n' | sed '/^$/d' >"$work/names"

missing=0
while read -r name; do
    modprobe -d "$root" -S "$release" --show-depends "$name" >>"$work/needed" 2>"$work/error" || {
        echo "module_files.sh: $here/modules.txt: the kernel $release has no module $name" >&2
        missing=1
    }
done <"$work/names"
[ $missing = 0 ] || exit 1

awk '$1 == "insmod" { print $2 }' "$work/needed" | sed "s#^$root/*##; s#^lib/#usr/lib/#" | LC_ALL=C sort -u
