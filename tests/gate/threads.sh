#!/bin/sh
# Gate: all threads are started through drivers/process/thread.h, which gives them a stack of a stated size and blocks their signals.
# usage: threads.sh [ROOT]
set -eu
cd "${1:-$(dirname "$0")/../..}"
found=$(grep -rnE '\<(pthread_create|thrd_create)[ ]*\(|std::j?thread\>' core drivers firmware enroll sim --include='*.[ch]' \
    --include='*.cc' --include='*.cpp' | grep -v '^drivers/process/thread\.c:' || true)
[ -z "$found" ] || {
    echo "Threads that are started without drivers/process/thread.h:" >&2
    echo "$found" >&2
    exit 1
}
