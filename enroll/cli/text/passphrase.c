#include "enroll/cli/text/passphrase.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>
#include <termios.h>
#include <unistd.h>

#include "drivers/terminal/progress.h"
#include "firmware/contract/contract.h"

enum { LONGEST = 1024, SHORTEST_FRESH = 12 };

static enum cli_exit read_line(FILE *in, char line[LONGEST], struct cli_fault *fault)
{
    if (!fgets(line, LONGEST, in) || line[0] == '\n') {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "passphrase", "there is no passphrase");
    }
    const size_t length = strcspn(line, "\n");
    if (length == LONGEST - 1) {
        return cli_fault_set(fault, CLI_EXIT_USAGE, "passphrase", "the passphrase is too long");
    }
    line[length] = '\0';
    return CLI_EXIT_OK;
}

static enum cli_exit read_file(const char *file, char line[LONGEST], struct cli_fault *fault)
{
    FILE *in = fopen(file, "re");
    if (!in) {
        return cli_fault_set(fault, errno == ENOENT ? CLI_EXIT_NOT_FOUND : CLI_EXIT_FAULT,
                             "passphrase", "%s: %s", file, strerror(errno));
    }
    setvbuf(in, NULL, _IONBF, 0); /* a buffer would keep a copy of the passphrase */
    const enum cli_exit exit = read_line(in, line, fault);
    (void)fclose(in);
    return exit;
}

static enum cli_exit ask_once(const char *prompt, char line[LONGEST], struct cli_fault *fault)
{
    struct termios before, silent;
    const bool terminal = tcgetattr(STDIN_FILENO, &before) == 0;
    if (terminal) {
        fputs(prompt, stderr);
        silent = before;
        silent.c_lflag &= ~(tcflag_t)ECHO;
        (void)tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
    }
    const enum cli_exit exit = read_line(stdin, line, fault);
    if (terminal) {
        (void)tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
        fputc('\n', stderr);
    }
    return exit;
}

static enum cli_exit ask(bool fresh, char line[LONGEST], struct cli_fault *fault)
{
    char again[LONGEST] = "";
    enum cli_exit exit = ask_once("Passphrase: ", line, fault);
    if (!exit && fresh && isatty(STDIN_FILENO)) {
        exit = ask_once("Once more: ", again, fault);
        if (!exit && strcmp(line, again) != 0) {
            exit = cli_fault_set(fault, CLI_EXIT_USAGE, "passphrase", "the two passphrases differ");
        }
        sodium_memzero(again, sizeof again);
    }
    return exit;
}

static enum cli_exit derive(const char *line, const uint8_t salt[CLI_SALT_BYTES],
                            uint8_t key[CLI_KEY_BYTES], struct cli_fault *fault)
{
    struct iso_progress *progress = iso_progress_start(
        stderr, "isotherm", "deriving the key from the passphrase", 0, NULL);
    const int failed = crypto_pwhash(key, CLI_KEY_BYTES, line, strlen(line), salt,
                                     ISO_CONTRACT_PEOPLE_PASSES, ISO_CONTRACT_PEOPLE_MEMORY_BYTES,
                                     crypto_pwhash_ALG_ARGON2ID13);

    iso_progress_end(progress);
    return failed ? cli_fault_set(fault, CLI_EXIT_FAULT, "internal",
                                  "out of memory: a passphrase takes %d MiB",
                                  ISO_CONTRACT_PEOPLE_MEMORY_BYTES >> 20)
                  : CLI_EXIT_OK;
}

enum cli_exit cli_passphrase_key(const char *file, bool fresh, const uint8_t salt[CLI_SALT_BYTES],
                                 uint8_t key[CLI_KEY_BYTES], struct cli_fault *fault)
{
    char line[LONGEST] = "";
    enum cli_exit exit = file ? read_file(file, line, fault) : ask(fresh, line, fault);
    if (!exit && fresh && strlen(line) < SHORTEST_FRESH) {
        exit = cli_fault_set(fault, CLI_EXIT_USAGE, "passphrase",
                             "a passphrase has at least %d bytes", SHORTEST_FRESH);
    }
    if (!exit) {
        exit = derive(line, salt, key, fault);
    }
    sodium_memzero(line, sizeof line);
    return exit;
}
