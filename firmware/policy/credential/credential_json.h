/* A credential as clients read and change it. Pure.
 *
 *   {"enabled": true, "disabled_reason": "", "cards": ["17/4711"], "pin": "1234",
 *    "duress_pin": "9999", "profiles": ["staff"], "no_antipassback": false, "needs_escort": false,
 *    "two_person_class": 0}
 *
 * A change is a JSON merge patch (RFC 7396): a member that is not named stays, and null gives it
 * the value of a new credential. An array replaces the earlier one. What clients read has true or
 * false in place of a PIN, because nobody needs to read one. */
#ifndef ISO_FIRMWARE_POLICY_CREDENTIAL_CREDENTIAL_JSON_H
#define ISO_FIRMWARE_POLICY_CREDENTIAL_CREDENTIAL_JSON_H

#include "firmware/policy/credential/credential_record.h"

enum { ISO_CREDENTIAL_PATCH_MAX = 4096 }; /* bytes of a patch */

/* Changes a record. Returns 0; -ENOMEM; or -EINVAL, and the line of the fault names a member that
 * is unknown, of another type, or refused by iso_credential_record_check(). After an error the
 * record is as before. */
int iso_credential_patch(const char *json, struct iso_credential_record *record,
                         struct iso_fault *fault) __attribute__((warn_unused_result));

/* The JSON text of a record, which the caller frees; NULL without memory. */
char *iso_credential_text(const struct iso_credential_record *record);

/* A patch that makes a new record this one, with the digits of its PINs: for another store that is
 * to have the same credential. The caller wipes and frees it; NULL without memory. */
char *iso_credential_patch_text(const struct iso_credential_record *record);

#endif
