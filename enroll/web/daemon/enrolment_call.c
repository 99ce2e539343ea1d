#include "enroll/web/daemon/enrolment_call.h"

#include "firmware/contract/contract.h"

int web__enrolment_append(sd_bus_message *call, const struct web_enrolment_request *request)
{
    int r = sd_bus_message_append(call, "s", request->person);
    if (r >= 0) {
        r = sd_bus_message_open_container(call, 'a', "{sv}");
    }
    if (r >= 0) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_POSES, "b", (int)request->poses);
    }
    if (r >= 0) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_ALLOW_DUPLICATE, "b",
                                  (int)request->allow_duplicate);
    }
    if (r >= 0 && request->names_from) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_VALID_FROM, "x",
                                  request->valid_from_s);
    }
    if (r >= 0 && request->names_until) {
        r = sd_bus_message_append(call, "{sv}", ISO_CONTRACT_VALID_UNTIL, "x",
                                  request->valid_until_s);
    }
    return r < 0 ? r : sd_bus_message_close_container(call);
}

bool web__enrolment_is_released(const sd_bus_error *error)
{
    static const char *const names[] = {
        ISO_CONTRACT_ERROR_CLAIM_DEVICE, ISO_CONTRACT_ERROR_ALREADY_IN_USE,
        SD_BUS_ERROR_SERVICE_UNKNOWN, SD_BUS_ERROR_NAME_HAS_NO_OWNER, SD_BUS_ERROR_DISCONNECTED};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (sd_bus_error_has_name(error, names[i])) {
            return true;
        }
    }
    return false;
}
