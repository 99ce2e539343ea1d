#include "tests/enroll/rigs/fake_rauc.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <signal.h>
#include <stdio.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <systemd/sd-bus.h>
#include <unistd.h>

#define INTERFACE "de.pengutronix.rauc.Installer"

enum { HELD_US = 50 * 1000 };

const char fake_rauc_board[] = "isotherm-test-amd64";

struct service {
    const struct fake_rauc_script *script;
    int trace_fd;
    bool asked, installing, finishing, installed;
    int32_t percent;
    const char *error;
};

static void trace_call(const struct service *service, const char *method, const char *word)
{
    (void)!dprintf(service->trace_fd, "%s %s;", method, word);
}

/* The name and the text of an error of RAUC's main loop. */
static int refuse(sd_bus_error *error, const char *text)
{
    return sd_bus_error_set(error,
                            "org.gtk.GDBus.UnmappedGError.Quark._g_2dio_2derror_2dquark."
                            "Code30",
                            text);
}

static int on_info(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const char *path, *board = service->script->board ? service->script->board : fake_rauc_board;
    int r = sd_bus_message_read(call, "s", &path);

    if (r < 0) {
        return r;
    }
    trace_call(service, "Info", path);
    service->installing = service->installing || service->script->overtaken;
    if (service->script->mute) {
        return sd_bus_error_set(error, SD_BUS_ERROR_NO_REPLY, "no reply");
    }
    return service->script->foreign_key || service->installing
               ? refuse(error, "rauc info error")
               : sd_bus_reply_method_return(call, "ss", board, "2.0.0");
}

static int on_install(sd_bus_message *call, void *context, sd_bus_error *error)
{
    struct service *service = context;
    const char *path;
    int r = sd_bus_message_read(call, "s", &path);

    if (r < 0) {
        return r;
    }
    trace_call(service, "InstallBundle", path);
    if (service->installing) {
        return refuse(error, "Already processing a different method");
    }
    service->installing = service->asked = true;
    service->error = "";
    return sd_bus_reply_method_return(call, "");
}

static int append_text(sd_bus_message *reply, const char *key, const char *text)
{
    return sd_bus_message_append(reply, "{sv}", key, "s", text);
}

/* One slot and the part of it that has no name in the boot loader. */
static int append_slot(sd_bus_message *reply, const char *name, const char *boot_name,
                       const char *state, bool good, const char *version)
{
    int r = sd_bus_message_open_container(reply, 'r', "sa{sv}");
    r = r < 0 ? r : sd_bus_message_append(reply, "s", name);
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "{sv}");
    r = r < 0 ? r : append_text(reply, "type", "raw");
    r = r < 0 ? r : sd_bus_message_append(reply, "{sv}", "installed.count", "u", 3);
    r = r < 0 ? r : append_text(reply, "state", state);
    if (r >= 0 && boot_name) {
        r = append_text(reply, "bootname", boot_name);
        r = r < 0 ? r : append_text(reply, "boot-status", good ? "good" : "bad");
    }
    if (r >= 0 && version) {
        r = append_text(reply, "bundle.version", version);
    }
    r = r < 0 ? r : sd_bus_message_close_container(reply);
    return r < 0 ? r : sd_bus_message_close_container(reply);
}

static int on_slots(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;
    const bool spare_is_good = service->installed || !service->script->spare_is_bad;
    const char *version = service->installed ? "2.0.0" : NULL;
    sd_bus_message *reply = NULL;
    int r;

    if (service->installing) {
        return refuse(error, "already processing a different method");
    }
    r = sd_bus_message_new_method_return(call, &reply);
    r = r < 0 ? r : sd_bus_message_open_container(reply, 'a', "(sa{sv})");
    r = r < 0 ? r : append_slot(reply, "verity.1", NULL, "inactive", false, version);
    r = r < 0 ? r : append_slot(reply, "root.1", "b", "inactive", spare_is_good, version);
    r = r < 0 ? r : append_slot(reply, "verity.0", NULL, "active", false, NULL);
    r = r < 0 ? r : append_slot(reply, "root.0", "a", "booted", true, NULL);
    r = r < 0 ? r : sd_bus_message_close_container(reply);
    r = r < 0 ? r : sd_bus_send(NULL, reply, NULL);
    sd_bus_message_unref(reply);
    return r;
}

static int on_primary(sd_bus_message *call, void *context, sd_bus_error *error)
{
    const struct service *service = context;

    (void)error;
    return sd_bus_reply_method_return(call, "s", service->installed ? "root.1" : "root.0");
}

static int get_property(sd_bus *bus, const char *path, const char *interface, const char *property,
                        sd_bus_message *reply, void *context, sd_bus_error *error)
{
    const struct service *service = context;

    (void)bus, (void)path, (void)interface, (void)error;
    if (strcmp(property, "Progress") == 0) {
        return sd_bus_message_append(reply, "(isi)", service->percent, "Copying image", 2);
    }
    const char *text = strcmp(property, "Operation") == 0
                           ? (service->installing ? "installing" : "idle")
                       : strcmp(property, "Compatible") == 0 ? fake_rauc_board
                       : strcmp(property, "LastError") == 0  ? service->error
                                                             : "a";
    return sd_bus_message_append(reply, "s", text);
}

