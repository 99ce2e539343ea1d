# Counts the instructions between the calls of a function, from qemu's log (-d in_asm,exec,nochain). The log lists a block of instructions
# when it is translated ("IN:", one line for each instruction), right before the first line that says that the block runs ("Trace", with
# the address of the block, which identifies it until another block is at this address).
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
# A long instruction continues on a second line, which has only bytes.
/^0x/ {
    for (i = 2; i <= NF && $i ~ /^[0-9a-f][0-9a-f]$/; i++) {
    }
    listed += i <= NF
    next
}
# The message of the program, if it fails.
/^one_frame: / { print >"/dev/stderr" }
