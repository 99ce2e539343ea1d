#include "tests/enroll/web/rigs/access_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

#include "firmware/contract/contract.h"

static void note(struct rig_access *access, const char *format, ...)
{
    char *trace = access->service->trace;
    const size_t length = strlen(trace);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(trace + length, sizeof access->service->trace - length, format, arguments);
    va_end(arguments);
}

/* Notes the arguments of a call, which are texts, whole numbers and lists of texts. */
static int note_call(struct rig_access *access, sd_bus_message *call)
{
    const char *text;
    int64_t number;
    int r = 0;
    note(access, "%s", sd_bus_message_get_member(call));
    for (const char *types = sd_bus_message_get_signature(call, true); r >= 0 && *types; types++) {
        if (*types == 's') {
            r = sd_bus_message_read(call, "s", &text);
            note(access, " %s", r < 0 ? "?" : text);
        } else if (*types == 'x' || *types == 't') {
            r = sd_bus_message_read_basic(call, *types, &number);
            note(access, " %" PRId64, number);
        } else {
            r = sd_bus_message_enter_container(call, 'a', "s");
            while (r >= 0 && (r = sd_bus_message_read_basic(call, 's', &text)) > 0) {
                note(access, " +%s", text);
            }
            types++;
        }
    }
    note(access, ";");
    return r;
}

static int append_text(sd_bus_message *reply, const char *key, const char *text)
{
    return sd_bus_message_append(reply, "{sv}", key, "s", text ? text : "");
}

static int append_decision(sd_bus_message *reply, const struct rig_access *access)
{
    int r = sd_bus_message_open_container(reply, 'a', "{sv}");
    r = r < 0 ? r : append_text(reply, ISO_CONTRACT_ACCESS_OUTCOME, access->outcome);
    r = r < 0 ? r : append_text(reply, ISO_CONTRACT_ACCESS_REASON, access->reason);
    r = r < 0 ? r
              : sd_bus_message_append(reply, "{sv}", ISO_CONTRACT_ACCESS_WANTED, "as",
                                      access->wanted ? 1 : 0, access->wanted);
    r = r < 0 ? r
              : sd_bus_message_append(reply, "{sv}", ISO_CONTRACT_ACCESS_COMPANION, "b",
                                      (int)access->companion);
    r = r < 0 ? r : append_text(reply, ISO_CONTRACT_ACCESS_LEVEL, "face");
    r = r < 0 ? r : append_text(reply, ISO_CONTRACT_ACCESS_POINT, "front");
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

static int append_reply(sd_bus_message *reply, const struct rig_access *access, const char *method)
{
    const char *credential = access->credential ? access->credential : "{}";
    const int findings = access->finding ? 1 : 0;
    if (strcmp(method, ISO_CONTRACT_GET_POLICY) == 0) {
        return sd_bus_message_append(reply, "st", access->document ? access->document : "",
                                     access->revision);
    }
    if (strcmp(method, ISO_CONTRACT_SET_POLICY) == 0) {
        return sd_bus_message_append(reply, "tas", access->revision + 1, findings, access->finding);
    }
    if (strcmp(method, ISO_CONTRACT_CHECK_POLICY) == 0) {
        return sd_bus_message_append(reply, "as", findings, access->finding);
    }
    if (strcmp(method, ISO_CONTRACT_TEST_ACCESS) == 0) {
        return append_decision(reply, access);
    }
    if (strcmp(method, ISO_CONTRACT_LIST_CREDENTIALS) == 0) {
        return sd_bus_message_append(reply, "a(ss)", access->holder ? 1 : 0, access->holder,
                                     credential);
    }
    return sd_bus_message_append(reply, "s", credential);
}

static int on_call(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct rig_access *access = context;
    const struct rig_service *service = access->service;
    const char *method = sd_bus_message_get_member(call);
    sd_bus_message *reply = NULL;
    int r = note_call(access, call);
    if (r < 0) {
        return r;
    }
    if (service->fail_method && strcmp(method, service->fail_method) == 0) {
        return sd_bus_error_set(error, service->fail_error, "as the script says");
    }
    r = sd_bus_message_new_method_return(call, &reply);
    r = r < 0 ? r : append_reply(reply, access, method);
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    return r;
}

#define METHOD(name, in, out) SD_BUS_METHOD(name, in, out, on_call, SD_BUS_VTABLE_UNPRIVILEGED)

static const sd_bus_vtable vtable[] = {
    SD_BUS_VTABLE_START(0),
    METHOD(ISO_CONTRACT_GET_POLICY, "", "st"),
    METHOD(ISO_CONTRACT_SET_POLICY, "st", "tas"),
    METHOD(ISO_CONTRACT_CHECK_POLICY, "", "as"),
    METHOD(ISO_CONTRACT_TEST_ACCESS, "ssxas", "a{sv}"),
    METHOD(ISO_CONTRACT_GET_CREDENTIAL, "s", "s"),
    METHOD(ISO_CONTRACT_SET_CREDENTIAL, "ss", "s"),
    METHOD(ISO_CONTRACT_LIST_CREDENTIALS, "", "a(ss)"),
    SD_BUS_VTABLE_END,
};

void rig_access_serve(struct rig_access *access, struct rig_service *service)
{
    access->service = service;
    assert_true(sd_bus_add_object_vtable(service->bus, NULL, ISO_CONTRACT_PATH,
                                         ISO_CONTRACT_INTERFACE, vtable, access) >= 0);
}
