/* Stand-ins of the exchange and of the connection to the daemon for fuzz_web_body.c. They replace
 * the real ones of the library at the link. */
#ifndef TESTS_FUZZ_ENROLL_WEB_STAND_IN_H
#define TESTS_FUZZ_ENROLL_WEB_STAND_IN_H

#include <jansson.h>
#include <stdbool.h>
#include <stdint.h>

#include "enroll/web/account/role.h"

struct web_exchange {
    const char *part;
    json_t *body;
    const char *account;
    enum web_role role;
    uint64_t session;
    int answers; /* how often it was answered */
    unsigned status;
    json_t *json; /* of the answer */
};

/* What the daemon was asked since web_stand_in_reset(). */
struct web_stand_in {
    bool refuses; /* records are refused */
    int n_records, n_calls;
    bool changes; /* a call was to change something */
    bool claimed; /* the camera was claimed */
    int n_due;    /* answers that are owed */
};

extern struct web_stand_in web_stand_in;

void web_stand_in_reset(bool refuses);

/* Gives the answers that are owed. A record succeeds unless it is refused; all other calls fail,
 * because a reply is not what is tested here. */
void web_stand_in_answer(void);

#endif
