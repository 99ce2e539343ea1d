#!/bin/sh
# Makes a package with the same files and another version from a package, for tests of an upgrade.
#
#   repack.sh FILE.deb SUFFIX OUT      e.g. +upgrade for a newer version, ~before for an older one
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
dpkg-deb -R "$1" "$work/package"
# Packages of one source depend on each other by their version.
version=$(sed -n 's/^Version: //p' "$work/package/DEBIAN/control")
sed -i "s/$version/$version$2/g" "$work/package/DEBIAN/control"
dpkg-deb -Znone --root-owner-group -b "$work/package" "$3" >/dev/null
