# Counts instructions between the calls of a function, from qemu's log (-d in_asm,exec,nochain): a block of instructions is
# listed when it is translated ("IN:", one line each), right before the first of the lines that say that it runs
# ("Trace", with the block's place in memory, which is its name until another is put there).
#
#   awk -v mark=FUNCTION -f instructions.awk <LOG       prints a number for each pair of successive calls

/^Trace / {
    if (listed) {
        length_of[$3] = listed
        listed = 0
    }
    if ($5 == mark) {
        if (marks++) {
            print count
        }
        count = 0
    }
    if (marks) {
        count += length_of[$3]
    }
    next
}
/^IN:/ { listed = 0 }
# Those that are too long for a line go on in a second one, of bytes alone.
/^0x/ {
    for (i = 2; i <= NF && $i ~ /^[0-9a-f][0-9a-f]$/; i++) {
    }
    listed += i <= NF
    next
}
# The program's own word, if it fails.
/^one_frame: / { print >"/dev/stderr" }
