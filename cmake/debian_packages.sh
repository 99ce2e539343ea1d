#!/bin/sh
# Builds the Debian packages for this machine's architecture, and the source package, from board/debian and a copy of the tree. The copy
# has the changes that are not committed, too.
#
#   debian_packages.sh OUT        empties OUT, then writes *.dsc, *.deb, *.changes and the log of the build there. It does nothing if
#                                 OUT has the packages of exactly this tree.
#
# Needs the tags `build` and `package` of packages.txt.
set -eu
source_dir=$(cd "$(dirname "$0")/.." && pwd)
version=$(dpkg-parsechangelog -l "$source_dir/board/debian/changelog" -S Version)
upstream=${version%-*}
project=$(sed -n 's/^project(isotherm VERSION \([0-9.]*\) .*/\1/p' "$source_dir/CMakeLists.txt")
[ "$upstream" = "$project" ] || {
    echo "board/debian/changelog has version $upstream, CMakeLists.txt $project" >&2
    exit 1
}

# A checksum of the names and contents of all packaged files.
tree_sum=$(cd "$source_dir" && git ls-files -z | xargs -0 sha256sum | sha256sum)
if [ "$(cat "$1/tree.sha256" 2>/dev/null)" = "$tree_sum" ]; then
    exit 0
fi
rm -rf "$1"
mkdir -p "$1"
out=$(cd "$1" && pwd)
tree=$out/isotherm-$upstream
mkdir "$tree"
(cd "$source_dir" && git ls-files -z | tar -c --null -T - -f -) | tar -x -C "$tree"
tar -c --sort=name --owner=0 --group=0 --mtime="@$(dpkg-parsechangelog -l "$source_dir/board/debian/changelog" -S Timestamp)" \
    -C "$out" "isotherm-$upstream" | gzip -n >"$out/isotherm_$upstream.orig.tar.gz"
cp -r "$source_dir/board/debian" "$tree/debian"

(cd "$tree" && dpkg-buildpackage -us -uc) >"$out/build.log" 2>&1 || {
    tail -n 40 "$out/build.log" >&2
    echo "debian_packages.sh: the build failed; whole log: $out/build.log" >&2
    exit 1
}
rm -rf "$tree"
echo "$tree_sum" >"$out/tree.sha256"
(cd "$out" && ls -- *.deb)
