/* The command line of isotherm-web. */
#ifndef ENROLL_WEB_OPTIONS_H
#define ENROLL_WEB_OPTIONS_H

#include <stdbool.h>

enum web_command {
    WEB_COMMAND_SERVE,       /* without a word */
    WEB_COMMAND_SETUP_CODE,  /* setup-code */
    WEB_COMMAND_FINGERPRINT, /* fingerprint */
};

struct web_options {
    bool first_code; /* the server makes the code for the first account itself */
    enum web_command command;
    const char *bus;     /* "system", "session" or an address */
    const char *listen;  /* "ADDRESS:PORT", unless the service manager passes a socket */
    const char *state;   /* the folder of accounts, key and certificate */
    const char *pages;   /* the folder of the pages */
    const char *updates; /* the folder of updates: enroll/web/update/upload.h */
};

/* Reads the command line. Returns 0; 1 if help or version was printed; or -EINVAL after a line on
 * stderr that says what is wrong. */
int web_options_read(int argc, char **argv, struct web_options *out)
    __attribute__((warn_unused_result));

#endif
