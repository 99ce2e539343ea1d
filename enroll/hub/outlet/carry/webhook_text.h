/* What a webhook sends: the body and its signature. Pure.
 *
 * The body is a JSON array of events in the order in which they are handed over:
 *   [{"door":"0190b3f2-...","door_name":"Main entrance","number":17,
 *     "time":"2026-11-21T08:30:15.250Z","event":"visit","record":{...}}, ...]
 * `record` is the record of the door's log as the door wrote it. The header
 *   Isotherm-Signature: t=1795251015,v1=<64 hexadecimal digits>
 * has the time of the request in seconds since 1970, and HMAC-SHA-256 with the outlet's secret over
 * the time as it stands there, a dot, and the body. A receiver compares it in constant time and
 * refuses old times. */
#ifndef ISO_ENROLL_HUB_OUTLET_CARRY_WEBHOOK_TEXT_H
#define ISO_ENROLL_HUB_OUTLET_CARRY_WEBHOOK_TEXT_H

#include "enroll/hub/outlet/batch.h"

enum { HUB__SIGNATURE_SIZE = 96 };

/* The caller frees the text. NULL: no memory, or a record is no JSON. */
char *hub__webhook_body(const struct hub__batch *batch);

/* The value of the header. */
void hub__webhook_sign(const char *secret, int64_t time_s, const char *body,
                       char out[HUB__SIGNATURE_SIZE]);

#endif
