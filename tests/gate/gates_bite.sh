#!/bin/sh
# Tests the gates that read texts: each of them refuses the mistakes that it must find.
# usage: gates_bite.sh [ROOT [CC]]
set -eu
root=$(cd "${1:-$(dirname "$0")/../..}" && pwd)
cc=${2:-cc}
copy=$(mktemp -d)
trap 'rm -rf "$copy"' EXIT

# A small tree that passes.
fresh_tree() {
    rm -rf "${copy:?}"/*
    for folder in core drivers firmware enroll sim tests cmake board; do
        mkdir -p "$copy/$folder"
        echo 'What lives here.' >"$copy/$folder/README.md"
    done
    mkdir -p "$copy/core/base" "$copy/core/heat" "$copy/tests/gate"
    cp "$root/cmake/layers.txt" "$copy/cmake/"
    cp "$root/tests/gate/long_files.txt" "$root/tests/gate/long_functions.txt" "$root/tests/gate/words.txt" "$copy/tests/gate/"
    echo 'sim/writer.c 1 an output' >"$copy/tests/gate/open_files.txt"
    echo 'sim/reader.c 1 what a person has typed' >"$copy/tests/gate/strstr.txt"
    printf 'char *a(char *t) { return strstr(t, "a"); }\n' >"$copy/sim/reader.c"
    printf 'void a(void) { fopen("a", "we"); }\n' >"$copy/sim/writer.c"
    cp "$root/.clang-format" "$copy/"
    printf '#include "core/base/a.h"\n' >"$copy/core/heat/a.c"
    printf 'int a(void);\n' >"$copy/core/base/a.h"
}

passes() {
    "$@" >/dev/null 2>&1 || {
        echo "refuses a sound tree: $*" >&2
        exit 1
    }
}

refuses() {
    ! "$@" >/dev/null 2>&1 || {
        echo "accepts: $what" >&2
        exit 1
    }
}

fresh_tree
passes "$root/cmake/check_layers.sh" "$copy"
passes "$root/tests/gate/rooms.sh" "$copy"
passes "$root/tests/gate/docs.sh" "$copy"
passes "$root/tests/gate/open_files.sh" "$copy"
passes "$root/tests/gate/strstr.sh" "$copy"
passes "$root/tests/gate/threads.sh" "$copy"
passes "$root/tests/gate/words.sh" "$copy"

what='a file that is opened without the helper'
printf 'int a(void) { return open("a", 0); }\n' >"$copy/firmware/b.c"
refuses "$root/tests/gate/open_files.sh" "$copy"

fresh_tree
what='a second call in a source with one listed call'
printf 'void b(void) { fopen("b", "re"); }\n' >>"$copy/sim/writer.c"
refuses "$root/tests/gate/open_files.sh" "$copy"

fresh_tree
what='a program that searches a sentence for words'
printf 'int b(char *t) { return strstr(t, "denied") != 0; }\n' >"$copy/enroll/b.c"
refuses "$root/tests/gate/strstr.sh" "$copy"

fresh_tree
what='a second search in a source with one listed search'
printf 'int b(char *t) { return strcasestr(t, "denied") != 0; }\n' >>"$copy/sim/reader.c"
refuses "$root/tests/gate/strstr.sh" "$copy"

fresh_tree
what='a listed search that does not exist'
printf 'int b(void);\n' >"$copy/sim/reader.c"
refuses "$root/tests/gate/strstr.sh" "$copy"

fresh_tree
what='a thread with a stack of any size'
printf 'void b(void) { pthread_create(0, 0, 0, 0); }\n' >"$copy/firmware/b.c"
refuses "$root/tests/gate/threads.sh" "$copy"

# invents FILE TEXT: the text has a word of words.txt.
invents() {
    fresh_tree
    what="$1: $2"
    mkdir -p "$copy/$(dirname "$1")"
    printf '%s\n' "$2" >"$copy/$1"
    refuses "$root/tests/gate/words.sh" "$copy"
}

invents core/base/b.h 'struct iso_crew;'
invents firmware/b.c '/* The keepers of the sensors. */'
invents core/README.md 'A second look at the ten best.'
invents README.md 'Second-look scores are reported.'
invents tests/b.sh '# cli_door_open'
invents board/generic/b.service '# A call that is refused unlooked at.'

# The history may keep them, and a word that only contains one of them is another word.
fresh_tree
mkdir -p "$copy/sim/results"
echo 'The crew had a second look.' | tee "$copy/CHANGELOG.md" >"$copy/sim/results/threads.md"
echo 'int bookkeeper; /* It was screwed on. */' >"$copy/core/base/b.h"
passes "$root/tests/gate/words.sh" "$copy"

fresh_tree
what='a lower layer that includes a higher one'
printf '#include "drivers/a.h"\n' >"$copy/core/base/b.c"
refuses "$root/cmake/check_layers.sh" "$copy"

fresh_tree
what='an include against the flow of the data'
printf '#  include "core/heat/a.h"\n' >"$copy/core/base/b.c"
refuses "$root/cmake/check_layers.sh" "$copy"

# includes FILE HEADER: a file includes a header that layers.txt does not permit.
includes() {
    fresh_tree
    what="$1 includes $2"
    mkdir -p "$copy/$(dirname "$1")"
    printf '#include "%s"\n' "$2" >"$copy/$1"
    refuses "$root/cmake/check_layers.sh" "$copy"
}

includes core/surface/b.c core/extract/a.h
includes core/surface/b.c isotherm/extract.h
includes core/include/isotherm/mesh.h isotherm/extract.h
includes core/include/isotherm/extract.h core/base/a.h
includes core/extract/b.c isotherm/nowhere.h
includes core/examples/b.c core/frame/a.h
includes enroll/examples/b.c firmware/contract/a.h
includes drivers/file/b.c drivers/recording/a.h
includes drivers/sensor/replay/b.c drivers/sensor/openni2/a.h
includes firmware/gallery/b.c firmware/visit/a.h
includes firmware/keys/b.c firmware/audit/a.h
includes enroll/cli/text/b.c firmware/gallery/a.h
includes enroll/cli/setup/b.c enroll/cli/commands/a.h
includes sim/world/prop/b.c sim/world/scene/a.h
includes sim/lab/match/b.c sim/lab/eval/a.h
includes tests/support/b.c board/a.h

fresh_tree
what='a folder of 26 files'
for n in $(seq 26); do
    echo 'int b;' >"$copy/firmware/b$n.c"
done
refuses "$root/tests/gate/rooms.sh" "$copy"

fresh_tree
what='a room of more than a fifth of the product'
yes '/* */' | head -1200 >"$copy/core/heat/b.c"
refuses "$root/tests/gate/rooms.sh" "$copy"

fresh_tree
what='two headers that include each other'
printf '#include "core/base/b.h"\n' >"$copy/core/base/a.h"
printf '#include "core/base/a.h"\n' >"$copy/core/base/b.h"
refuses "$root/tests/gate/rooms.sh" "$copy"

fresh_tree
what='two rooms that include each other'
printf '#include "tests/b/b.h"\n' >"$copy/tests/a.c"
mkdir "$copy/tests/b"
printf '#include "tests/a.h"\n' >"$copy/tests/b/b.c"
refuses "$root/tests/gate/rooms.sh" "$copy"

fresh_tree
what='an include that is not written from the root'
printf '#include "a.h"\n' >"$copy/core/base/b.c"
refuses "$root/cmake/check_layers.sh" "$copy"

fresh_tree
mkdir -p "$copy/core/examples"
printf '#include <isotherm/a.h>\n#include "b.h"\n' >"$copy/core/examples/b.c"
passes "$root/cmake/check_layers.sh" "$copy"

fresh_tree
what='a clock in core'
printf '#include <time.h>\n' >"$copy/core/base/b.c"
refuses "$root/cmake/check_layers.sh" "$copy"

fresh_tree
what='a folder without README'
rm "$copy/board/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"

fresh_tree
what='a link to nowhere'
echo 'See [there](nowhere.md).' >"$copy/core/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"
printf '# Two `words`\n\nSee [there](../core/README.md#two-words).\n' >"$copy/core/README.md"
passes "$root/tests/gate/docs.sh" "$copy"
what='a link to a heading that is not there'
echo 'See [there](../core/README.md#three-words).' >"$copy/tests/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"

# A document may name paths from the root, from its own folder, by a star, or by a name that stands for any.
fresh_tree
printf '%s\n' '`core/base/a.h`, `base/a.h`, `a.h`, `core/*/a.c`, `cmd_NAME.c`, `build/b.c`, `/etc/c.c`' >"$copy/core/README.md"
passes "$root/tests/gate/docs.sh" "$copy"
what='a path in backticks that is not there'
echo 'See `base/b.h`.' >"$copy/core/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"
echo 'See `b.h`.' >"$copy/core/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"
# A guide may have the full text of new files.
printf 'See `core/new/b.h` in `core/new`.\n\n```c core/new/b.h\nint b(void);\n```\n' >"$copy/core/README.md"
passes "$root/tests/gate/docs.sh" "$copy"
printf 'See `core/new/c.h`.\n\n```c core/new/b.h\nint b(void);\n```\n' >"$copy/core/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"
what='a path in the text or in a command that is not there'
echo 'It lives in core/nowhere.' >"$copy/tests/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"
echo '    cat core/base/b.h' >"$copy/tests/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"

fresh_tree
printf '| `strict` | 1 2 3 |\n    run 1 2 3\n' >"$copy/README.md"
seq -s ' ' 40 >>"$copy/README.md"
passes "$root/tests/gate/docs.sh" "$copy"
what='a README with 41 numbers'
echo 'And 41.' >>"$copy/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"
what='a README of 169 lines'
yes 'A line.' | head -169 >"$copy/README.md"
refuses "$root/tests/gate/docs.sh" "$copy"

# A library and its public headers.
library() {
    fresh_tree
    mkdir -p "$copy/core/include/isotherm" "$copy/board/debian"
    printf '%s\n' 'struct iso_b { int (*c)(int); };' 'static inline int iso_c(int c) { return c; }' 'int iso_a(int);' \
        'extern const int iso_d[2];' >"$copy/core/include/isotherm/a.h"
    printf 'libisotherm.so.0 libisotherm0 #MINVER#\n iso_a@Base 0.1.0\n iso_d@Base 0.1.0\n' >"$copy/board/debian/libisotherm0.symbols"
    $cc -shared -fPIC -x c - -o "$copy/lib.so" <<END
int iso_a(int a) { return a; }
const int iso_d[2] = {1, 2};
$1
END
}

library ''
passes "$root/tests/gate/exports.sh" "$copy/lib.so" "$cc" "$copy"
what='a library that exports what no public header declares'
library 'int iso_e(int a) { return a; }'
refuses "$root/tests/gate/exports.sh" "$copy/lib.so" "$cc" "$copy"
what='a library that lacks what a public header declares'
library ''
echo 'int iso_e(int);' >>"$copy/core/include/isotherm/a.h"
echo ' iso_e@Base 0.1.0' >>"$copy/board/debian/libisotherm0.symbols"
refuses "$root/tests/gate/exports.sh" "$copy/lib.so" "$cc" "$copy"
what='a symbols file that lacks what the library exports'
library ''
sed -i '/iso_a/d' "$copy/board/debian/libisotherm0.symbols"
refuses "$root/tests/gate/exports.sh" "$copy/lib.so" "$cc" "$copy"

# The reference of the library.
if command -v doxygen >/dev/null; then
    library ''
    cp "$root/core/Doxyfile" "$copy/core/"
    echo 'project(isotherm VERSION 1.0' >"$copy/CMakeLists.txt"
    printf '/** @file\n * Text. */\n/** Text.\n *\n * @param a  Text.\n * @return Text. */\nint iso_a(int a);\n' >"$copy/core/include/isotherm/a.h"
    passes "$root/cmake/docs.sh" "$copy/out" "$copy"
    what='a public function whose parameter is not described'
    sed -i '/@param/d' "$copy/core/include/isotherm/a.h"
    refuses "$root/cmake/docs.sh" "$copy/out" "$copy"
    what='a public function that is not described'
    printf '/** @file\n * Text. */\nint iso_a(int a);\n' >"$copy/core/include/isotherm/a.h"
    refuses "$root/cmake/docs.sh" "$copy/out" "$copy"
fi

# A diagram and its source.
diagram() {
    fresh_tree
    printf 'digraph g {\n a [label="one\\ncore/base"]\n b [label="two"]\n a -> b\n}\n' >"$copy/sim/g.dot"
    printf '<title>a&#45;&gt;b</title>\n<text x="1">one</text>\n<text>core/base</text>\n<text>two</text>\n' >"$copy/sim/g.svg"
}

diagram
passes "$root/tests/gate/pictures.sh" "$copy"
what='a diagram that lacks a text of its source'
sed -i '/two/d' "$copy/sim/g.svg"
refuses "$root/tests/gate/pictures.sh" "$copy"
diagram
what='a diagram whose arrow points the other way'
sed -i 's/a&#45;&gt;b/b\&#45;\&gt;a/' "$copy/sim/g.svg"
refuses "$root/tests/gate/pictures.sh" "$copy"
diagram
what='a diagram that is not drawn'
rm "$copy/sim/g.svg"
refuses "$root/tests/gate/pictures.sh" "$copy"
diagram
what='a label that names a path that is not there'
sed -i 's|core/base|core/nowhere|' "$copy/sim/g.dot" "$copy/sim/g.svg"
refuses "$root/tests/gate/pictures.sh" "$copy"

fresh_tree
yes '/* */' | head -400 >"$copy/core/base/b.c"
passes "$root/tests/gate/docs.sh" "$copy"
what='a file of 401 lines'
echo '/* */' >>"$copy/core/base/b.c"
refuses "$root/tests/gate/docs.sh" "$copy"

# long_function LINES: a function whose closing brace is so many lines after its opening brace
long_function() {
    fresh_tree
    printf 'void b(void)\n{\n' >"$copy/tests/b.c"
    yes '    a();' | head -$(($1 - 1)) >>"$copy/tests/b.c"
    echo '}' >>"$copy/tests/b.c"
}

long_function 50
passes "$root/tests/gate/docs.sh" "$copy"
what='a function of 51 lines'
long_function 51
refuses "$root/tests/gate/docs.sh" "$copy"

# A SECURITY.md, and the list of tests with which it is compared.
claims() {
    fresh_tree
    what=$1
    printf '%s\n' "$2" >"$copy/SECURITY.md"
    printf 'test_one\ntest_two\n' >"$copy/list"
    printf '#!/bin/sh\n' >"$copy/tests/two.sh"
    chmod +x "$copy/tests/two.sh"
}

claims 'sound claims' 'A door is locked (tested: `test_one`,
`test_two`). A key is kept (`firmware/keys/seal.h`; tested: `tests/two.sh`).'
passes "$root/tests/gate/security.sh" "$copy" "$copy/list"
claims 'a claim that names no test' 'A door is locked (tested).'
refuses "$root/tests/gate/security.sh" "$copy" "$copy/list"
claims 'a claim beside one that names a test' 'One (tested: `test_one`). Two (tested). Three (tested: `test_two`).'
refuses "$root/tests/gate/security.sh" "$copy" "$copy/list"
claims 'a test that does not exist' 'A door is locked (tested: `test_one`, `test_none`).'
refuses "$root/tests/gate/security.sh" "$copy" "$copy/list"
claims 'part of the name of a test' 'A door is locked (tested: `test_on`).'
refuses "$root/tests/gate/security.sh" "$copy" "$copy/list"
claims 'a script that does not exist' 'A door is locked (tested: `tests/none.sh`).'
refuses "$root/tests/gate/security.sh" "$copy" "$copy/list"

