/* What the handlers of cards and of the policy share. Internal to enroll/web/api. */
#ifndef WEB_API_ACCESS_ACCESS_H
#define WEB_API_ACCESS_ACCESS_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <systemd/sd-bus.h>

#include "enroll/web/http/exchange.h"

/* Answers an error of the daemon as a problem. `invalid` is the code, with status 400, of what the
 * daemon refuses as wrong; the detail is the daemon's line. Besides: 409 "policy-changed", 409
 * "card-in-use", and what web_api_daemon_problem() answers. */
void web__access_problem(struct web_exchange *exchange, const sd_bus_error *error,
                         const char *invalid);

/* What was shown to a door, in the order of this list. */
enum { WEB_ACCESS_METHODS = 3 };
extern const char *const web__access_methods[WEB_ACCESS_METHODS]; /* "face", "card", "pin" */

/* Reads a list such as "face,card"; "" is nobody's proof: nothing was shown. Returns false for
 * another word or a word that is there twice; *shown then stays as it was. */
bool web__access_shown_read(const char *text, bool shown[WEB_ACCESS_METHODS])
    __attribute__((warn_unused_result));

/* A change of the policy, as PUT /policy has it. */
struct web_access_change {
    uint64_t revision; /* on which it is based */
    char *document;    /* compact JSON; "": no policy. Freed with free() by the caller */
};

/* Reads {"revision": 3, "document": {...} or null}. Returns NULL, or a sentence that says what is
 * wrong; *out then stays as it was. "" if there is no memory. */
const char *web__access_change_read(const json_t *body, struct web_access_change *out)
    __attribute__((warn_unused_result));

/* The members that a list of people has for a credential (firmware/policy/credential/
 * credential_json.h): ",\"cards\":[\"17/4711\"],\"enabled\":true". The caller frees it with free().
 * NULL if the text is no credential, or without memory. */
char *web__access_members(const char *credential);

#endif
