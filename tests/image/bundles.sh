# Bundles of updates for the test's machine: `. tests/image/bundles.sh`, in run.sh. Plain sh.

# seal_version VERSION ROOT OUT: makes the parts of a version from the root of the test's machine
seal_version() {
    mkdir -p "$3"
    sed -i "s/^IMAGE_VERSION=.*/IMAGE_VERSION=$1/" "$2/usr/lib/os-release"
    ISOTHERM_COMPRESSION=lz4 ISOTHERM_CMDLINE=$machine_cmdline \
        "$source_dir/board/image/seal.sh" "$2" "$ISOTHERM_CACHE" "$3" >"$out/bundles.log" 2>&1 || die "sealing: $(tail -n 5 "$out/bundles.log")"
}

# bundle KEY OUT NAME
bundle() {
    ISOTHERM_UPDATE_KEY=$out/keys/$1.key ISOTHERM_UPDATE_CERT=$out/keys/$1.crt \
        "$source_dir/board/image/bundle.sh" "$2" "$out/bundles/$3" >"$out/bundles.log" 2>&1 || die "bundle: $(tail -n 5 "$out/bundles.log")"
}

make_bundles() {
    [ ! -e "$out/bundles/complete" ] || return 0
    rm -rf "$out/bundles" "$out/versions"
    mkdir -p "$out/bundles" "$out/versions"
    bundle update "$out/test" same.raucb
    cp -a "$out/test/root" "$out/versions/root"
    seal_version 2.0.0 "$out/versions/root" "$out/versions/2"
    bundle update "$out/versions/2" v2.raucb
    bundle other "$out/versions/2" other_key.raucb
    # A byte of the root in the bundle: its signature is of the tree of hashes, so only who reads the bundle finds it.
    cp "$out/bundles/v2.raucb" "$out/bundles/damaged.raucb"
    change_bytes "$out/bundles/damaged.raucb" $((20 * 1048576)) 1 1
    cp -a "$out/versions/2" "$out/versions/other"
    sed -i 's/^IMAGE_ID=.*/IMAGE_ID=isotherm-rock-5b/' "$out/versions/other/os-release"
    bundle update "$out/versions/other" other_board.raucb
    # Version 3 has no first process: its kernel panics. Its initial RAM disk needs programs of the root, so they go afterwards.
    rm "$out/versions/root/usr/lib/systemd/systemd" "$out/versions/root/usr/bin/systemd" 2>/dev/null || true
    seal_version 3.0.0 "$out/versions/root" "$out/versions/3"
    bundle update "$out/versions/3" v3.raucb
    rm -rf "$out/versions"
    touch "$out/bundles/complete"
}
