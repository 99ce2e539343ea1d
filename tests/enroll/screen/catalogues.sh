#!/bin/sh
# Checks that every word of the screen has a translation in every language, and that no catalogue has words that are gone.
# usage: catalogues.sh SOURCE_DIR
set -eu

screen=$1/enroll/screen
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT

find "$screen" -name '*.c' | sort | xargs xgettext --from-code=UTF-8 -kN_ -o "$scratch/words.pot"
wanted=$(grep -c '^msgid' "$scratch/words.pot")
[ "$wanted" -gt 40 ] || { echo "only $wanted words were found in $screen"; exit 1; }
failed=0
for language in de fr es ar zh_CN; do
    catalogue=$screen/po/$language.po
    # msgcmp fails if a word is missing, not translated or only guessed ("fuzzy").
    msgcmp "$catalogue" "$scratch/words.pot" >"$scratch/said" 2>&1 || { cat "$scratch/said"; failed=1; }
    if grep -v "$language.po:[12]:" "$scratch/said" | grep 'not used'; then
        echo "$catalogue has words that the screen does not use"
        failed=1
    fi
    msgfmt --check-format -o /dev/null "$catalogue" || failed=1
done
exit $failed
