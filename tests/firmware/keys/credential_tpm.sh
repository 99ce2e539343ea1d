#!/bin/sh
# The key of the appliance is a credential of systemd that a TPM has sealed, as isothermd(8) describes it. A software TPM (swtpm)
# seals and opens it. The daemon's log can be opened with it, and not without it. Skipped (77) without swtpm or systemd-creds.
# usage: credential_tpm.sh BUILD
set -eu
isothermd=$1/firmware/isothermd
for tool in swtpm swtpm_setup systemd-creds; do
    command -v $tool >/dev/null || {
        echo "skipped: there is no $tool"
        exit 77
    }
done

work=$(mktemp -d)
tpm=
end() {
    [ -z "$tpm" ] || kill "$tpm" 2>/dev/null || true
    rm -rf "$work"
}
trap end EXIT

die() {
    echo "credential_tpm: $1" >&2
    exit 1
}

mkdir "$work/tpm" "$work/given" "$work/state"
swtpm_setup --tpm2 --tpm-state "$work/tpm" >"$work/setup.log" 2>&1 || {
    echo 'skipped: the software TPM cannot be set up'
    exit 77
}
# Sockets in the directory of this test: a port could be in use by another one.
swtpm socket --tpm2 --tpmstate dir="$work/tpm" --server type=unixio,path="$work/socket" \
    --ctrl type=unixio,path="$work/socket.ctrl" --flags not-need-init,startup-clear 2>"$work/swtpm.log" &
tpm=$!
# The list of the kernel says when it listens. A connection would take the place of the only client. 00010000: it listens.
listens() {
    grep -q " 00010000 .* $work/$1\$" /proc/net/unix
}
attempts=300
until listens socket && listens socket.ctrl; do
    kill -0 "$tpm" 2>/dev/null || die "the software TPM ended: $(cat "$work/swtpm.log")"
    attempts=$((attempts - 1))
    [ $attempts -gt 0 ] || die 'the software TPM does not listen'
    sleep 0.1
done
device=swtpm:path=$work/socket

head -c 32 /dev/urandom >"$work/key"
systemd-creds encrypt --with-key=tpm2 --tpm2-device=$device --tpm2-pcrs=7 --name=isotherm.key "$work/key" \
    "$work/isotherm.key" 2>"$work/creds.log" || {
    cat "$work/creds.log"
    echo 'skipped: systemd-creds has no TPM support here'
    exit 77
}
cmp -s "$work/key" "$work/isotherm.key" && die 'the credential is the key itself'
systemd-creds decrypt --tpm2-device=$device --name=isotherm.key "$work/isotherm.key" "$work/given/isotherm.key" 2>/dev/null
cmp "$work/key" "$work/given/isotherm.key"

cat >"$work/isotherm.conf" <<END
[gallery]
path = $work/state/gallery.db
[log]
path = $work/state/audit.log
END
CREDENTIALS_DIRECTORY=$work/given "$isothermd" --config "$work/isotherm.conf" --print-log
[ -e "$work/state/gallery.db.keys" ] || die 'there is no key ring'
[ ! -e "$work/state/gallery.db.key" ] || die 'a key file was made'
CREDENTIALS_DIRECTORY=$work/given "$isothermd" --config "$work/isotherm.conf" --print-log
"$isothermd" --config "$work/isotherm.conf" --print-log 2>"$work/refused" && die 'it opens without the key'
grep -q 'is gone; without it nothing sealed can be read' "$work/refused" || die "$(cat "$work/refused")"
