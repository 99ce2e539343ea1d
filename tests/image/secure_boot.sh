# Secure Boot: `. tests/image/secure_boot.sh`, in run.sh. Plain sh. The firmware is OVMF or AAVMF with the certificate "SnakeOil" of its Debian
# package as platform key, key exchange key and only entry of the list of signers. The package also has its key, so everybody has it: it is for
# tests.

# The test's image, signed: the same root, a kernel image and a boot loader with signatures.
make_signed_image() {
    rm -rf "$out/signed"
    mkdir "$out/signed"
    openssl rsa -in "$machine_keys/PkKek-1-snakeoil.key" -passin pass:snakeoil -out "$out/keys/secure_boot.key" 2>"$out/keys/log" ||
        die "the key of the firmware: $(cat "$out/keys/log")"
    (
        ISOTHERM_SB_KEY=$out/keys/secure_boot.key ISOTHERM_SB_CERT=$machine_keys/PkKek-1-snakeoil.pem
        ISOTHERM_COMPRESSION=lz4 ISOTHERM_CMDLINE=$machine_cmdline
        export ISOTHERM_SB_KEY ISOTHERM_SB_CERT ISOTHERM_COMPRESSION ISOTHERM_CMDLINE
        "$source_dir/board/image/seal.sh" "$out/test/root" "$ISOTHERM_CACHE" "$out/signed"
        "$source_dir/board/image/disk.sh" "$out/signed" "$ISOTHERM_CACHE"
    ) >"$out/signed.log" 2>&1 || die "signing: $(tail -n 5 "$out/signed.log")"
}

# The signed image starts; the same one with a kernel image that is not signed does not.
secure_boot() {
    make_signed_image
    disk=$machine_out/signed.img
    mv "$out/signed/isotherm.img" "$disk"
    mcopy -i "$disk@@$(start_of esp)" "$out/test/root/usr/lib/isotherm-image/test.conf" ::isotherm.conf
    machine_disk "$disk" "$machine_out/signed.qcow2"
    machine_firmware=secure machine_start secure secure "$machine_out/signed.qcow2" || die_with secure $?
    tell secure
    mcopy -o -i "$disk@@$(start_of esp)" "$out/test/isotherm.efi" ::EFI/Linux/isotherm-a.efi
    machine_disk "$disk" "$machine_out/signed.qcow2"
    # It waits in the firmware's menu then.
    machine_firmware=secure watched_start unsigned secure "$machine_out/signed.qcow2" 'Error loading .*isotherm-a.efi' 1 && die 'a kernel image without a signature starts'
    [ -e "$machine_out/unsigned.cut" ] || die_with unsigned 'the boot loader does not say that it cannot load the kernel image'
    ! grep -q 'Linux version' "$machine_out/unsigned.log" || die 'a kernel image without a signature starts'
    rm -rf "$disk" "$machine_out/signed.qcow2" "$out/signed"
    say "without a signature: $(grep -a -o 'Error loading .*' "$machine_out/unsigned.log" | tr -d '\r' | head -n 1)"
}