#define CHANGES SD_BUS_VTABLE_PROPERTY_EMITS_CHANGE
static const sd_bus_vtable vtable[] = {
    SD_BUS_VTABLE_START(0),
    SD_BUS_METHOD("InstallBundle", "sa{sv}", "", on_install, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("Info", "s", "ss", on_info, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetSlotStatus", "", "a(sa{sv})", on_slots, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_METHOD("GetPrimary", "", "s", on_primary, SD_BUS_VTABLE_UNPRIVILEGED),
    SD_BUS_PROPERTY("Operation", "s", get_property, 0, CHANGES),
    SD_BUS_PROPERTY("LastError", "s", get_property, 0, CHANGES),
    SD_BUS_PROPERTY("Progress", "(isi)", get_property, 0, CHANGES),
    SD_BUS_PROPERTY("Compatible", "s", get_property, 0, 0),
    SD_BUS_PROPERTY("Variant", "s", get_property, 0, 0),
    SD_BUS_PROPERTY("BootSlot", "s", get_property, 0, 0),
    SD_BUS_SIGNAL("Completed", "i", 0),
    SD_BUS_VTABLE_END,
};

static int report(sd_bus *bus, struct service *service, int32_t percent)
{
    service->percent = percent;
    return sd_bus_emit_properties_changed(bus, "/", INTERFACE, "Progress", NULL);
}

/* Begins to install: reports each step. */
static int install(sd_bus *bus, struct service *service)
{
    const struct fake_rauc_script *script = service->script;
    int r = sd_bus_emit_properties_changed(bus, "/", INTERFACE, "Operation", NULL);

    for (int32_t percent = 0; r >= 0 && percent <= 40; percent += 20) {
        r = report(bus, service, percent);
    }
    service->finishing = script->end == FAKE_RAUC_COMPLETES;
    return script->end == FAKE_RAUC_DIES ? -1 : r;
}

/* Ends an installation as the script says. */
static int finish(sd_bus *bus, struct service *service)
{
    const struct fake_rauc_script *script = service->script;
    int r;

    service->finishing = false;
    service->error = script->error ? script->error : "";
    service->installed = !script->error;
    r = report(bus, service, 100);
    r = r < 0 ? r : sd_bus_emit_properties_changed(bus, "/", INTERFACE, "LastError", NULL);
    r = r < 0 ? r
              : sd_bus_emit_signal(bus, "/", INTERFACE, "Completed", "i", script->error != NULL);
    service->installing = false;
    return r < 0 ? r : sd_bus_emit_properties_changed(bus, "/", INTERFACE, "Operation", NULL);
}

static int connect_service(struct service *service, const char *address, sd_bus **bus)
{
    int r = sd_bus_new(bus);
    r = r < 0 ? r : sd_bus_set_address(*bus, address);
    r = r < 0 ? r : sd_bus_set_bus_client(*bus, 1);
    r = r < 0 ? r : sd_bus_start(*bus);
    r = r < 0 ? r : sd_bus_add_object_vtable(*bus, NULL, "/", INTERFACE, vtable, service);
    return r < 0 ? r : sd_bus_request_name(*bus, "de.pengutronix.rauc", 0);
}

static bool is_held(const struct service *service)
{
    return service->script->hold && access(service->script->hold, F_OK) == 0;
}

static int serve(struct service *service, const char *address, int ready_fd)
{
    sd_bus *bus = NULL;
    int r = connect_service(service, address, &bus);

    if (r >= 0) {
        r = (int)write(ready_fd, "r", 1);
    }
    while (r >= 0) {
        r = sd_bus_process(bus, NULL);
        if (r == 0 && service->asked) {
            service->asked = false;
            r = install(bus, service);
        } else if (r == 0 && service->finishing && !is_held(service)) {
            r = finish(bus, service);
        } else if (r == 0) {
            r = sd_bus_wait(bus, service->finishing ? HELD_US : UINT64_MAX);
        }
    }
    sd_bus_flush_close_unref(bus);
    return r;
}

static struct service service_of(const struct fake_rauc_script *script, int trace_fd)
{
    return (struct service){.script = script,
                            .trace_fd = trace_fd,
                            .installing = script->busy,
                            .installed = script->installed,
                            .percent = script->busy ? 40 : 0,
                            .error = ""};
}

int fake_rauc_serve(const char *address, const struct fake_rauc_script *script, int ready_fd)
{
    struct service service = service_of(script, STDERR_FILENO);

    return serve(&service, address, ready_fd);
}

void fake_rauc_start(struct fake_rauc *rauc, const char *address,
                     const struct fake_rauc_script *script)
{
    int ready[2], traced[2];
    char byte;

    assert_int_equal(pipe(ready), 0);
    assert_int_equal(pipe(traced), 0);
    rauc->pid = fork();
    assert_true(rauc->pid >= 0);
    if (rauc->pid == 0) {
        struct service service = service_of(script, traced[1]);
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        close(ready[0]);
        close(traced[0]);
        _exit(serve(&service, address, ready[1]) < 0);
    }
    close(ready[1]);
    close(traced[1]);
    rauc->trace_fd = traced[0];
    assert_int_equal(read(ready[0], &byte, 1), 1);
    close(ready[0]);
}

const char *fake_rauc_stop(struct fake_rauc *rauc)
{
    static char asked[4096];
    size_t size = 0;
    ssize_t n;

    kill(rauc->pid, SIGTERM);
    waitpid(rauc->pid, NULL, 0);
    while ((n = read(rauc->trace_fd, asked + size, sizeof asked - 1 - size)) > 0) {
        size += (size_t)n;
    }
    asked[size] = '\0';
    close(rauc->trace_fd);
    return asked;
}
