/* Problems that several handlers answer. */
#include <string.h>

#include "enroll/web/api/act.h"
#include "firmware/contract/contract.h"

struct problem {
    const char *name;
    unsigned status;
    const char *code;
    const char *detail; /* NULL: the text of the daemon */
};

static const char no_daemon[] = "the daemon of the door does not answer";

/* sd-bus itself reports that the connection is gone as "System.Error.E...". */
static const struct problem problems[] = {
    {ISO_CONTRACT_ERROR_ALREADY_IN_USE, 409, "camera-in-use", NULL},
    {ISO_CONTRACT_ERROR_CLAIM_DEVICE, 409, "no-enrolment", NULL},
    {ISO_CONTRACT_ERROR_NO_SUCH_PERSON, 404, "no-such-person", NULL},
    {ISO_CONTRACT_ERROR_NO_ACTION, 409, "no-enrolment", NULL},
    {ISO_CONTRACT_ERROR_ACTION, 409, "enrolment-running", NULL},
    {ISO_CONTRACT_ERROR_INVALID_NAME, 400, "invalid-name", NULL},
    {ISO_CONTRACT_ERROR_NAME_IN_USE, 409, "name-in-use", NULL},
    {ISO_CONTRACT_ERROR_INVALID_ARGUMENT, 400, "invalid-limits", NULL},
    {ISO_CONTRACT_ERROR_GALLERY_FULL, 409, "gallery-full", NULL},
    {ISO_CONTRACT_ERROR_REJECTED, 409, "rejected", NULL},
    {ISO_CONTRACT_ERROR_LOCKED_OUT, 423, "locked-out", NULL},
    {ISO_CONTRACT_ERROR_TOO_MANY_CALLS, 503, "daemon-busy", NULL},
    {ISO_CONTRACT_ERROR_DEVICE_FAULT, 503, "device-fault", NULL},
    {ISO_CONTRACT_ERROR_STORAGE, 507, "storage", NULL},
    {ISO_CONTRACT_ERROR_INTERNAL, 500, "internal", NULL},
    {SD_BUS_ERROR_ACCESS_DENIED, 503, "daemon-denied",
     "the daemon of the door does not allow this to the web server"},
    {SD_BUS_ERROR_SERVICE_UNKNOWN, 503, "no-daemon", no_daemon},
    {SD_BUS_ERROR_NAME_HAS_NO_OWNER, 503, "no-daemon", no_daemon},
    {SD_BUS_ERROR_NO_REPLY, 503, "no-daemon", no_daemon},
    {SD_BUS_ERROR_TIMEOUT, 503, "no-daemon", no_daemon},
    {SD_BUS_ERROR_DISCONNECTED, 503, "no-daemon", no_daemon},
    {SD_BUS_ERROR_NO_SERVER, 503, "no-daemon", no_daemon},
    {"System.Error.ETIMEDOUT", 503, "no-daemon", no_daemon},
    {"System.Error.ENOTCONN", 503, "no-daemon", no_daemon},
    {"System.Error.ECONNRESET", 503, "no-daemon", no_daemon},
    {"System.Error.ECONNREFUSED", 503, "no-daemon", no_daemon},
    {"System.Error.EPIPE", 503, "no-daemon", no_daemon},
    {"System.Error.ENOENT", 503, "no-daemon", no_daemon},
};

struct web_problem web__api_problem_of(const sd_bus_error *error)
{
    const char *name = error->name ? error->name : "";
    const char *text = error->message ? error->message : "the daemon reports an error";

    for (size_t i = 0; i < sizeof problems / sizeof *problems; i++) {
        if (strcmp(problems[i].name, name) == 0) {
            return (struct web_problem){problems[i].status, problems[i].code,
                                        problems[i].detail ? problems[i].detail : text};
        }
    }
    return (struct web_problem){500, "internal", text};
}

void web_api_daemon_problem(struct web_exchange *exchange, const sd_bus_error *error)
{
    const struct web_problem problem = web__api_problem_of(error);

    web_exchange_problem(exchange, problem.status, problem.code, problem.detail);
}
