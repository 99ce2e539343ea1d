/* The methods of cards and of the policy of the stand-in for the daemon. */
#ifndef TEST_WEB_RIG_ACCESS_H
#define TEST_WEB_RIG_ACCESS_H

#include "tests/enroll/web/rigs/service_rig.h"

/* What the methods answer. A NULL text is "". */
struct rig_access {
    struct rig_service *service; /* whose trace, failures and bus are used */
    const char *document;        /* of GetPolicy */
    uint64_t revision;           /* of GetPolicy; SetPolicy answers with one more */
    const char *finding;         /* of CheckPolicy and SetPolicy; NULL: there is none */
    const char *outcome, *reason, *wanted;
    bool companion;
    const char *holder; /* who has the credential; NULL: nobody */
    const char *credential;
};

/* Adds the methods to a stand-in that is on the bus. *access lives as long as that. */
void rig_access_serve(struct rig_access *access, struct rig_service *service);

#endif
