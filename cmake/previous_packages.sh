#!/bin/sh
# Builds the Debian packages of the previous release from the history of this repository, for tests of an upgrade.
#
#   previous_packages.sh OUT [REVISION]     empties OUT, then writes what debian_packages.sh of that revision writes, and the revision in
#                                           OUT/revision. It does nothing if OUT has the packages of this revision.
#
# REVISION is by default the newest tag v*. No release has a tag yet; until then the first revision whose packages make a fleet counts.
# Needs the tags `build` and `package` of packages.txt, and the history (no shallow clone).
set -eu
first_fleet=f9df441c116deb592a1a35618ef537b45ad826df
source_dir=$(cd "$(dirname "$0")/.." && pwd)
wanted=${2:-$(git -C "$source_dir" describe --tags --abbrev=0 --match 'v*' HEAD 2>/dev/null || echo "$first_fleet")}
revision=$(git -C "$source_dir" rev-parse --verify --quiet "$wanted^{commit}") || {
    echo "previous_packages.sh: the history has no revision $wanted; a shallow clone needs git fetch --unshallow" >&2
    exit 1
}
if [ "$(cat "$1/revision" 2>/dev/null)" = "$revision" ]; then
    exit 0
fi
rm -rf "$1"
mkdir -p "$1"
out=$(cd "$1" && pwd)
git clone --quiet --shared --no-checkout "$source_dir" "$out/source"
git -C "$out/source" checkout --quiet "$revision"
"$out/source/cmake/debian_packages.sh" "$out/packages"
rm -rf "$out/source"
mv "$out"/packages/* "$out"
rmdir "$out/packages"
echo "$revision" >"$out/revision"
