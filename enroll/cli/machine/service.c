#include "enroll/cli/machine/service.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/machine/interrupt.h"

#define MANAGER           "org.freedesktop.systemd1"
#define MANAGER_PATH      "/org/freedesktop/systemd1"
#define MANAGER_INTERFACE "org.freedesktop.systemd1.Manager"
#define UNIT_INTERFACE    "org.freedesktop.systemd1.Unit"

/* The unit itself may need 60 seconds to start, and as many to stop. */
enum { PATIENCE_S = 130, SLICE_US = 200 * 1000 };

struct cli_service {
    sd_bus *bus;
    const char *unit;
    bool was_active, was_enabled;
    char job[128];   /* the job that the client waits for */
    char result[32]; /* how the job ended; "" if it has not */
};

static enum cli_exit refuse_service(struct cli_fault *fault, const struct cli_service *service,
                                    const char *what, int error, const sd_bus_error *said)
{
    return cli_fault_set(fault, CLI_EXIT_FAULT, "no-start", "%s cannot be %s: %s", service->unit,
                         what, said && said->message ? said->message : strerror(-error));
}

/* ---- connection ---- */

static int on_job_removed(sd_bus_message *signal, void *context, sd_bus_error *error)
{
    struct cli_service *service = context;
    const char *path, *unit, *result;
    uint32_t id;

    (void)error;
    if (sd_bus_message_read(signal, "uoss", &id, &path, &unit, &result) >= 0 &&
        strcmp(path, service->job) == 0) {
        (void)snprintf(service->result, sizeof service->result, "%s", result);
    }
    return 0;
}

static int call_manager(struct cli_service *service, const char *method, sd_bus_error *error,
                        sd_bus_message **reply, const char *word)
{
    return word ? sd_bus_call_method(service->bus, MANAGER, MANAGER_PATH, MANAGER_INTERFACE, method,
                                     error, reply, "s", word)
                : sd_bus_call_method(service->bus, MANAGER, MANAGER_PATH, MANAGER_INTERFACE, method,
                                     error, reply, "");
}

static int look_if_active(struct cli_service *service, sd_bus_error *error)
{
    sd_bus_message *reply = NULL;
    const char *path;
    char *state = NULL;
    int r = call_manager(service, "LoadUnit", error, &reply, service->unit);

    if (r >= 0) {
        r = sd_bus_message_read(reply, "o", &path);
    }
    if (r >= 0) {
        r = sd_bus_get_property_string(service->bus, MANAGER, path, UNIT_INTERFACE, "ActiveState",
                                       error, &state);
    }
    if (r >= 0) {
        service->was_active = strcmp(state, "active") == 0 || strcmp(state, "activating") == 0 ||
                              strcmp(state, "reloading") == 0;
    }
    free(state);
    sd_bus_message_unref(reply);
    return r;
}

static int look_if_enabled(struct cli_service *service, sd_bus_error *error)
{
    sd_bus_message *reply = NULL;
    const char *state;
    int r = call_manager(service, "GetUnitFileState", error, &reply, service->unit);

    if (r >= 0) {
        r = sd_bus_message_read(reply, "s", &state);
    }
    if (r >= 0) {
        service->was_enabled = strncmp(state, "enabled", 7) == 0;
    }
    sd_bus_message_unref(reply);
    return r;
}

static enum cli_exit look_at_unit(struct cli_service *service, struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r = call_manager(service, "Subscribe", &error, NULL, NULL);

    if (r >= 0) {
        r = sd_bus_match_signal(service->bus, NULL, MANAGER, MANAGER_PATH, MANAGER_INTERFACE,
                                "JobRemoved", on_job_removed, service);
    }
    if (r < 0) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-manager",
                             "systemd cannot be asked to start the service: %s",
                             error.message ? error.message : strerror(-r));
    } else if ((r = look_if_enabled(service, &error)) < 0 ||
               (r = look_if_active(service, &error)) < 0) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-unit", "%s is not known to systemd: %s",
                             service->unit, error.message ? error.message : strerror(-r));
    }
    sd_bus_error_free(&error);
    return exit;
}

enum cli_exit cli_service_open(const struct cli_bus *bus, const char *unit,
                               struct cli_service **out, struct cli_fault *fault)
{
    struct cli_service *service = calloc(1, sizeof *service);
    const int r = service ? cli_bus_connect(bus, &service->bus) : -ENOMEM;
    enum cli_exit exit;

