#include "tests/enroll/rigs/fake_manager.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#define MANAGER_PATH "/org/freedesktop/systemd1"
#define UNIT_PATH    MANAGER_PATH "/unit/isothermd_2eservice"
#define MANAGER      "org.freedesktop.systemd1.Manager"

struct service {
    const struct fake_manager_script *script;
    int trace_fd;
    unsigned n_jobs;
};

/* The part of the trace that was read so far. */
static char calls[64 * 1024];
static size_t n_calls;

static void trace_call(const struct service *service, const char *text)
{
    (void)!write(service->trace_fd, text, strlen(text));
}

static bool fails_call(const struct service *service, sd_bus_message *call, sd_bus_error *error)
{
    const char *method = sd_bus_message_get_member(call);

    trace_call(service, method);
    trace_call(service, ";");
    if (!service->script->fail_method || strcmp(method, service->script->fail_method) != 0) {
        return false;
    }
    sd_bus_error_set(error, SD_BUS_ERROR_FAILED, "the fake says so");
    return true;
}

static int on_nothing(sd_bus_message *call, void *context, sd_bus_error *error)
{
    return fails_call(context, call, error) ? -EIO : sd_bus_reply_method_return(call, NULL);
}

static int on_load(sd_bus_message *call, void *context, sd_bus_error *error)
{
    return fails_call(context, call, error) ? -EIO
                                            : sd_bus_reply_method_return(call, "o", UNIT_PATH);
}

static int on_file_state(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;

    return fails_call(service, call, error)
               ? -EIO
               : sd_bus_reply_method_return(call, "s",
                                            service->script->enabled ? "enabled" : "disabled");
}

static int on_enable(sd_bus_message *call, void *context, sd_bus_error *error)
{
    return fails_call(context, call, error) ? -EIO
                                            : sd_bus_reply_method_return(call, "ba(sss)", 1, 0);
}

static int on_disable(sd_bus_message *call, void *context, sd_bus_error *error)
{
    return fails_call(context, call, error) ? -EIO : sd_bus_reply_method_return(call, "a(sss)", 0);
}

static void trace_file(const struct service *service)
{
    char text[4096];
    FILE *file = service->script->started ? fopen(service->script->started, "r") : NULL;

    trace_call(service, "<");
    if (file) {
        text[fread(text, 1, sizeof text - 1, file)] = '\0';
        trace_call(service, text);
        fclose(file);
    }
    trace_call(service, ">;");
}

/* Only the first job follows the script. Later jobs, which restore the previous state, succeed. */
static int on_job(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    char path[64];

    if (fails_call(service, call, error)) {
        return -EIO;
    }
    const char *scripted = service->n_jobs == 0 ? service->script->result : NULL;
    const char *result = scripted ? scripted : "done";
    trace_file(service);
    (void)snprintf(path, sizeof path, MANAGER_PATH "/job/%u", ++service->n_jobs);
    int r = sd_bus_reply_method_return(call, "o", path);
    if (r >= 0 && *result) {
        r = sd_bus_emit_signal(sd_bus_message_get_bus(call), MANAGER_PATH, MANAGER, "JobRemoved",
                               "uoss", service->n_jobs + 100, MANAGER_PATH "/job/99",
                               "other.service", "failed");
        if (r >= 0) {
            r = sd_bus_emit_signal(sd_bus_message_get_bus(call), MANAGER_PATH, MANAGER,
                                   "JobRemoved", "uoss", service->n_jobs, path, "isothermd.service",
                                   result);
        }
    }
    return r;
}

static int get_active(sd_bus *bus, const char *path, const char *interface, const char *property,
                      sd_bus_message *reply, void *context, sd_bus_error *error)
{
    const struct service *service = context;

    (void)bus, (void)path, (void)interface, (void)property, (void)error;
    return sd_bus_message_append(reply, "s", service->script->active ? "active" : "inactive");
}

static const sd_bus_vtable manager_vtable[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("Subscribe", "", "", on_nothing, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("Reload", "", "", on_nothing, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("ResetFailedUnit", "s", "", on_nothing, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("LoadUnit", "s", "o", on_load, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetUnitFileState", "s", "s", on_file_state, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("EnableUnitFiles", "asbb", "ba(sss)", on_enable, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("DisableUnitFiles", "asb", "a(sss)", on_disable, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("RestartUnit", "ss", "o", on_job, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("StopUnit", "ss", "o", on_job, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_SIGNAL("JobRemoved", "uoss", 0),
    SD_BUS_VTABLE_END,
};

static const sd_bus_vtable unit_vtable[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_PROPERTY("ActiveState", "s", get_active, 0, 0),
    SD_BUS_VTABLE_END,
};

static int serve_bus(struct service *service, const char *address, int ready_fd)
{
    sd_bus *bus = NULL;
    int r = sd_bus_new(&bus);

    if (r >= 0) {
        r = sd_bus_set_address(bus, address);
    }
    if (r >= 0) {
        r = sd_bus_set_bus_client(bus, 1);
    }
    if (r >= 0) {
        r = sd_bus_start(bus);
    }
    if (r >= 0) {
        r = sd_bus_add_object_vtable(bus, NULL, MANAGER_PATH, MANAGER, manager_vtable, service);
    }
    if (r >= 0) {
        r = sd_bus_add_object_vtable(bus, NULL, UNIT_PATH, "org.freedesktop.systemd1.Unit",
                                     unit_vtable, service);
    }
    if (r >= 0) {
        r = sd_bus_request_name(bus, "org.freedesktop.systemd1", 0);
    }
    if (r >= 0) {
        r = (int)write(ready_fd, "r", 1);
    }
    while (r >= 0) {
        r = sd_bus_process(bus, NULL);
        r = r == 0 ? sd_bus_wait(bus, UINT64_MAX) : r;
    }
    sd_bus_flush_close_unref(bus);
    return r;
}

void fake_manager_start(struct fake_manager *manager, const char *address,
                        const struct fake_manager_script *script)
{
    int ready[2], traced[2];
    char byte;

    assert_int_equal(pipe(ready), 0);
    assert_int_equal(pipe(traced), 0);
    n_calls = 0;
    calls[0] = '\0';
    manager->pid = fork();
    assert_true(manager->pid >= 0);
    if (manager->pid == 0) {
        struct service service = {.script = script, .trace_fd = traced[1]};
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ready[0]);
        close(traced[0]);
        _exit(serve_bus(&service, address, ready[1]) < 0);
    }
    close(ready[1]);
    close(traced[1]);
    manager->trace_fd = traced[0];
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
}

static bool take_trace(struct fake_manager *manager)
{
    const ssize_t n = read(manager->trace_fd, calls + n_calls, sizeof calls - 1 - n_calls);

    n_calls += n > 0 ? (size_t)n : 0;
    calls[n_calls] = '\0';
    return n > 0;
}

void fake_manager_wait_for_start(struct fake_manager *manager)
{
    while (!strstr(calls, "RestartUnit")) {
        struct pollfd waiting = {.fd = manager->trace_fd, .events = POLLIN};
        assert_int_equal(poll(&waiting, 1, 60 * 1000), 1);
        assert_true(take_trace(manager));
    }
}

const char *fake_manager_stop(struct fake_manager *manager)
{
    kill(manager->pid, SIGTERM);
    waitpid(manager->pid, NULL, 0);
    while (take_trace(manager)) {
    }
    close(manager->trace_fd);
    return calls;
}
