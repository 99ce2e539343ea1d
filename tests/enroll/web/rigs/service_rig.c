#include "tests/enroll/web/rigs/service_rig.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/socket.h>
#include <unistd.h>

#include "firmware/contract/bus_connect.h"
#include "firmware/contract/contract.h"

static void note(struct rig_service *service, const char *format, ...)
{
    const size_t length = strlen(service->trace);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(service->trace + length, sizeof service->trace - length, format, arguments);
    va_end(arguments);
}

/* Whether the script lets the call fail, or does not answer it. Then the result is in *r. */
static bool is_scripted(struct rig_service *service, sd_bus_message *call, sd_bus_error *error,
                        int *r)
{
    const char *method = sd_bus_message_get_member(call);
    if (service->silent_method && strcmp(method, service->silent_method) == 0) {
        *r = 1;
        return true;
    }
    if (service->fail_method && strcmp(method, service->fail_method) == 0) {
        if (service->fail_times == 1) {
            service->fail_method = NULL;
        }
        service->fail_times -= service->fail_times > 1;
        *r = sd_bus_error_set(error, service->fail_error, "as the script says");
        return true;
    }
    return false;
}

static int append_status(sd_bus_message *reply, const struct rig_service *service)
{
    return sd_bus_message_append(reply, "a{sv}", 8, "version", "s", ISOTHERM_VERSION, "uptime-ms",
                                 "x", service->uptime_ms, "frames", "t", service->uptime_ms,
                                 "sensor-state", "s", "started", "mode", "s", service->mode,
                                 "lockdown", "b", (int)service->lockdown, "visits-allowed", "t",
                                 UINT64_C(3), "log-sequence", "t", (uint64_t)service->last_record);
}

