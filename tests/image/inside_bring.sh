# How an update comes to the running image, and the code for the first account: `. tests/image/inside_bring.sh`, in inside.sh. Plain sh. A USB
# stick with version 2 is in the machine.

update_result() {
    cat /var/lib/isotherm-update/result.json 2>/dev/null | tr -d '\n' | grep -q "$1"
}

# As the web server would do it.
page_brings() {
    cp "$VM_SOURCE/$images/bundles/$1" /var/lib/isotherm-update/page/bundle.part
    chown isotherm-web:isotherm-web /var/lib/isotherm-update/page/bundle.part
    chmod 0600 /var/lib/isotherm-update/page/bundle.part
    mv /var/lib/isotherm-update/page/bundle.part /var/lib/isotherm-update/page/bundle.raucb
}

nothing_is_left() {
    [ -z "$(find /var/lib/isotherm-update -name '*.raucb')" ]
}

# As at the next start.
a_stick_that_stays_in_is_quiet() {
    cp /var/lib/isotherm-update/result.json "$story_scratch/result"
    systemctl start "isotherm-stick@$(basename "$(readlink -f /dev/disk/by-label/UPDATES)").service" || die 'the unit of the stick fails'
    cmp -s /var/lib/isotherm-update/result.json "$story_scratch/result" || die "the stick has a result again: $(cat /var/lib/isotherm-update/result.json)"
    journalctl --sync
    journalctl --no-pager --boot | grep -q 'stick-update: the update on /dev/.* was installed before' || die 'the journal does not say that the update was installed before'
    say 'a stick that stays in is not installed again'
}

brought() {
    rest_inputs
    ln -s "$VM_SOURCE/sim/stored" /srv/stored
    wait_for 60 'the configuration of the EFI system partition is not taken' [ -e /etc/isotherm/isotherm.conf ]
    wait_for 60 'the daemon does not start' unit_is active
    wait_for 120 'the update on the stick is not installed' update_result '"from":"stick",.*"installed": true'
    entries_are '/efi/EFI/Linux/isotherm-a.efi /efi/EFI/Linux/isotherm-b+3.efi' || die "after the stick: $(entries)"
    ! findmnt -n -t vfat -o TARGET | grep -qv "^/efi$" || die 'the stick stays mounted'
    wait_for 60 'the copy of the stick is not removed' nothing_is_left
    say 'a USB stick: version 2 is in slot b'
    a_stick_that_stays_in_is_quiet
    page_brings other_board.raucb
    wait_for 120 'the update by the page is not refused' update_result '"from":"page",.*"code": "other-board"'
    wait_for 60 'the bundle of the page is not removed' nothing_is_left
    page_brings v2.raucb
    wait_for 120 'the update by the page is not installed' update_result '"from":"page",.*"installed": true'
    say 'the folder of the page: for another board, refused; version 2, installed'
    isotherm log --json | tr -d '\n' | grep -q 'update-installed, asked by page of user' || die 'the update is not on record'
    journalctl --sync
    code=$(cat /run/isotherm-web/setup-code)
    journalctl --no-pager --boot --unit isotherm-web | grep -q "the code for the first account, valid until an hour after the start: $code" || die 'the code is not in the journal'
    [ "$(stat -c '%a %U %G' /run/isotherm-web/setup-code)" = '640 isotherm-web isotherm-web' ] || die 'others can read the code'
    say 'a code for the first account of the web server waits'
    wait_for 60 'the machine does not settle' settled
    nothing_else_runs
}
