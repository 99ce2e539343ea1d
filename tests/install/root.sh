#!/bin/sh
# Makes a minimal Debian 12 that systemd boots, as one tar file, from Debian's archive. It has no udev, which in a container would act on
# the devices of this machine.
#
#   root.sh TAR        does nothing if the file exists
#
# Needs root and mmdebstrap.
set -eu
tar=$1
[ ! -s "$tar" ] || exit 0
mkdir -p "$(dirname "$tar")"
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
mmdebstrap --quiet --format=tar --variant=apt --include=systemd,systemd-sysv,dbus,ca-certificates bookworm "$tar.new" \
    "deb [signed-by=$keyring] http://deb.debian.org/debian bookworm main" \
    "deb [signed-by=$keyring] http://deb.debian.org/debian bookworm-updates main" \
    "deb [signed-by=$keyring] http://deb.debian.org/debian-security bookworm-security main"
mv "$tar.new" "$tar"
