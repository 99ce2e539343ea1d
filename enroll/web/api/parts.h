/* What several handlers read from a request. Internal to enroll/web/api. */
#ifndef WEB_API_PARTS_H
#define WEB_API_PARTS_H

#include <stdbool.h>
#include <stdint.h>

#include "enroll/web/api/api.h"
#include "firmware/contract/person_name.h"

/* The limits of a person; those that are not named stay as they are. */
struct web_api_limits {
    bool names_from, names_until;
    bool expired; /* an end in the past is intended */
    int64_t from_s, until_s;
};

/* Reads the members valid_from_s and valid_until_s of the body, and `expired` if may_expire.
 * Returns false after answering 400 "invalid-limits". The daemon knows the limits that are stored,
 * and checks again. */
bool web__api_limits(struct web_exchange *exchange, bool may_expire, struct web_api_limits *out)
    __attribute__((warn_unused_result));

/* Reads a boolean of the body, which is `otherwise` if it is missing. Returns false after answering
 * 400 "invalid-member". */
bool web__api_flag(struct web_exchange *exchange, const char *member, bool otherwise, bool *out)
    __attribute__((warn_unused_result));

/* Copies the person of the path, of at most ISO_PERSON_NAME_SIZE bytes. Returns false after
 * answering 404 "no-such-person" for a longer name, which nobody has. */
bool web__api_person_of_path(struct web_exchange *exchange, char person[ISO_PERSON_NAME_SIZE])
    __attribute__((warn_unused_result));

/* The name of a person for RecordAct, which accepts only names that a new person may have. Other
 * names of earlier versions are still in some galleries: "" for them. The daemon's own record of
 * the change has the name. */
const char *web__api_name_on_record(const char *name);

/* Answers an error of the daemon; one of the limits as 400 "invalid-limits". `done` says what has
 * been done already, and is set before the text; "": nothing. */
void web__api_limits_problem(struct web_exchange *exchange, const sd_bus_error *error,
                             const char *done);

#endif
