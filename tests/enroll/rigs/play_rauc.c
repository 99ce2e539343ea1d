/* The stand-in for RAUC as a program, for tests that are scripts:
 *
 *   play_rauc ADDRESS [--installed] [--foreign-key] [--error TEXT] [--hold FILE]
 *
 * The options are the members of fake_rauc_script. It prints "r" once it is on the bus, and what it
 * is asked on standard error. */
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "tests/enroll/rigs/fake_rauc.h"

int main(int argc, char **argv)
{
    struct fake_rauc_script script = {.board = NULL};
    bool wrong = argc < 2;

    for (int i = 2; i < argc; i++) {
        const char **text = strcmp(argv[i], "--error") == 0  ? &script.error
                            : strcmp(argv[i], "--hold") == 0 ? &script.hold
                                                             : NULL;
        if (text) {
            *text = argv[++i];
            wrong = wrong || !*text;
        } else if (strcmp(argv[i], "--installed") == 0) {
            script.installed = true;
        } else if (strcmp(argv[i], "--foreign-key") == 0) {
            script.foreign_key = true;
        } else {
            wrong = true;
        }
    }
    if (wrong) {
        fputs(
            "usage: play_rauc ADDRESS [--installed] [--foreign-key] [--error TEXT] [--hold FILE]\n",
            stderr);
        return 2;
    }
    return fake_rauc_serve(argv[1], &script, STDOUT_FILENO) < 0;
}
