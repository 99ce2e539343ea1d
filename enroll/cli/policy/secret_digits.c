#include "enroll/cli/policy/secret_digits.h"

#include <errno.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

enum { SHORTEST = 4 };

/* Reads a line byte by byte, so that no buffer keeps a copy. Returns false unless it is a PIN. */
static bool read_pin(char pin[CLI_PIN_SIZE])
{
    size_t n = 0;
    bool sound = true;
    char c = '\0';
    ssize_t got;

    memset(pin, 0, CLI_PIN_SIZE);
    while ((got = read(STDIN_FILENO, &c, 1)) != 0 && c != '\n') {
        if (got < 0 && errno != EINTR) {
            return false;
        }
        if (got < 0) {
            continue;
        }
        sound = sound && c >= '0' && c <= '9' && n < CLI_PIN_SIZE - 1;
        if (sound) {
            pin[n++] = c;
        }
    }
    return sound && n >= SHORTEST;
}

static enum cli_exit ask_once(const char *what, const char *again, char pin[CLI_PIN_SIZE],
                              struct cli_fault *fault)
{
    struct termios before, silent;
    const bool terminal = tcgetattr(STDIN_FILENO, &before) == 0;

    if (terminal) {
        /* The question comes last: what is typed before it is thrown away. */
        silent = before;
        silent.c_lflag &= ~(tcflag_t)ECHO;
        (void)tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
        fprintf(stderr, "%s%s: ", what, again);
    }
    const bool sound = read_pin(pin);
    if (terminal) {
        (void)tcsetattr(STDIN_FILENO, TCSADRAIN, &before);
        fputc('\n', stderr);
    }
    return sound ? CLI_EXIT_OK
                 : cli_fault_set(fault, CLI_EXIT_USAGE, "pin", "a PIN has 4 to 9 digits");
}

enum cli_exit cli_pin_ask(const char *what, char pin[CLI_PIN_SIZE], struct cli_fault *fault)
{
    char again[CLI_PIN_SIZE] = "";

    enum cli_exit exit = ask_once(what, "", pin, fault);
    if (!exit && isatty(STDIN_FILENO)) {
        exit = ask_once(what, " once more", again, fault);
        if (!exit && strcmp(pin, again) != 0) {
            exit = cli_fault_set(fault, CLI_EXIT_USAGE, "pin", "the two PINs differ");
        }
        explicit_bzero(again, sizeof again);
    }
    return exit;
}
