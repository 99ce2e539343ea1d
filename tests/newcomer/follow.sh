#!/bin/sh
# Follows a page for newcomers in a copy of the tree:
#   ```c PATH     is the text of a new file
#   ```diff       is applied with patch -p1, which finds the place by the lines and not by line numbers. Each hunk needs
#                 as many lines before its change as after it; otherwise patch searches only one end of the file
#   ```sh         is run in the copy
#   ```text       has lines that the commands before it must have printed
# The copy keeps its build folder, so that a second run compiles only what is new.
# usage: follow.sh ROOT WORK PAGE     PAGE as seen from ROOT
set -eu
root=$(cd "$1" && pwd)
page=$3
mkdir -p "$2"
work=$(cd "$2" && pwd)
tree=$work/tree
blocks=$work/blocks

fail() {
    echo "$page: $*" >&2
    exit 1
}

# ---- the copy: it keeps the times of files, so that only the changes of a page are compiled anew. The files that any page has changed so
# far are touched in every run: a run that failed may have left objects of them.
mkdir -p "$tree"
find "$tree" -mindepth 1 -maxdepth 1 ! -name build -exec rm -rf {} +
find "$root" -mindepth 1 -maxdepth 1 ! -name build ! -name out ! -name .git -exec cp -a {} "$tree" \;
cd "$tree"
touch "$work/changed"
sort -u -o "$work/changed" "$work/changed"
while read -r file; do
    [ ! -e "$file" ] || touch "$file"
done <"$work/changed"

# ---- the blocks of the page, one file each: NUMBER.KIND, and NUMBER.path
rm -rf "$blocks"
mkdir "$blocks"
awk -v blocks="$blocks" '
    /^```/ && inside { inside = 0; close(file); next }
    /^```/ { inside = 1; n++; split(substr($0, 4), word, " ")
             file = sprintf("%s/%03d.%s", blocks, n, word[1])
             printf "" >file
             if (word[2]) print word[2] >sprintf("%s/%03d.path", blocks, n)
             next }
    inside { print >file }
    END { exit inside }' "$page" || fail "a block has no end"

# ---- follow the blocks
write_file() {
    path=$(cat "${1%.c}.path") || fail "a block of C has no path"
    [ ! -e "$path" ] || fail "$path exists already"
    mkdir -p "$(dirname "$path")"
    cp "$1" "$path"
    echo "$path" >>"$work/changed"
}

# The page has no line numbers: patch finds each hunk by its lines.
apply_diff() {
    sed -n 's,^+++ b/,,p' "$1" >>"$work/changed"
    awk -v out="$1.whole" '
        function flush() { if (head) { printf "@@ -%d,%d +%d,%d @@\n%s", 1, old, 1, new, body >out }
                           head = 0; old = new = 0; body = "" }
        /^--- / || /^\+\+\+ / { flush(); print >out; next }
        /^@@/ { flush(); head = 1; next }
        { body = body $0 "\n"; c = substr($0, 1, 1); if (c != "+") old++; if (c != "-") new++ }
        END { flush() }' "$1"
    patch -p1 -F0 --no-backup-if-mismatch <"$1.whole" >"$work/patch.log" 2>&1 ||
        fail "a diff does not apply: $(cat "$work/patch.log")"
}

run() {
    sh -eu "$1" >"$work/output" 2>&1 </dev/null || fail "these commands failed:
$(cat "$1")
$(tail -n 40 "$work/output")"
}

compare() {
    while IFS= read -r line; do
        grep -qxF -e "$line" "$work/output" || fail "the commands do not print: $line
but: $(tail -n 40 "$work/output")"
    done <"$1"
}

done_blocks=0
compared=0
: >"$work/output"
for block in "$blocks"/*; do
    case $block in
    *.path) continue ;;
    *.c) write_file "$block" ;;
    *.diff) apply_diff "$block" ;;
    *.sh) run "$block" ;;
    *.text) compare "$block" && compared=$((compared + 1)) ;;
    *.whole) continue ;;
    *) fail "a block of an unknown kind: ${block##*/}" ;;
    esac
    done_blocks=$((done_blocks + 1))
done
[ "$compared" -gt 0 ] || fail "the page has no output to compare"
echo "$page: $done_blocks blocks, $compared compared"
