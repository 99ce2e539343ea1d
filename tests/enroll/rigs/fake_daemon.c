#include "tests/enroll/rigs/fake_daemon.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <time.h>
#include <unistd.h>

#include "firmware/contract/contract.h"
#include "tests/enroll/rigs/fake_status.h"
#include "tests/enroll/rigs/fake_work.h"

enum { RECORD_SIZE = 512 };
enum { LOG_RECORDS_MAX = 100 }; /* that are handed out at once: fewer than may be asked for */

struct service {
    const struct fake_script *script;
    const char *address;
    int trace_fd;
    char claimed_by[64], action[16]; /* "" for nobody and none */
    bool leave;
    unsigned n_log_calls; /* those that were answered */
    unsigned n_refused;
};

static void trace(const struct service *service, const char *text)
{
    (void)!write(service->trace_fd, text, strlen(text));
}

/* Notes the call and answers it with the scripted error, if it is the one to fail. */
static bool fails(const struct service *service, sd_bus_message *call, sd_bus_error *error)
{
    const char *method = sd_bus_message_get_member(call);
    const struct fake_script *script = service->script;

    trace(service, ";");
    trace(service, method);
    if (!script->fail_method || strcmp(method, script->fail_method) != 0) {
        return false;
    }
    sd_bus_error_set(error, script->fail_error,
                     script->fail_text ? script->fail_text : "the fake says so");
    return true;
}

static int on_claim(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;

    if (fails(service, call, error)) {
        return -EIO;
    }
    if (service->claimed_by[0]) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_ALREADY_IN_USE, "claimed");
    }
    (void)snprintf(service->claimed_by, sizeof service->claimed_by, "%s",
                   sd_bus_message_get_sender(call));
    return sd_bus_reply_method_return(call, NULL);
}

static bool is_claimant(const struct service *service, sd_bus_message *call, sd_bus_error *error)
{
    if (strcmp(service->claimed_by, sd_bus_message_get_sender(call)) == 0) {
        return true;
    }
    sd_bus_error_set(error, ISO_CONTRACT_ERROR_CLAIM_DEVICE, "not claimed by the caller");
    return false;
}

static int on_release(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;

    if (fails(service, call, error) || !is_claimant(service, call, error)) {
        return -EIO;
    }
    service->claimed_by[0] = '\0';
    return sd_bus_reply_method_return(call, NULL);
}

/* To the claimant only, as the daemon does. */
static int send_status(sd_bus *bus, const struct service *service, const struct fake_status *status)
{
    const char *person = status->person ? status->person : "";
    sd_bus_message *signal = NULL;
    char member[32];

    (void)snprintf(member, sizeof member, "%sStatus", service->action);
    int r = sd_bus_message_new_signal(bus, &signal, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE,
                                      member);
    if (r >= 0 && strcmp(service->action, "Enroll") == 0) {
        r = sd_bus_message_append(signal, "sbuuds", status->result, (int)status->done,
                                  status->stage, status->stages, status->value, person);
    } else if (r >= 0) {
        r = sd_bus_message_append(signal, "sbsdd", status->result, (int)status->done, person,
                                  status->value, status->threshold);
    }
    if (r >= 0) {
        r = sd_bus_send_to(bus, signal, service->claimed_by, NULL);
    }
    sd_bus_message_unref(signal);
    return r;
}

static int open_bus(const char *address, sd_bus **bus)
{
    int r = sd_bus_new(bus);

    if (r >= 0) {
        r = sd_bus_set_address(*bus, address);
    }
    if (r >= 0) {
        r = sd_bus_set_bus_client(*bus, 1);
    }
    return r < 0 ? r : sd_bus_start(*bus);
}

static void send_strange_status(const struct service *service)
{
    const struct fake_status status = {.result = service->script->stranger, .done = true};
    const char *name;
    sd_bus *bus = NULL;

    if (open_bus(service->address, &bus) >= 0 && sd_bus_get_unique_name(bus, &name) >= 0) {
        send_status(bus, service, &status);
    }
    sd_bus_flush_close_unref(bus);
}

/* NULL if nobody has this name. */
static const struct fake_person *find_person(const struct service *service, const char *name)
{
    for (size_t i = 0; i < service->script->n_people; i++) {
        if (strcasecmp(name, service->script->people[i].name) == 0) {
            return &service->script->people[i];
        }
    }
    return NULL;
}

