/* The handlers of sessions, accounts and updates on a web server. The connection to the daemon is a
 * stand-in that keeps what was to be put on record. */
#ifndef TESTS_ENROLL_WEB_RIGS_API_RIG_H
#define TESTS_ENROLL_WEB_RIGS_API_RIG_H

#include "enroll/web/api/api.h"
#include "tests/enroll/web/rigs/web_rig.h"

#define PASSWORD "correct horse battery"
#define OTHER    "another long password"

struct api_rig {
    struct web_rig web;
    struct web_api api;
    struct web_guess guess;
    struct https client; /* a connection */
    char setup_code[256], accounts_path[256];

    /* The stand-in for the daemon. */
    char said[1024];           /* "account act person\n" for each record */
    const sd_bus_error *error; /* of the records; NULL: they succeed */
    bool waits;                /* the next answer comes when the test calls api_rig_reply */
    size_t n_waiting;          /* what web_daemon_waiting says */
    web_daemon_reply_fn on_reply;
    void *context;
};

extern struct api_rig api_rig;

/* cmocka set-up and tear-down. *state is the folder of scratch_setup. */
int api_rig_setup(void **state);
int api_rig_teardown(void **state);

/* Answers the record that waits. Both arguments may be NULL. */
int api_rig_reply(sd_event_source *source, void *context);

/* Adds an account with the password PASSWORD. */
void api_rig_add_account(const char *name, enum web_role role);

/* Asks, and returns the header lines of further requests, with the cookie of the answer, in a new
 * text. */
char *api_rig_log_in(const char *path, const char *body);
char *api_rig_log_in_as(const char *name);

/* web_rig_expect on the connection; and the same for the whole body of the answer. */
void api_rig_expect(const char *method, const char *path, const char *headers, const char *body,
                    int status, const char *code);
void api_rig_expect_body(const char *method, const char *path, const char *headers, int status,
                         const char *body);

#endif
