/* Why a command could not do its work: an exit code, a word for programs and a line for people.
 * "No match" and "timed out while looking" are results, not faults; commands print those
 * themselves. */
#ifndef CLI_CLIENT_FAULT_H
#define CLI_CLIENT_FAULT_H

/* Exit codes of the program, documented in isotherm(1). */
enum cli_exit {
    CLI_EXIT_OK = 0,
    CLI_EXIT_NO = 1, /* no match, refused, not permitted */
    CLI_EXIT_USAGE = 2,
    CLI_EXIT_NOT_FOUND = 3,
    CLI_EXIT_FAULT = 4, /* device, data, daemon or bus */
    CLI_EXIT_TIMED_OUT = 5,
    CLI_EXIT_MORE = 6,          /* policy test: more has to be shown */
    CLI_EXIT_INTERRUPTED = 130, /* by SIGINT or SIGTERM, after a clean release */
};

struct cli_fault {
    char code[32];  /* "no-daemon", "already-in-use", ...; the "code" of the JSON error */
    char text[256]; /* one line without a newline; "" if there is no fault */
};

/* Fills in the fault and returns `exit`, so that a caller can `return cli_fault_set(...)`. The code
 * and the text are cut to fit. */
enum cli_exit cli_fault_set(struct cli_fault *fault, enum cli_exit exit, const char *code,
                            const char *format, ...) __attribute__((format(printf, 4, 5)));

#endif