/* The answer to a Start method; that of an enrolment says who has the name. */
static int answer_start(const struct service *service, sd_bus_message *call, const char *enrolled)
{
    const struct fake_person *known = enrolled ? find_person(service, enrolled) : NULL;

    if (known) {
        return sd_bus_reply_method_return(call, "a{sv}", 6, "person", "s", known->name, "enrolled",
                                          "x", known->enrolled, "templates", "u", known->templates,
                                          "valid-from", "x", known->valid_from, "valid-until", "x",
                                          known->valid_until, "of-later", "b", 1);
    }
    return enrolled ? sd_bus_reply_method_return(call, "a{sv}", 0)
                    : sd_bus_reply_method_return(call, NULL);
}

/* `enrolled`: who is to be, NULL for the other actions. */
static int start_action(struct service *service, sd_bus_message *call, const char *action,
                        const char *enrolled)
{
    const struct fake_script *script = service->script;
    int r = answer_start(service, call, enrolled);

    (void)snprintf(service->action, sizeof service->action, "%s", action);
    if (script->stranger) {
        send_strange_status(service);
    }
    for (size_t i = 0; r >= 0 && i < script->n_statuses; i++) {
        r = send_status(sd_bus_message_get_bus(call), service, &script->statuses[i]);
    }
    service->leave = script->vanish;
    return r;
}

static int trace_options(const struct service *service, sd_bus_message *call)
{
    const char *name, *type;
    char text[128], container;
    int r = sd_bus_message_enter_container(call, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(call, 'e', "sv")) > 0) {
        int64_t number = 0;
        int boolean = 0;
        r = sd_bus_message_read_basic(call, 's', &name);
        if (r >= 0) {
            r = sd_bus_message_peek_type(call, &container, &type);
        }
        if (r >= 0 && *type == 'b') {
            r = sd_bus_message_read(call, "v", "b", &boolean);
            number = boolean;
        } else if (r >= 0) {
            r = sd_bus_message_read(call, "v", "x", &number);
        }
        if (r >= 0) {
            r = sd_bus_message_exit_container(call);
        }
        (void)snprintf(text, sizeof text, " %s=%" PRId64, r < 0 ? "?" : name, number);
        trace(service, text);
    }
    return r;
}

static int on_enroll_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const char *person;

    if (fails(service, call, error) || !is_claimant(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_read_basic(call, 's', &person);
    if (r < 0) {
        return r;
    }
    trace(service, " ");
    trace(service, person);
    r = trace_options(service, call);
    return r < 0 ? r : start_action(service, call, "Enroll", person);
}

static int on_verify_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const char *person;

    if (fails(service, call, error) || !is_claimant(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read_basic(call, 's', &person);
    if (r < 0) {
        return r;
    }
    trace(service, " ");
    trace(service, person);
    return start_action(service, call, "Verify", NULL);
}

static int on_identify_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;

    if (fails(service, call, error) || !is_claimant(service, call, error)) {
        return -EIO;
    }
    return start_action(service, call, "Identify", NULL);
}

static int on_stop(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const size_t length = strlen(service->action);

    if (fails(service, call, error) || !is_claimant(service, call, error)) {
        return -EIO;
    }
    if (length == 0 || strncmp(sd_bus_message_get_member(call), service->action, length) != 0) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_NO_ACTION, "nothing to stop");
    }
    service->action[0] = '\0';
    return sd_bus_reply_method_return(call, NULL);
}

