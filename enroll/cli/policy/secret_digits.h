/* A PIN, asked for at the terminal: it is never an argument, which others could see in the list of
 * processes. */
#ifndef CLI_POLICY_SECRET_DIGITS_H
#define CLI_POLICY_SECRET_DIGITS_H

#include "enroll/cli/client/fault.h"

/* 4 to 9 digits and a zero byte. */
enum { CLI_PIN_SIZE = 10 };

/* Asks for a PIN at the terminal, without echo, twice; `what` names it. If standard input is not a
 * terminal, its next line is read. The caller wipes `pin`. CLI_EXIT_USAGE "pin" if it is not 4 to 9
 * digits, or not the same twice. */
enum cli_exit cli_pin_ask(const char *what, char pin[CLI_PIN_SIZE], struct cli_fault *fault)
    __attribute__((warn_unused_result));

#endif