# The mistakes of drill_bites.sh, here one of them.
mistake() {
    fresh_tree
    what=$1
    mkdir -p "$copy/core/presentation" "$copy/tests/firmware/faults" "$copy/build/CMakeFiles"
    cp "$root/core/presentation/frame_memory.h" "$copy/core/presentation/"
    cp "$root/tests/firmware/faults/drill_bites.sh" "$copy/tests/firmware/faults/"
    echo /build/tests/core/CMakeFiles/test_presentation_frame_memory.dir >"$copy/build/CMakeFiles/TargetDirectories.txt"
}

look_for_mistake() {
    "$copy/tests/firmware/faults/drill_bites.sh" "$copy/build" --patterns 'some pixels make a frame new'
}

mistake 'a sound one'
passes look_for_mistake
mistake 'a mistake whose text is gone'
sed -i 's/ISO_FINGERPRINT_SAME/ISO_FINGERPRINT_EQUAL/' "$copy/core/presentation/frame_memory.h"
refuses look_for_mistake
mistake 'a mistake whose text is there twice'
grep 'define ISO_FINGERPRINT_SAME' "$root/core/presentation/frame_memory.h" >>"$copy/core/presentation/frame_memory.h"
refuses look_for_mistake
mistake 'a mistake that a program finds which does not exist'
echo /build/tests/core/CMakeFiles/test_frame_memory.dir >"$copy/build/CMakeFiles/TargetDirectories.txt"
refuses look_for_mistake
mistake 'a mistake in a file that is gone'
rm "$copy/core/presentation/frame_memory.h"
refuses look_for_mistake
