# shellcheck shell=sh
# Prints verdicts of scripts. They are in colour if standard output is a terminal with colours and NO_COLOR is unset or empty
# (https://no-color.org); otherwise they are plain text. To be sourced.

# paint good|warning|bad TEXT: the text without a line end
paint() {
    if [ -t 1 ] && [ -z "${NO_COLOR:-}" ] && [ -n "${TERM:-}" ] && [ "$TERM" != dumb ]; then
        case $1 in
        good) printf '\033[32m%s\033[0m' "$2" ;;
        warning) printf '\033[33m%s\033[0m' "$2" ;;
        *) printf '\033[31m%s\033[0m' "$2" ;;
        esac
    else
        printf '%s' "$2"
    fi
}

# count good|warning|bad NUMBER WORD
count() {
    if [ "$2" -eq 0 ]; then
        printf '%s %s' "$2" "$3"
    else
        paint "$1" "$2 $3"
    fi
}

# say_tally PASSED FAILED SKIPPED: prints "3 passed, 0 failed, 1 skipped"; a zero has no colour
say_tally() {
    count good "$1" passed
    printf ', '
    count bad "$2" failed
    printf ', '
    count warning "$3" skipped
    printf '\n'
}
