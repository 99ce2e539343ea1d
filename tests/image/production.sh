# The check of the image for doors, from its root and not by starting it: `. tests/image/production.sh`. Plain sh. Uses out, say, die of
# run.sh.

# in_production COMMAND...
in_production() {
    chroot "$out/production/root" /usr/bin/env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin "$@"
}

# Prints the programs and libraries of the image.
binaries() {
    find "$out/production/root/usr/bin" "$out/production/root/usr/sbin" "$out/production/root/usr/lib" \
        \( -path '*/modules/*' -o -path '*/firmware/*' \) -prune -o -type f \( -perm /111 -o -name '*.so*' \) -print |
        xargs -n 50 file -F ' ' | awk '/ELF .*dynamically linked/ { print $1 }'
}

# Every library that a program names is there, although some packages are not complete (leave_out.txt).
libraries_are_there() {
    binaries | sed "s#^$out/production/root##" >"$out/binaries"
    [ "$(wc -l <"$out/binaries")" -gt 200 ] || die 'the list of programs is too short'
    missing=$(in_production sh -c 'while read -r name; do LD_LIBRARY_PATH=/usr/lib/'"$arch_multiarch"'/systemd ldd "$name" 2>/dev/null | sed -n "s#=> not found#is missing for $name#p"; done' <"$out/binaries" | sort -u)
    # libGLX opens its drivers by name when a program draws; nothing here draws by it.
    [ -z "$missing" ] || die "$missing"
    say "$(wc -l <"$out/binaries") programs and libraries have what they need"
}

# The modules with OpenCV can be loaded, with every symbol that they and their libraries name.
modules_can_be_loaded() {
    (cd "$out/production/root" && find usr/lib -name 'isotherm-*.so') >"$out/modules"
    grep -q isotherm-stereo "$out/modules" && grep -q isotherm-vision "$out/modules" || die 'the modules with OpenCV are missing'
    while read -r module; do
        fault=$(in_production env LD_BIND_NOW=1 "LD_PRELOAD=/$module" /bin/true 2>&1) && [ -z "$fault" ] || die "$module: $fault"
    done <"$out/modules"
    say "$(wc -l <"$out/modules") modules can be loaded with all symbols"
}

nobody_can_log_in() {
    root=$out/production/root
    found=$(cut -d : -f 1,7 "$root/etc/passwd" | grep -v ':/usr/sbin/nologin$' || true)
    [ -z "$found" ] || die "accounts with a shell: $found"
    found=$(cut -d : -f 1,2 "$root/etc/shadow" | grep -vE ':[!*]+$' || true)
    [ -z "$found" ] || die "accounts with a password: $found"
    for name in usr/bin/login usr/sbin/agetty usr/sbin/sulogin usr/bin/su usr/sbin/sshd usr/bin/sudo usr/bin/dpkg; do
        [ ! -e "$root/$name" ] || die "the image has $name"
    done
    for unit in getty.target getty@.service serial-getty@.service debug-shell.service; do
        [ "$(readlink "$root/etc/systemd/system/$unit")" = /dev/null ] || die "$unit is not masked"
    done
    say 'no account has a shell or a password, and no unit gives one'
}

# What the test adds is in its own image only.
no_trace_of_the_test() {
    found=$(cd "$out/production/root" && find . -name 'image-test*' -o -name 'gpio-sim*' -o -name '9p.ko' -o -path ./usr/lib/isotherm-image/test)
    [ -z "$found" ] || die "the image for doors has $found"
    ! grep -q '^ada:' "$out/production/root/etc/passwd" || die 'the image for doors has an account of the test'
    [ -e "$out/test/root/usr/lib/isotherm-image/test" ] || die 'this check would not find what it looks for'
    ! grep -q "$machine_console" "$out/production/cmdline" || die 'the image for doors has a console on a serial line'
    say 'nothing of the test is in the image for doors'
}

# Each package has its licence, and the list of packages has each licence's package.
licences_are_complete() {
    missing=$(cut -f 1 "$out/production/root/usr/lib/isotherm-image/packages" | while read -r name; do
        [ -e "$out/production/root/usr/share/doc/$name/copyright" ] || echo "$name"
    done)
    [ -z "$missing" ] || die "without a licence: $missing"
    say "$(wc -l <"$out/production/root/usr/lib/isotherm-image/packages") packages have their licences"
}

production() {
    libraries_are_there
    modules_can_be_loaded
    nobody_can_log_in
    no_trace_of_the_test
    licences_are_complete
}
