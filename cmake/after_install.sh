#!/bin/sh
# Makes the system read the files that `make install` has installed, as the scripts of a package would: users and groups, folders, the
# unit, the policy of the bus, the rules of udev. It starts nothing. It does nothing if the files went to a staging folder.
# usage: after_install.sh [DESTDIR]
set -eu
[ -z "${1:-}" ] || exit 0

systemd-sysusers
systemd-tmpfiles --create isotherm.conf
[ -d /run/systemd/system ] || exit 0 # systemd does not run: it reads the other files at the next boot

systemctl daemon-reload
systemctl reload dbus.service
if systemctl --quiet is-active systemd-udevd.service; then
    udevadm control --reload
fi
