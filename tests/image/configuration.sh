#!/bin/sh
# Tests board/image/programs/take-configuration on a directory instead of the root of the image. isothermd is that of the build.
#
#   configuration.sh SOURCE BUILD
set -eu
umask 077
program=$1/board/image/programs/take-configuration build=$2
ISOTHERM_ROOT=$(mktemp -d)
JOURNAL_STREAM=1:1 # as in a unit
export ISOTHERM_ROOT JOURNAL_STREAM
trap 'rm -rf "$ISOTHERM_ROOT"' EXIT
root=$ISOTHERM_ROOT
given=$root/efi/isotherm.conf own=$root/etc/isotherm/isotherm.conf fault=$root/efi/isotherm-fault.txt
taken=$root/var/lib/isotherm-image/taken.conf
secure_boot=$root/sys/firmware/efi/efivars/SecureBoot-8be4df61-93ca-11d2-aa0d-00e098032b8c
mkdir -p "$root/bin" "$root/cut" "$root/efi/EFI/Linux" "$root/etc/isotherm" "$root/run/isotherm" "$root/var/lib" "${secure_boot%/*}"

die() {
    echo "FAILED: $1"
    cat "$root/said" "$fault" 2>/dev/null || true
    exit 1
}

# program PATH: makes a program from standard input
program() {
    { echo '#!/bin/sh'; cat; } >"$1"
    chmod 755 "$1"
}

program "$root/bin/isothermd" <<END
exec "$build/firmware/isothermd" "\$@"
END
PATH=$root/bin:$PATH

# configuration LEVEL: prints a configuration that differs from those of other levels
configuration() {
    printf '[sensor]\nbackend = replay\npath = /srv/slot\n[decision]\nlevel = %s\n' "$1"
}

give() {
    configuration "$1" >"$given"
}

# ends CODE WORDS: the program ends with this code and says these words; "" stands for no word at all
ends() {
    code=0
    "$program" >"$root/said" 2>&1 || code=$?
    [ $code -eq "$1" ] || die "it ends with $code, not with $1"
    if [ -n "$2" ]; then
        grep -q "$2" "$root/said" || die "it does not say: $2"
    else
        [ ! -s "$root/said" ] || die 'it says something'
    fi
}

# has LEVEL [FORMER]: the configuration has this level, and the one before it the other
has() {
    configuration "$1" | cmp -s - "$own" || die "the configuration is not $1"
    [ -z "${2:-}" ] || configuration "$2" | cmp -s - "$own.former" || die "the former configuration is not $2"
    [ "$(stat -c %a "$own")" = 644 ] || die 'others than root cannot read the configuration'
    found=$(cd "$root/etc/isotherm" && find . -name '*.draft' -o -name '*.replacement')
    [ -z "$found" ] || die "it leaves $found"
}

# tells WORDS: the file on the EFI system partition says them
tells() {
    grep -q "$1" "$fault" || die "the file for people does not say: $1"
}

tells_nothing() {
    [ ! -e "$fault" ] || die 'the file for people still tells of a fault'
}

set_secure_boot() {
    printf '\006\000\000\000\00'"$1" >"$secure_boot"
}

echo SLOT=b >"$root/run/isotherm/slot"
set_secure_boot 0

# ---- a door without a configuration ----
ends 0 'no configuration, and no isotherm.conf'
configuration balanced | sed 's/^level/leavel/' >"$given"
ends 1 "not taken: isotherm.conf:5: unknown key 'leavel'"
tells "not taken: isotherm.conf:5: unknown key 'leavel'"
[ ! -e "$own" ] || die 'a configuration with a fault is taken'
# Also with Secure Boot, and in a version on trial.
set_secure_boot 1
: >"$root/efi/EFI/Linux/isotherm-b+2-1.efi"
give balanced
ends 0 'the configuration is that of'
has balanced
tells_nothing
[ ! -e "$own.former" ] || die 'a new door has a former configuration'
ends 0 ''
rm "$root/efi/EFI/Linux/isotherm-b+2-1.efi"
set_secure_boot 0
echo '    a new door: no file, a file with a fault, a good one'

