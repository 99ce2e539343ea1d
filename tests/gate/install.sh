#!/bin/sh
# Gate: the installation is complete and works. Programs run with their modules; manuals and data exist; every installed header compiles
# alone; a program builds with the flags of pkg-config and runs.
# usage: install.sh BUILD CC
set -eu
build=$1
cc=$2
here=$(cd "$(dirname "$0")" && pwd)

root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
DESTDIR=$root cmake --install "$build" >"$root/log" || {
    cat "$root/log" >&2
    exit 1
}
prefix=$root$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$build/CMakeCache.txt")

for file in bin/isothermd bin/isotherm bin/isotherm-sim share/isotherm/head.model \
    share/isotherm/cohort.templates share/isotherm/face.metric share/isotherm/judge/visitor/recording.ini share/man/man1/isotherm.1 share/man/man1/isotherm-sim.1 \
    share/man/man5/isotherm.conf.5 share/man/man8/isothermd.8 include/isotherm/isotherm.h; do
    [ -s "$prefix/$file" ] || {
        echo "not installed: $file" >&2
        exit 1
    }
done

for program in isothermd isotherm isotherm-sim; do
    "$prefix/bin/$program" --version
done

# Modules are installed next to the library, and the installed program uses these and not the modules of the build.
for built in "$build"/core/isotherm/isotherm-*.so; do
    [ -e "$built" ] || continue
    module=$(find "$prefix" -path "*/isotherm/${built##*/}")
    [ -s "$module" ] || {
        echo "not installed: ${built##*/}" >&2
        exit 1
    }
    case ${built##*/} in
    isotherm-vision.so)
        "$prefix/bin/isothermd" --version | grep -q '^image check: OpenCV '
        mv "$module" "$module.away"
        "$prefix/bin/isothermd" --version | grep -q '^image check: not installed$'
        mv "$module.away" "$module"
        ;;
    esac
done

pc=$(find "$prefix" -name isotherm.pc)
export PKG_CONFIG_SYSROOT_DIR="$root" PKG_CONFIG_LIBDIR="${pc%/*}"
cflags=$(pkg-config --cflags isotherm)
libs=$(pkg-config --libs isotherm)

# No header comes along that is not public, and the public ones need no other.
installed=$(cd "$prefix/include" && find . -name '*.h' | wc -l)
public=$(find "$here/../../core/include" -name '*.h' | wc -l)
[ "$installed" -eq "$public" ] || {
    echo "$installed headers are installed, $public are public" >&2
    exit 1
}

cd "$root"
for header in $(find "$prefix/include/isotherm" -name '*.h'); do
    printf '#include "%s"\n' "$header" | $cc -std=c17 $cflags -Wall -Wextra -Werror -fsyntax-only -x c -
done
$cc -std=c17 $cflags -Wall -Wextra -Werror "$here/user.c" -o user $libs -Wl,-rpath,"$prefix/lib"
./user

# The examples are built by what is installed, by the commands of their READMEs. Other libraries are this machine's.
cd "$prefix/share/doc/libisotherm-dev/examples"
for folder in . bus; do
    sed -n 's/^    \(cc -O2 .*\)/\1/p' "$folder/README.md" >"$root/commands"
    [ -s "$root/commands" ]
    sed "s#^cc #$cc -Wall -Wextra -Werror -Wl,-rpath,$prefix/lib #" "$root/commands" |
        (cd "$folder" && PKG_CONFIG_PATH="$PKG_CONFIG_LIBDIR" env -u PKG_CONFIG_LIBDIR sh -eu)
done
[ -x identify ] && [ -x bus/watch_door ]
./heat_on_mesh sphere.off 0 400 40 >/dev/null

# The Python module finds the installed library.
module=$(find "$prefix" -path '*/dist-packages/isotherm/__init__.py')
[ -s "$module" ] || {
    echo 'not installed: the Python module isotherm' >&2
    exit 1
}
if /usr/bin/python3 -c 'import numpy' 2>/dev/null; then
    LD_LIBRARY_PATH="$prefix/lib" PYTHONPATH="${module%/isotherm/*}" /usr/bin/python3 -B -c "
import isotherm
assert isotherm.__file__.startswith('$prefix')
print(isotherm.Shape(isotherm.Mesh.load('sphere.off'), pairs=10))"
fi
