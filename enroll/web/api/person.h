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
    const char *cards; /* further members of the object, from web__api_cards_of(); NULL: none */
};

/* Reads the next person of a list. Returns a positive number, 0 at the end, or a negative errno of
 * sd-bus. */
int web__api_person_read(sd_bus_message *reply, struct web_api_person *out)
    __attribute__((warn_unused_result));

/* Writes the object Person of openapi.json. remark: what the daemon remarked about a change; "":
 * nothing. */
void web__api_person_write(FILE *out, const struct web_last_seen *seen,
                           const struct web_api_person *person, const char *remark);

/* The cards of all people, from a reply of ListCredentials (access/people_access.c). */
struct web_api_cards;

/* Reads the reply. The caller frees *out with web__api_cards_free(). -EBADMSG what is no
 * credential, -ENOMEM, errors of sd-bus. */
int web__api_cards_read(sd_bus_message *reply, struct web_api_cards **out)
    __attribute__((warn_unused_result));

/* Members for a person, by the exact name: ",\"cards\":[\"17/4711\"],\"enabled\":true". They live
 * as long as `cards`. */
const char *web__api_cards_of(const struct web_api_cards *cards, const char *person);

/* NULL is accepted. */
void web__api_cards_free(struct web_api_cards *cards);

#endif
