/* The policy and the credentials of the script. */
#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_service.h"

int fake_on_get_policy(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const struct fake_script *script = service->script;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    return sd_bus_reply_method_return(call, "st", script->policy ? script->policy : "",
                                      script->policy_revision);
}

int fake_on_set_policy(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const struct fake_script *script = service->script;
    const char *document;
    uint64_t revision;
    char text[32];

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read(call, "st", &document, &revision);
    if (r < 0) {
        return r;
    }
    (void)snprintf(text, sizeof text, " %" PRIu64 " ", revision);
    fake_trace(service, text);
    fake_trace(service, document);
    return script->policy_remark
               ? sd_bus_reply_method_return(call, "tas", revision + 1, 1, script->policy_remark)
               : sd_bus_reply_method_return(call, "tas", revision + 1, 0);
}

int fake_on_check_policy(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const struct fake_script *script = service->script;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    return script->finding ? sd_bus_reply_method_return(call, "as", 1, script->finding)
                           : sd_bus_reply_method_return(call, "as", 0);
}

static int trace_test(const struct fake_service *service, sd_bus_message *call)
{
    const char *person, *point, *method;
    int64_t time_s;
    char text[256];
    int r = sd_bus_message_read(call, "ssx", &person, &point, &time_s);

    if (r < 0) {
        return r;
    }
    (void)snprintf(text, sizeof text, " %s %s %" PRId64, person, point[0] ? point : "-", time_s);
    fake_trace(service, text);
    r = sd_bus_message_enter_container(call, 'a', "s");
    while (r >= 0 && (r = sd_bus_message_read(call, "s", &method)) > 0) {
        fake_trace(service, " ");
        fake_trace(service, method);
    }
    return r;
}

int fake_on_test_access(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const struct fake_script *script = service->script;
    const char *outcome = script->outcome ? script->outcome : "allow";
    const bool wants = strcmp(outcome, "want") == 0;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    const int r = trace_test(service, call);
    if (r < 0) {
        return r;
    }
    return wants ? sd_bus_reply_method_return(call, "a{sv}", 4, "outcome", "s", outcome, "wanted",
                                              "as", 2, "card", "pin", "access-point", "s", "front",
                                              "companion", "b", script->companion)
                 : sd_bus_reply_method_return(call, "a{sv}", 6, "outcome", "s", outcome, "reason",
                                              "s", script->reason ? script->reason : "", "wanted",
                                              "as", 0, "level", "s", "face", "access-point", "s",
                                              "front", "companion", "b", 0);
}

static int answer_credential(const struct fake_service *service, sd_bus_message *call)
{
    const char *credential = service->script->credential;

    return sd_bus_reply_method_return(call, "s",
                                      credential ? credential : "{\"enabled\":true,\"cards\":[]}");
}

int fake_on_get_credential(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *person;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read(call, "s", &person);
    if (r < 0) {
        return r;
    }
    fake_trace(service, " ");
    fake_trace(service, person);
    return answer_credential(service, call);
}

int fake_on_set_credential(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct fake_service *service = context;
    const char *person, *patch;

    if (fake_fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read(call, "ss", &person, &patch);
    if (r < 0) {
        return r;
    }
    fake_trace(service, " ");
    fake_trace(service, person);
    fake_trace(service, " ");
    fake_trace(service, patch);
    return answer_credential(service, call);
}