static int append_people(sd_bus_message *reply, const struct rig_service *service)
{
    int r = sd_bus_message_open_container(reply, 'a', "(sxxxu)");
    for (int i = service->n_people; r >= 0 && i-- > 0;) {
        char name[32];
        (void)snprintf(name, sizeof name, "person %05d", i);
        r = sd_bus_message_append(reply, "(sxxxu)", name, INT64_C(1700000000) + i, INT64_C(0),
                                  INT64_C(0), UINT32_C(5));
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

static int append_records(sd_bus_message *reply, const struct rig_service *service, uint64_t from,
                          uint32_t max)
{
    char line[512];
    int r = sd_bus_message_open_container(reply, 'a', "s");
    for (uint64_t i = from; r >= 0 && i < from + max && (int)i <= service->last_record; i++) {
        service->record((int)i, line, sizeof line);
        r = sd_bus_message_append(reply, "s", line);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

static int on_lists(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct rig_service *service = context;
    const char *method = sd_bus_message_get_member(call);
    sd_bus_message *reply = NULL;
    uint64_t from;
    uint32_t max;
    int r = 0;
    if (is_scripted(service, call, error, &r)) {
        return r;
    }
    r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0 && strcmp(method, ISO_CONTRACT_GET_STATUS) == 0) {
        r = append_status(reply, service);
    } else if (r >= 0 && strcmp(method, ISO_CONTRACT_LIST_PEOPLE) == 0) {
        r = append_people(reply, service);
    } else if (r >= 0 && strcmp(method, ISO_CONTRACT_GET_SETTINGS) == 0) {
        r = sd_bus_message_append(reply, "a(ssssssbs)", 2, "door", "unlock_ms", "3000", "5000",
                                  "100..60000", "how long", 1, "4000", "sensor", "backend",
                                  "replay", "", "a word", "says \"which\"", 0, "replay");
    } else if (r >= 0) {
        service->n_log_calls++;
        r = sd_bus_message_read(call, "tu", &from, &max);
        r = r < 0 ? r : append_records(reply, service, from, max);
    }
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    return r;
}

/* Notes the options of a call. */
static int note_options(struct rig_service *service, sd_bus_message *call)
{
    int r = sd_bus_message_enter_container(call, 'a', "{sv}");
    while (r >= 0 && (r = sd_bus_message_enter_container(call, 'e', "sv")) > 0) {
        const char *name, *type;
        int64_t number = 0;
        int flag = 0;
        r = sd_bus_message_read(call, "s", &name);
        r = r < 0 ? r : sd_bus_message_peek_type(call, NULL, &type);
        if (r >= 0) {
            r = *type == 'b' ? sd_bus_message_read(call, "v", "b", &flag)
                             : sd_bus_message_read(call, "v", "x", &number);
        }
        r = r < 0 ? r : sd_bus_message_exit_container(call);
        note(service, " %s=%" PRId64, r < 0 ? "?" : name, number + flag);
    }
    return r;
}

/* The changes, and the calls of an enrolment. */
static int on_change(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct rig_service *service = context;
    const char *method = sd_bus_message_get_member(call);
    const char *types = sd_bus_message_get_signature(call, true);
    const char *text = NULL;
    int r = 0, flag = 0;
    note(service, "%s", method);
    for (; *types == 's'; types++) {
        if (sd_bus_message_read(call, "s", &text) < 0) {
            return -EINVAL;
        }
        note(service, " %s", text);
    }
    if (strcmp(types, "a{sv}") == 0) {
        r = note_options(service, call);
    } else if (*types == 'b') {
        r = sd_bus_message_read(call, "b", &flag);
        note(service, " %d", flag);
    }
    note(service, ";");
    if (r < 0 || is_scripted(service, call, error, &r)) {
        return r;
    }
    if (strcmp(method, ISO_CONTRACT_CLAIM) == 0) {
        (void)snprintf(service->claimant, sizeof service->claimant, "%s",
                       sd_bus_message_get_sender(call));
    } else if (strcmp(method, ISO_CONTRACT_RELEASE) == 0) {
        service->claimant[0] = '\0';
        service->mode = "watch";
    } else if (strcmp(method, ISO_CONTRACT_ENROLL_START) == 0) {
        service->mode = "enroll";
        return sd_bus_reply_method_return(call, "a{sv}", 0);
    } else if (strcmp(method, ISO_CONTRACT_RENAME_PERSON) == 0) {
        return sd_bus_reply_method_return(call, "s", service->remark ? service->remark : "");
    } else if (strcmp(method, ISO_CONTRACT_SET_SETTING) == 0) {
        return sd_bus_reply_method_return(call, "s", text);
    } else if (strcmp(method, ISO_CONTRACT_RESET_SETTING) == 0) {
        return sd_bus_reply_method_return(call, "s", "4000");
    } else if (strcmp(method, ISO_CONTRACT_SET_VALIDITY) == 0) {
        return sd_bus_reply_method_return(call, "sxx", "person 00000", INT64_C(0), INT64_C(0));
    } else if (strcmp(method, ISO_CONTRACT_VERIFY_LOG) == 0) {
        return sd_bus_reply_method_return(call, "bttsts", 0, UINT64_C(2), UINT64_C(9), "9:ab",
                                          UINT64_C(7), "it was changed");
    }
    return sd_bus_reply_method_return(call, NULL);
}

static int on_watch(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct rig_service *service = context;
    const bool outline = strcmp(sd_bus_message_get_member(call), ISO_CONTRACT_WATCH) == 0;
    int *own = outline ? &service->outline_fd : &service->relief_fd, pair[2], r = 0;
    note(service, "%s;", sd_bus_message_get_member(call));
    if (is_scripted(service, call, error, &r)) {
        return r;
    }
    assert_int_equal(socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC | SOCK_NONBLOCK, 0, pair),
                     0);
    if (*own >= 0) {
        (void)close(*own);
    }
    *own = pair[0];
    service->n_watches += outline;
    r = sd_bus_reply_method_return(call, "h", pair[1]);
    (void)close(pair[1]);
    return r;
}

#define METHOD(name, in, out, handler) \
    SD_BUS_METHOD(name, in, out, handler, SD_BUS_VTABLE_UNPRIVILEGED)

static const sd_bus_vtable vtable[] = {
    SD_BUS_VTABLE_START(0),
    METHOD(ISO_CONTRACT_GET_STATUS, "", "a{sv}", on_lists),
    METHOD(ISO_CONTRACT_GET_SETTINGS, "", "a(ssssssbs)", on_lists),
    METHOD(ISO_CONTRACT_SET_SETTING, "sss", "s", on_change),
    METHOD(ISO_CONTRACT_RESET_SETTING, "ss", "s", on_change),
    METHOD(ISO_CONTRACT_LIST_PEOPLE, "", "a(sxxxu)", on_lists),
    METHOD(ISO_CONTRACT_READ_LOG, "tu", "as", on_lists),
    METHOD(ISO_CONTRACT_RECORD_ACT, "sss", "", on_change),
    METHOD(ISO_CONTRACT_CLAIM, "", "", on_change),
    METHOD(ISO_CONTRACT_RELEASE, "", "", on_change),
    METHOD(ISO_CONTRACT_ENROLL_START, "sa{sv}", "a{sv}", on_change),
    METHOD(ISO_CONTRACT_SET_LOCKDOWN, "b", "", on_change),
    METHOD(ISO_CONTRACT_CLEAR_LOCKOUT, "", "", on_change),
    METHOD(ISO_CONTRACT_RENAME_PERSON, "ss", "s", on_change),
    METHOD(ISO_CONTRACT_SET_VALIDITY, "sa{sv}", "sxx", on_change),
    METHOD(ISO_CONTRACT_DELETE_PERSON, "s", "", on_change),
    METHOD(ISO_CONTRACT_VERIFY_LOG, "ts", "bttsts", on_change),
    METHOD(ISO_CONTRACT_WATCH, "s", "h", on_watch),
    METHOD(ISO_CONTRACT_WATCH_RELIEF, "", "h", on_watch),
    SD_BUS_VTABLE_END,
};

void rig_service_start(struct rig_service *service, sd_event *event, const char *address)
{
    assert_null(service->bus);
    service->outline_fd = service->relief_fd = -1;
    service->mode = "watch";
    assert_true(iso_bus_connect(address, &service->bus) >= 0);
    assert_true(sd_bus_add_object_vtable(service->bus, NULL, ISO_CONTRACT_PATH,
                                         ISO_CONTRACT_INTERFACE, vtable, service) >= 0);
    assert_true(sd_bus_request_name(service->bus, ISO_CONTRACT_NAME, 0) >= 0);
    assert_true(sd_bus_attach_event(service->bus, event, SD_EVENT_PRIORITY_NORMAL) >= 0);
}

void rig_service_stop(struct rig_service *service)
{
    if (service->bus) {
        (void)sd_bus_detach_event(service->bus);
        service->bus = sd_bus_flush_close_unref(service->bus);
        service->claimant[0] = '\0';
        if (service->outline_fd >= 0) {
            (void)close(service->outline_fd);
        }
        if (service->relief_fd >= 0) {
            (void)close(service->relief_fd);
        }
    }
}

static void send_signal(sd_bus *bus, const char *destination, const char *member, const char *types,
                        va_list arguments)
{
    sd_bus_message *signal = NULL;
    assert_true(sd_bus_message_new_signal(bus, &signal, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                          member) >= 0);
    assert_true(sd_bus_message_appendv(signal, types, arguments) >= 0);
    assert_true(!destination || sd_bus_message_set_destination(signal, destination) >= 0);
    assert_true(sd_bus_send(bus, signal, NULL) >= 0);
    assert_true(sd_bus_flush(bus) >= 0);
    sd_bus_message_unref(signal);
}

void rig_service_signal(struct rig_service *service, bool to_claimant, const char *member,
                        const char *types, ...)
{
    va_list arguments;
    va_start(arguments, types);
    send_signal(service->bus, to_claimant ? service->claimant : NULL, member, types, arguments);
    va_end(arguments);
}

void rig_strange_signal(const char *address, const char *destination, const char *member,
                        const char *types, ...)
{
    sd_bus *bus = NULL;
    va_list arguments;
    assert_true(iso_bus_connect(address, &bus) >= 0);
    va_start(arguments, types);
    send_signal(bus, destination, member, types, arguments);
    va_end(arguments);
    sd_bus_flush_close_unref(bus);
}
