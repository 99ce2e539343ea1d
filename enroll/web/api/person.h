/* People as ListPeople reports them. Internal to enroll/web/api. */
#ifndef WEB_API_PERSON_H
#define WEB_API_PERSON_H

#include <stdint.h>
#include <stdio.h>
#include <systemd/sd-bus.h>

#include "enroll/web/daemon/last_seen.h"

struct web_api_person {
    const char *name; /* in the reply */
    int64_t enrolled_s, valid_from_s, valid_until_s;
    uint32_t templates;
};

/* Reads the next person of a list. Returns a positive number, 0 at the end, or a negative errno of
 * sd-bus. */
int web__api_person_read(sd_bus_message *reply, struct web_api_person *out)
    __attribute__((warn_unused_result));

/* Writes the object Person of openapi.json. remark: what the daemon remarked about a change; "":
 * nothing. */
void web__api_person_write(FILE *out, const struct web_last_seen *seen,
                           const struct web_api_person *person, const char *remark);

#endif
