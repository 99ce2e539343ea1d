#!/bin/sh
# Checks that every word of the pages has a translation in every language, that its places ({name}) are the same there, and that no
# catalogue has words that are gone.
# The pages of the hub share files with those of the door, and have catalogues of their own for the words that only they have.
# usage: catalogues.sh SOURCE_DIR [hub]
set -eu

web=$1/enroll/${2:-web}
scratch=$(mktemp -d)
trap 'rm -r "$scratch"' EXIT

sources=$(find "$web/pages/js" -name '*.js' | sort)
least=300
[ $# -eq 1 ] || least=100
# shellcheck disable=SC2086 # a list of files
xgettext --language=JavaScript --from-code=UTF-8 -k -k_ -k_f -kN_ --no-wrap -o "$scratch/words.pot" $sources
wanted=$(grep -c '^msgid "[^"]' "$scratch/words.pot")
[ "$wanted" -gt "$least" ] || { echo "only $wanted words were found in $web"; exit 1; }
failed=0

# xgettext may lose its way in the middle of a file, for instance in a template with quotation marks. Every text that a simple pattern finds
# has to be among the words.
# shellcheck disable=SC2086
sed -n "s/.*[^A-Za-z0-9_.]\(_\|_f\|N_\)('\([^'\\\\]*\)'.*/\2/p" $sources | sed 's/"/\\"/g' | sort -u >"$scratch/seen"
sed -n 's/^msgid "\(.*\)"$/\1/p' "$scratch/words.pot" | sort -u >"$scratch/found"
lost=$(comm -23 "$scratch/seen" "$scratch/found")
[ -z "$lost" ] || { echo "xgettext does not find these words: $lost"; failed=1; }

# places FILE: prints the places of each word and of its translation, side by side
places() {
    msgcat --no-wrap "$1" | awk '
        function places_of(text,   out, n, list) {
            n = 0
            while (match(text, /\{[a-z_]+\}/)) {
                list[++n] = substr(text, RSTART, RLENGTH)
                text = substr(text, RSTART + RLENGTH)
            }
            for (i = 1; i <= n; i++) for (j = i + 1; j <= n; j++) if (list[j] < list[i]) { t = list[i]; list[i] = list[j]; list[j] = t }
            out = ""
            for (i = 1; i <= n; i++) out = out list[i]
            return out
        }
        /^msgid / { word = $0; from = places_of($0) }
        /^msgstr / { if (places_of($0) != from) print word }'
}

# The words that the pages of the door have, too.
if [ $# -gt 1 ]; then
    # shellcheck disable=SC2046 # a list of files
    xgettext --language=JavaScript --from-code=UTF-8 -k -k_ -k_f -kN_ --no-wrap -o "$scratch/shared.pot" \
        $(find "$1/enroll/web/pages/js" -name '*.js')
    msgcomm --no-wrap --unique -o "$scratch/own.pot" "$scratch/words.pot" "$scratch/shared.pot"
    msgcomm --no-wrap --more-than=1 -o "$scratch/words.pot" "$scratch/own.pot" "$scratch/words.pot"
fi

for language in de fr es ar zh_CN; do
    catalogue=$web/po/$language.po
    # msgcmp fails if a word is missing, not translated or only guessed ("fuzzy").
    msgcmp "$catalogue" "$scratch/words.pot" >"$scratch/said" 2>&1 || { cat "$scratch/said"; failed=1; }
    if grep -v "$language.po:[12]:" "$scratch/said" | grep 'not used'; then
        echo "$catalogue has words that the pages do not use"
        failed=1
    fi
    wrong=$(places "$catalogue")
    [ -z "$wrong" ] || { echo "$catalogue: other places in the translation of $wrong"; failed=1; }
    msgfmt -o /dev/null "$catalogue" || failed=1
done
exit $failed
