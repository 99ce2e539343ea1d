/* The calls of an enrolment. Internal to enroll/web/daemon. */
#ifndef WEB_DAEMON_ENROLMENT_CALL_H
#define WEB_DAEMON_ENROLMENT_CALL_H

#include "enroll/web/daemon/enrolment.h"

/* Appends the arguments of EnrollStart. A negative errno of sd-bus. */
int web__enrolment_append(sd_bus_message *call, const struct web_enrolment_request *request)
    __attribute__((warn_unused_result));

/* Whether an error of Release says that this client does not have the camera any more. */
bool web__enrolment_is_released(const sd_bus_error *error);

#endif
