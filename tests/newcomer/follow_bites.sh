#!/bin/sh
# Tests that follow.sh fails for a page that is not true, and passes for a page that is true.
set -eu
follow=$(cd "$(dirname "$0")" && pwd)/follow.sh
work=$(mktemp -d "${TMPDIR:-/tmp}/isotherm-test-XXXXXX")
trap 'rm -rf "$work"' EXIT
mkdir "$work/root"
printf 'one\ntwo\nthree\n' >"$work/root/list"
faults=0

# expect 0|1 NAME: expects this exit code of follow.sh for the page on standard input
expect() {
    cat >"$work/root/page.md"
    ended=0
    "$follow" "$work/root" "$work/copy" page.md >"$work/said" 2>&1 || ended=1
    if [ "$ended" -ne "$1" ]; then
        echo "$2: ended with $ended: $(cat "$work/said")" >&2
        faults=$((faults + 1))
    fi
}

# page [DIFF_LINE [OUTPUT_LINE [COMMAND]]]
page() {
    cat <<END
\`\`\`c new/file.c
int x;
\`\`\`

\`\`\`diff
--- a/list
+++ b/list
@@ -1,2 +1,3 @@
 one
+$1
 two
\`\`\`

\`\`\`sh
$3
cat list new/file.c
\`\`\`

\`\`\`text
$2
int x;
\`\`\`
END
}

page half half true | expect 0 "a true page"
page half half true | expect 0 "a true page again"
page half other true | expect 1 "a page whose output is another"
page half 'h.lf' true | expect 1 "a page whose output only matches as a pattern"
page half half false | expect 1 "a page with a command that fails"
page half half true | sed 's/^ two/ four/' | expect 1 "a page with a diff that does not fit"
page half half true | sed 's,new/file.c$,list,' | expect 1 "a page with a new file that exists already"
page half half true | sed '/^```text/,$d' | expect 1 "a page of which nothing is compared"
page half half true | sed '$d' | expect 1 "a page with a block that has no end"
page half half true | sed 's/^```sh/```python/' | expect 1 "a page with a block of an unknown kind"
[ "$(cat "$work/root/list")" = "one
two
three" ] || {
    echo "the tree itself was changed" >&2
    faults=$((faults + 1))
}
[ "$faults" -eq 0 ]
