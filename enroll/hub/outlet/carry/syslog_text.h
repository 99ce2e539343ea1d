/* Events as messages of syslog. Pure.
 *
 * HUB__SYSLOG_NETWORK is RFC 5424:
 *   <86>1 2026-11-21T08:30:15.250Z Main-entrance isotherm - visit
 *     [isotherm@32473 door="0190b3f2-..." name="Main entrance" number="17" event="visit"] {...}
 * in one line: the time and the name of the door, the event, and the record of the door's log as
 * JSON in ASCII. 32473 is the number that RFC 5612 keeps for examples; the project has none of its
 * own. HUB__SYSLOG_LOCAL is what local programs write into /dev/log: "<86>Nov 21 08:30:15
 * isotherm-hub: [...] {...}", with the time of the event in the local time zone, or `now_s` if it
 * has none. The facility is authpriv (10); an alert is a duress, a warning is what somebody should
 * look at. */
#ifndef ISO_ENROLL_HUB_OUTLET_CARRY_SYSLOG_TEXT_H
#define ISO_ENROLL_HUB_OUTLET_CARRY_SYSLOG_TEXT_H

#include "enroll/hub/outlet/batch.h"

enum hub__syslog_form { HUB__SYSLOG_NETWORK, HUB__SYSLOG_LOCAL };

/* The caller frees the text. NULL: no memory, or the record is no JSON. */
char *hub__syslog_text(const struct hub__batch_event *event, enum hub__syslog_form form,
                       int64_t now_s);

#endif