# ---- another configuration later ----
give strict
ends 0 'the configuration is that of'
has strict balanced
# What was changed on the door stays: only a new content of the file is taken.
configuration convenient >"$own"
ends 0 ''
has convenient
give balanced
ends 0 'the configuration is that of'
has balanced convenient
ends 0 ''
has balanced convenient
# A version of the image that kept no copy of the file.
rm -r "${taken%/*}"
give strict
ends 0 'the configuration is that of'
has strict balanced
rm "$given"
ends 0 ''
has strict balanced
echo '    a later file is taken once, and the former configuration is kept'

# ---- refusals ----
configuration nonsense >"$given"
ends 1 'isotherm.conf:5: .*level'
tells 'isotherm.conf:5: .*level'
written=$(stat -c %y "$fault")
ends 1 'isotherm.conf:5: .*level'
[ "$(stat -c %y "$fault")" = "$written" ] || die 'it writes the same fault again'
{ configuration balanced; head -c 70000 /dev/zero | tr '\0' '#'; } >"$given"
ends 1 'more than 65536 bytes'
: >"$given"
ends 1 'isotherm.conf of the EFI system partition is not taken: sensor'
rm "$given"
mkdir "$given"
ends 1 'it is not a file'
tells 'it is not a file'
rmdir "$given"
has strict balanced
give strict
ends 0 ''
tells_nothing
give balanced
set_secure_boot 1
ends 1 'Secure Boot is on'
rm "$secure_boot"
ends 1 'its state is unknown'
tells 'Secure Boot'
has strict balanced
set_secure_boot 0
: >"$root/efi/EFI/Linux/isotherm-b+2-1.efi"
ends 0 'has to wait until this version is found to be good'
has strict balanced
tells_nothing
mv "$root/efi/EFI/Linux/isotherm-b+2-1.efi" "$root/efi/EFI/Linux/isotherm-b.efi"
ends 0 'the configuration is that of'
has balanced strict
tells_nothing
echo '    refused: a value, no value, size, a folder, Secure Boot; a version on trial waits'

# ---- power cuts ----
# Before one of these programs does its work, the one that called it is killed, if as many have been called as the file says.
for name in head cp chmod sync mv mkdir rm; do
    program "$root/cut/$name" <<END
read -r left <"$root/left"
echo \$((left - 1)) >"$root/left"
[ \$left -ne 1 ] || { kill -9 \$PPID; exit 1; }
exec $(command -v "$name") "\$@"
END
done

# starts LEFT: runs the program, and kills it at the step LEFT; 0: it comes to its end. Sets code.
starts() {
    echo "$1" >"$root/left"
    code=0
    PATH=$root/cut:$PATH "$program" >"$root/said" 2>&1 || code=$?
}

# cut_at STEP: a power cut at this step of a change from balanced to strict leaves one of both whole, and the next start gives strict, with
# balanced as the former one. Returns 1 if the program has fewer steps.
cut_at() {
    mkdir -p "${taken%/*}"
    configuration balanced | tee "$own" >"$taken"
    rm -f "$own.former"
    give strict
    starts "$1"
    [ $code -ne 0 ] || return 1
    [ $code -eq 137 ] || die "at step $1 it ends with $code and is not killed"
    configuration balanced | cmp -s - "$own" || configuration strict | cmp -s - "$own" ||
        die "a power cut at step $1 leaves neither configuration"
    starts 0
    [ $code -eq 0 ] || die "the start after a power cut at step $1 ends with $code"
    has strict balanced
    starts 0
    [ $code -eq 0 ] && [ ! -s "$root/said" ] || die "after a power cut at step $1 the file is taken again and again"
}

step=1
while cut_at $step; do
    step=$((step + 1))
done
[ $step -gt 10 ] || die "only $step steps are found"
echo "    a power cut at each of $((step - 1)) steps leaves one configuration whole"