static int on_list(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    sd_bus_message *reply = NULL;

    if (fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0) {
        r = sd_bus_message_open_container(reply, 'a', "(sxxxu)");
    }
    for (size_t i = 0; r >= 0 && i < service->script->n_people; i++) {
        const struct fake_person *person = &service->script->people[i];
        r = sd_bus_message_append(reply, "(sxxxu)", person->name, person->enrolled,
                                  person->valid_from, person->valid_until, person->templates);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(reply);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

static int no_such_person(sd_bus_error *error, const char *name)
{
    return sd_bus_error_setf(error, ISO_CONTRACT_ERROR_NO_SUCH_PERSON, "%s: no such person", name);
}

static int on_delete(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;
    const char *name;

    if (fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read_basic(call, 's', &name);
    if (r < 0) {
        return r;
    }
    if (!find_person(service, name)) {
        return no_such_person(error, name);
    }
    return sd_bus_reply_method_return(call, NULL);
}

static int on_set_validity(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;
    const char *name;

    if (fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_read_basic(call, 's', &name);
    if (r < 0) {
        return r;
    }
    trace(service, " ");
    trace(service, name);
    r = trace_options(service, call);
    if (r < 0) {
        return r;
    }
    const struct fake_person *known = find_person(service, name);
    if (!known) {
        return no_such_person(error, name);
    }
    return sd_bus_reply_method_return(call, "sxx", known->name, known->valid_from,
                                      known->valid_until);
}

static int on_rename(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;
    const char *name, *to;
    const char *remark = service->script->remark ? service->script->remark : "";

    if (fails(service, call, error)) {
        return -EIO;
    }
    const int r = sd_bus_message_read(call, "ss", &name, &to);
    if (r < 0) {
        return r;
    }
    if (!find_person(service, name)) {
        return no_such_person(error, name);
    }
    return sd_bus_reply_method_return(call, "s", remark);
}

static int on_status(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;
    sd_bus_message *reply = NULL;

    if (fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_message_new_method_return(call, &reply);
    if (r >= 0) {
        r = fake_status_append(reply, service->script);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

static int send_view(sd_bus_message *call, const struct fake_view *view)
{
    sd_bus_message *signal = NULL;
    int r = sd_bus_message_new_signal(sd_bus_message_get_bus(call), &signal, ISO_CONTRACT_PATH,
                                      ISO_CONTRACT_INTERFACE, "View");

    if (r >= 0) {
        r = sd_bus_message_open_container(signal, 'a', "{sv}");
    }
    if (r >= 0) {
        r = sd_bus_message_append(signal, "{sv}", "capture", "s", view->capture);
    }
    if (r >= 0 && !isnan(view->distance_mm)) {
        r = sd_bus_message_append(signal, "{sv}", "distance-mm", "d", view->distance_mm);
    }
    if (r >= 0 && !isnan(view->yaw_deg)) {
        r = sd_bus_message_append(signal, "{sv}", "yaw-deg", "d", view->yaw_deg);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(signal);
    }
    if (r >= 0) {
        r = sd_bus_send_to(sd_bus_message_get_bus(call), signal, sd_bus_message_get_sender(call),
                           NULL);
    }
    sd_bus_message_unref(signal);
    return r;
}

static int on_aim_start(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;

    if (fails(service, call, error)) {
        return -EIO;
    }
    int r = sd_bus_reply_method_return(call, NULL);
    (void)snprintf(service->action, sizeof service->action, "Aim");
    for (size_t i = 0; r >= 0 && i < service->script->n_views; i++) {
        r = send_view(call, &service->script->views[i]);
    }
    service->leave = service->script->vanish;
    return r;
}

/* Needs no claim, but a start. */
static int on_aim_stop(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;

    if (fails(service, call, error)) {
        return -EIO;
    }
    if (strcmp(service->action, "Aim") != 0) {
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_NO_ACTION, "nothing to stop");
    }
    service->action[0] = '\0';
    return sd_bus_reply_method_return(call, NULL);
}

static int on_picture(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const char *bytes = service->script->picture ? service->script->picture : "PNG";

    if (fails(service, call, error) || !is_claimant(service, call, error)) {
        return -EIO;
    }
    const int fd = memfd_create("picture", MFD_CLOEXEC);
    const size_t given = service->script->picture_size, size = given ? given : strlen(bytes);
    const bool made = fd >= 0 && write(fd, bytes, size) == (ssize_t)size;
    const int r = made ? sd_bus_reply_method_return(call, "h", fd) : -EIO;
    if (fd >= 0) {
        close(fd);
    }
    return r;
}

/* Ten minutes lie between two records, every fifth is of the door and not of a visit. */
static void write_record(const struct fake_script *script, uint64_t i, char line[RECORD_SIZE])
{
    const time_t time_s = 1795249215 + (time_t)i * 600; /* 1: 2026-11-21T08:30:15Z */
    char time[32];
    struct tm utc;

    (void)strftime(time, sizeof time, "%Y-%m-%dT%H:%M:%S", gmtime_r(&time_s, &utc));
    (void)snprintf(line, RECORD_SIZE,
                   "{\"sequence\": %" PRIu64 ", \"time\": \"%s.042Z\", \"monotonic_ns\": 1234567, ",
                   i, time);
    const size_t length = strlen(line);
    if (script->last_record && i == script->n_records) {
        (void)snprintf(line + length, RECORD_SIZE - length, "%s}", script->last_record);
    } else if (i % 5 == 0) {
        (void)snprintf(line + length, RECORD_SIZE - length,
                       "\"event\": \"door\", \"note\": \"locked, by \\\"time\\\"\"}");
    } else {
        (void)snprintf(line + length, RECORD_SIZE - length,
                       "\"event\": \"visit\", \"person\": \"%s\", \"verdict\": \"%s\", \"score\": "
                       "2.345678, \"frames\": 3, \"novelty\": true}",
                       i % 2 ? "anna" : "Bo Ek", i % 2 ? "allow" : "deny");
    }
}

static int on_read_log(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const struct fake_script *script = service->script;
    sd_bus_message *reply = NULL;
    uint64_t from;
    uint32_t max;

    if (fails(service, call, error)) {
        return -EIO;
    }
    if (service->n_refused < script->refused) {
        service->n_refused++;
        return sd_bus_error_set(error, ISO_CONTRACT_ERROR_TOO_MANY_CALLS, "the fake says so");
    }
    const uint64_t n = ++service->n_log_calls;
    const uint64_t first = 1 + n * script->records_go;
    const uint64_t last = script->n_records + n * script->records_come;
    int r = sd_bus_message_read(call, "tu", &from, &max);
    from = from < first ? first : from;
    max = max < LOG_RECORDS_MAX ? max : LOG_RECORDS_MAX;
    if (r >= 0) {
        r = sd_bus_message_new_method_return(call, &reply);
    }
    if (r >= 0) {
        r = sd_bus_message_open_container(reply, 'a', "s");
    }
    for (uint64_t i = from; r >= 0 && i <= last && i - from < max; i++) {
        char line[RECORD_SIZE];
        write_record(script, i, line);
        r = sd_bus_message_append_basic(reply, 's', line);
    }
    if (r >= 0) {
        r = sd_bus_message_close_container(reply);
    }
    if (r >= 0) {
        r = sd_bus_send(NULL, reply, NULL);
    }
    sd_bus_message_unref(reply);
    return r;
}

/* The methods that take long; the daemon, too, does nothing else meanwhile. */
static int on_work(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;

    return fails(service, call, error) ? -EIO : fake_work(call, service->script);
}

static const sd_bus_vtable vtable[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("Claim", "", "", on_claim, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("Release", "", "", on_release, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("EnrollStart", "sa{sv}", "a{sv}", on_enroll_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("EnrollStop", "", "", on_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("VerifyStart", "s", "", on_verify_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("VerifyStop", "", "", on_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("IdentifyStart", "", "", on_identify_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("IdentifyStop", "", "", on_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ListPeople", "", "a(sxxxu)", on_list, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("DeletePerson", "s", "", on_delete, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("SetValidity", "sa{sv}", "sxx", on_set_validity, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RenamePerson", "ss", "s", on_rename, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetStatus", "", "a{sv}", on_status, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("AimStart", "", "", on_aim_start, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("AimStop", "", "", on_aim_stop, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("Picture", "", "h", on_picture, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ReadLog", "tu", "as", on_read_log, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("VerifyLog", "ts", "bttsts", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ExportPeople", "hasa{sv}", "u", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ImportPeople", "ha{sv}", "uu", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RotateKeys", "", "s", on_work, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_VTABLE_END,
};

static int serve(struct service *service, int ready_fd)
{
    sd_bus *bus = NULL;
    int r = open_bus(service->address, &bus);

    if (r >= 0) {
        r = sd_bus_add_object_vtable(bus, NULL, ISO_CONTRACT_PATH, ISO_CONTRACT_INTERFACE, vtable,
                                     service);
    }
    if (r >= 0) {
        r = sd_bus_request_name(bus, ISO_CONTRACT_NAME, 0);
    }
    if (r >= 0) {
        r = (int)write(ready_fd, "r", 1);
    }
    while (r >= 0 && !service->leave) {
        r = sd_bus_process(bus, NULL);
        r = r == 0 ? sd_bus_wait(bus, UINT64_MAX) : r;
    }
    sd_bus_flush_close_unref(bus);
    return r;
}

void fake_daemon_start(struct fake_daemon *daemon, const char *address,
                       const struct fake_script *script)
{
    int ready[2], calls[2];
    char byte;

    assert_int_equal(pipe(ready), 0);
    assert_int_equal(pipe(calls), 0);
    daemon->pid = fork();
    assert_true(daemon->pid >= 0);
    if (daemon->pid == 0) {
        struct service service = {.script = script, .address = address, .trace_fd = calls[1]};
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ready[0]);
        close(calls[0]);
        _exit(serve(&service, ready[1]) < 0);
    }
    close(ready[1]);
    close(calls[1]);
    daemon->trace_fd = calls[0];
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
}

const char *fake_daemon_stop(struct fake_daemon *daemon)
{
    static char calls[4096];
    size_t length = 0;
    ssize_t n;

    kill(daemon->pid, SIGTERM);
    waitpid(daemon->pid, NULL, 0);
    while ((n = read(daemon->trace_fd, calls + length, sizeof calls - 1 - length)) > 0) {
        length += (size_t)n;
    }
    close(daemon->trace_fd);
    calls[length] = '\0';
    return length ? calls + 1 : calls;
}
