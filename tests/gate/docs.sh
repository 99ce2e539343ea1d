#!/bin/sh
# Gate: the documents are true, and the files are short.
#   - every top-level folder has a README
#   - links between documents lead to a file that exists, and to a heading that exists if they name one
#   - every path that a document names exists
#   - the README of the project is short: at most 168 lines (five screens), and 40 numbers outside commands and the table of the levels
#   - a source has at most 400 lines, unless long_files.txt lists it
#   - a function has at most 50 lines, unless long_functions.txt lists its source; clang-tidy, which leaves out tests, counts the same
#   - the code has no TODO
# usage: docs.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
faults=0

fault() {
    echo "$*" >&2
    faults=$((faults + 1))
}

for folder in core drivers firmware enroll sim tests cmake board; do
    [ -s "$folder/README.md" ] || fault "$folder: has no README.md"
done

# headings DOCUMENT: prints the names of its headings in links: small letters, hyphens for spaces, no other signs
headings() {
    sed -n 's/^##* *//p' "$1" | tr '[:upper:] ' '[:lower:]-' | sed 's/[^a-z0-9_-]//g'
}

documents=$(find . \( -path ./build -o -path ./out \) -prune -o -name '*.md' -print)
for document in $documents; do
    for link in $(grep -o '](\([^)]*\))' "$document" | sed 's/^](//; s/)$//' | grep -v '^[a-z]*:' || true); do
        target=$(dirname "$document")/${link%%#*}
        [ -n "${link%%#*}" ] || target=$document
        [ -e "$target" ] || fault "$document: link to nowhere: $link"
        case $link in
        *'#'*) [ ! -e "$target" ] || headings "$target" | grep -qxF -e "${link#*#}" || fault "$document: no such heading: $link" ;;
        esac
    done
done

# The README of the project. Measurements belong into sim/results.
if [ -f README.md ]; then
    lines=$(wc -l <README.md)
    [ "$lines" -le 168 ] || fault "README.md: $lines lines, at most 168"
    # shellcheck disable=SC2016 # backticks of the document
    numbers=$(grep -vE '^    |^\| `(convenient|balanced|strict)` ' README.md | sed 's/](\([^)]*\))/]/g; s/`[^`]*`//g' |
        grep -oE '(^|[^A-Za-z0-9_./-])[0-9][0-9.,]*' | wc -l)
    [ "$numbers" -le 40 ] || fault "README.md: $numbers numbers, at most 40: measurements belong in sim/results"
fi

# named_paths DOCUMENT: prints the paths that it names, one a line: every word that begins with a top-level folder, and every word in
# backticks that has a slash or the ending of a source. It leaves out absolute paths, paths with a variable, and the output of a build
# (build/, out/) or a command. A word with capitals stands for any name (NAME.sh, BUILD/vm) and is no path.
named_paths() {
    {
        grep -oE '(^|[^A-Za-z0-9_./$-])(core|drivers|firmware|enroll|sim|tests|cmake|board)/[A-Za-z0-9_.*/-]+' "$1" |
            sed 's/^[^a-z]//'
        grep -v '^    ' "$1" | tr '\n' ' ' | grep -o '`[^`]*`' | tr -d '`' |
            grep -xE '[A-Za-z0-9_.*-]+/[A-Za-z0-9_.*/-]*|[A-Za-z0-9_*-]+\.(c|h|cc|sh|md|awk|cmake|dot|svg|inc)'
    } | sed 's/[.,:;]*$//' | grep -vE '^(build|out)/|[A-Z][A-Z]+' | sort -u
}

# exists DOCUMENT PATH: whether the path exists from the root or from the document's folder; a bare file name may be anywhere under the
# document's folder
exists() {
    folder=${1%/*}
    # A star stands for several files; it is enough if the first one exists.
    for file in "./"$2 "$folder/"$2; do
        [ ! -e "$file" ] || return 0
    done
    case $2 in
    */*) return 1 ;;
    *) find "$folder" -path ./build -prune -o -name "$2" -print | grep -q . ;;
    esac
}

# brings DOCUMENT PATH: whether the document has the text of the file, as a block of code with its path, or files of this folder. A test
# builds these files.
brings() {
    grep -qE "^\`\`\`[a-z]+ $2(/.*)?\$" "$1"
}

for document in $documents; do
    for path in $(named_paths "$document"); do
        exists "$document" "$path" || brings "$document" "$path" || fault "$document: names a path that does not exist: $path"
    done
done

sources=$(find core drivers firmware enroll sim tests -name '*.[ch]' -o -name '*.cc' | sort)
for source in $sources; do
    lines=$(wc -l <"$source")
    [ "$lines" -le 400 ] || grep -qxF -e "$source" tests/gate/long_files.txt ||
        fault "$source: $lines lines, at most 400"
done

# The layout puts the braces of a function, and of nothing else, alone into the first column.
long=$(printf '%s\n' "$sources" | grep -vxF -f tests/gate/long_functions.txt | xargs awk '
    FNR == 1 || /^}/ && !/^}$/ { begin = 0 }
    /^{$/ { begin = FNR }
    /^}$/ && begin { if (FNR - begin > 50) { printf "%s:%d: a function of %d lines, at most 50\n", FILENAME, begin, FNR - begin }; begin = 0 }')
[ -z "$long" ] || fault "$long"

open=$(grep -nE '\<(TODO|FIXME|XXX)\>|not implemented' $sources || true)
[ -z "$open" ] || fault "left open:
$open"

[ "$faults" -eq 0 ]
