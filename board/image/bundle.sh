#!/bin/sh
# Makes an update of what build.sh has made: a signed bundle for RAUC with root, tree of hashes and kernel image.
#
#   bundle.sh OUT BUNDLE      OUT: as for build.sh; makes the file BUNDLE
#
# ISOTHERM_UPDATE_KEY, ISOTHERM_UPDATE_CERT: key and certificate. The images that shall take the update have the certificate.
set -eu
out=$(cd "$1" && pwd) bundle=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/content"
ln "$out/root.squashfs" "$work/content/root.img" 2>/dev/null || cp "$out/root.squashfs" "$work/content/root.img"
cp "$out/root.verity" "$work/content/verity.img"
cp "$out/isotherm.efi" "$work/content/isotherm.efi"
of() {
    sed -n "s/^$1=//p" "$out/os-release"
}
# Each by itself: a command that fails within the text below would not end the script.
arch=$(cat "$out/arch")
id=$(of IMAGE_ID)
version=$(of IMAGE_VERSION)
if [ -z "$id" ] || [ -z "$version" ]; then
    echo "bundle.sh: $out/os-release: no IMAGE_ID or no IMAGE_VERSION" >&2
    exit 1
fi
cat >"$work/content/manifest.raucm" <<END
[update]
compatible=$id-$arch
version=$version

[bundle]
format=verity

[image.root]
filename=root.img

[image.verity]
filename=verity.img
END
rm -f "$bundle"
rauc bundle --cert="$ISOTHERM_UPDATE_CERT" --key="$ISOTHERM_UPDATE_KEY" "$work/content" "$bundle" >&2
