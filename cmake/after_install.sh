#!/bin/sh
# Tells the system of what `make install` has put into place, as the scripts of a package would: users and groups, folders, the unit,
# the policy of the bus, the rules of udev. It starts nothing. It does nothing where the files went to a staging folder.
# usage: after_install.sh [DESTDIR]
set -eu
[ -z "${1:-}" ] || exit 0

systemd-sysusers
systemd-tmpfiles --create isotherm.conf
[ -d /run/systemd/system ] || exit 0 # systemd does not run: the next boot reads the rest

systemctl daemon-reload
systemctl reload dbus.service
if systemctl --quiet is-active systemd-udevd.service; then
    udevadm control --reload
fi