    if (r < 0) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-manager",
                             "systemd cannot be asked to start the service: the bus: %s",
                             strerror(-r));
    } else {
        service->unit = unit;
        exit = look_at_unit(service, fault);
    }
    if (exit) {
        cli_service_close(service);
        return exit;
    }
    *out = service;
    return CLI_EXIT_OK;
}

void cli_service_close(struct cli_service *service)
{
    if (service) {
        sd_bus_flush_close_unref(service->bus);
        free(service);
    }
}

/* ---- jobs ---- */

static int64_t now_s(void)
{
    struct timespec now;

    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec;
}

/* Waits until the job is removed. Returns 0, -ETIMEDOUT, -EINTR, or the error of the bus. */
static int wait_for_job(struct cli_service *service, bool may_interrupt)
{
    const int64_t deadline_s = now_s() + PATIENCE_S;

    while (!service->result[0]) {
        if (may_interrupt && cli_interrupted()) {
            return -EINTR;
        }
        if (now_s() >= deadline_s) {
            return -ETIMEDOUT;
        }
        int r = sd_bus_process(service->bus, NULL);
        r = r == 0 ? sd_bus_wait(service->bus, SLICE_US) : r;
        if (r < 0 && r != -EINTR) {
            return r;
        }
    }
    return 0;
}

/* Calls RestartUnit or StopUnit, and waits for the end of the job. */
static int run_job(struct cli_service *service, const char *method, bool may_interrupt,
                   sd_bus_error *error)
{
    sd_bus_message *reply = NULL;
    const char *path;
    int r = sd_bus_call_method(service->bus, MANAGER, MANAGER_PATH, MANAGER_INTERFACE, method,
                               error, &reply, "ss", service->unit, "replace");

    if (r >= 0) {
        r = sd_bus_message_read(reply, "o", &path);
    }
    if (r >= 0) {
        (void)snprintf(service->job, sizeof service->job, "%s", path);
        service->result[0] = '\0';
    }
    sd_bus_message_unref(reply);
    return r < 0 ? r : wait_for_job(service, may_interrupt);
}

/* Calls EnableUnitFiles or DisableUnitFiles, and does what `systemctl` does after it. */
static int set_enabled(struct cli_service *service, bool enabled, sd_bus_error *error)
{
    const int r = enabled ? sd_bus_call_method(service->bus, MANAGER, MANAGER_PATH,
                                               MANAGER_INTERFACE, "EnableUnitFiles", error, NULL,
                                               "asbb", 1, service->unit, 0, 0)
                          : sd_bus_call_method(service->bus, MANAGER, MANAGER_PATH,
                                               MANAGER_INTERFACE, "DisableUnitFiles", error, NULL,
                                               "asb", 1, service->unit, 0);
    return r < 0 ? r : call_manager(service, "Reload", error, NULL, NULL);
}

/* A unit that has failed too often would not be started again. Resetting a unit that has not failed
 * is not an error. */
static void forget_failures(struct cli_service *service)
{
    sd_bus_error ignored = SD_BUS_ERROR_NULL;

    (void)call_manager(service, "ResetFailedUnit", &ignored, NULL, service->unit);
    sd_bus_error_free(&ignored);
}

enum cli_exit cli_service_start(struct cli_service *service, struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r = service->was_enabled ? 0 : set_enabled(service, true, &error);

    if (r < 0) {
        exit = refuse_service(fault, service, "enabled", r, &error);
    } else {
        forget_failures(service);
        r = run_job(service, "RestartUnit", true, &error);
        if (r == -EINTR) {
            exit = CLI_EXIT_INTERRUPTED;
        } else if (r < 0) {
            exit = refuse_service(fault, service, "started", r, &error);
        }
    }
    if (!exit && strcmp(service->result, "done") != 0) {
        exit = cli_fault_set(fault, CLI_EXIT_FAULT, "no-start",
                             "%s did not start (%s); journalctl --unit=%s says why", service->unit,
                             service->result, service->unit);
    }
    sd_bus_error_free(&error);
    return exit;
}

enum cli_exit cli_service_undo(struct cli_service *service, struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r;

    forget_failures(service);
    r = run_job(service, service->was_active ? "RestartUnit" : "StopUnit", false, &error);
    if (r >= 0 && !service->was_enabled) {
        r = set_enabled(service, false, &error);
    }
    if (r < 0) {
        exit = refuse_service(fault, service, "brought back to what it was", r, &error);
    }
    sd_bus_error_free(&error);
    return exit;
}
