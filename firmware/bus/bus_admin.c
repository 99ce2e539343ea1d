/* The methods of an administrator: copying people from door to door, changing keys, and checking
 * the log. */
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"

/* The options of ExportPeople and ImportPeople. The texts point into the call. */
struct options {
    const char *to, *from;
    bool has_key, has_salt, replace;
    struct iso_seal_key key;
    uint8_t salt[ISO_TRANSFER_SALT_BYTES];
};

static int invalid_argument(sd_bus_error *out, const char *what, const char *name)
{
    return sd_bus_error_setf(out, ISO_CONTRACT_ERROR_INVALID_ARGUMENT, "%s '%s'", what, name);
}

/* Reads a variant of exactly `size` bytes. */
static int read_bytes(sd_bus_message *call, void *to, size_t size, bool *has)
{
    const void *bytes = NULL;
    size_t got = 0;
    int r = sd_bus_message_enter_container(call, 'v', "ay");
    if (r >= 0) {
        r = sd_bus_message_read_array(call, 'y', &bytes, &got);
    }
    if (r >= 0) {
        r = sd_bus_message_exit_container(call);
    }
    if (r < 0) {
        return r;
    }
    if (got != size) {
        return -ENXIO;
    }
    memcpy(to, bytes, size);
    *has = true;
    return 0;
}

static int read_option(sd_bus_message *call, struct options *options, sd_bus_error *out)
{
    const char *name;
    int flag = 0;
    int r = sd_bus_message_read_basic(call, 's', &name);
    if (r < 0) {
        return r;
    }
    if (strcmp(name, ISO_CONTRACT_TO) == 0) {
        r = sd_bus_message_read(call, "v", "s", &options->to);
    } else if (strcmp(name, ISO_CONTRACT_FROM) == 0) {
        r = sd_bus_message_read(call, "v", "s", &options->from);
    } else if (strcmp(name, ISO_CONTRACT_KEY) == 0) {
        r = read_bytes(call, options->key.bytes, sizeof options->key.bytes, &options->has_key);
    } else if (strcmp(name, ISO_CONTRACT_SALT) == 0) {
        r = read_bytes(call, options->salt, sizeof options->salt, &options->has_salt);
    } else if (strcmp(name, ISO_CONTRACT_REPLACE) == 0) {
        r = sd_bus_message_read(call, "v", "b", &flag);
        options->replace = flag != 0;
    } else {
        return invalid_argument(out, "unknown option", name);
    }
    return r == -ENXIO ? invalid_argument(out, "wrong type or size of option", name) : r;
}

static int read_options(sd_bus_message *call, struct options *options, sd_bus_error *out)
{
    int r = sd_bus_message_enter_container(call, 'a', "{sv}");
    while (r >= 0 && (r = sd_bus_message_enter_container(call, 'e', "sv")) > 0) {
        r = read_option(call, options, out);
        if (r >= 0) {
            r = sd_bus_message_exit_container(call);
        }
    }
    return r;
}

int iso__bus_export(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct options options = {.to = NULL};
    struct iso_fault fault = {.text = ""};
    char **people = NULL;
    size_t n = 0;
    int fd = -1;
    (void)sd_bus_message_sensitive(call);
    int r = sd_bus_message_read(call, "h", &fd);
    if (r >= 0) {
        r = sd_bus_message_read_strv(call, &people);
    }
    if (r >= 0) {
        r = read_options(call, &options, out);
    }
    if (r >= 0 && !options.to && !(options.has_key && options.has_salt)) {
        r = invalid_argument(out, "missing option",
                             options.has_key ? ISO_CONTRACT_SALT : ISO_CONTRACT_KEY);
    }
    if (r >= 0) {
        struct iso_transfer_lock lock = {.address = options.to, .key = options.key};
        struct iso__bus_progress progress;
        const struct iso_work_listener listener = iso__bus_report_progress(&progress, bus, call);
        memcpy(lock.salt, options.salt, sizeof lock.salt);
        r = iso_appliance_export(bus->appliance, fd, (const char *const *)people, &lock, &listener,
                                 &n, &fault);
        r = r < 0 ? iso__bus_refuse(out, r, &fault)
                  : sd_bus_reply_method_return(call, "u", (uint32_t)n);
        sodium_memzero(&lock, sizeof lock);
    }
    for (char **person = people; person && *person; person++) {
        free(*person);
    }
    free(people);
    sodium_memzero(&options, sizeof options);
    return r;
}

int iso__bus_import(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct options options = {.to = NULL};
    struct iso_fault fault = {.text = ""};
    size_t added = 0, known = 0;
    int fd = -1;
    (void)sd_bus_message_sensitive(call);
    int r = sd_bus_message_read(call, "h", &fd);
    if (r >= 0) {
        r = read_options(call, &options, out);
    }
    if (r >= 0) {
        struct iso__bus_progress progress;
        const struct iso_work_listener listener = iso__bus_report_progress(&progress, bus, call);
        const struct iso_import_request request = {.fd = fd,
                                                   .key = options.has_key ? &options.key : NULL,
                                                   .sender = options.from,
                                                   .replace = options.replace,
                                                   .listener = &listener};
        r = iso_appliance_import(bus->appliance, &request, &added, &known, &fault);
        r = r < 0 ? iso__bus_refuse(out, r, &fault)
                  : sd_bus_reply_method_return(call, "uu", (uint32_t)added, (uint32_t)known);
    }
    sodium_memzero(&options, sizeof options);
    return r;
}

int iso__bus_rotate_keys(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const char *remark = "";
    struct iso__bus_progress progress;
    const struct iso_work_listener listener = iso__bus_report_progress(&progress, bus, call);
    const int r = iso_appliance_rotate_keys(bus->appliance, &listener, &remark, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, "s", remark);
}

int iso__bus_test_door(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const int r = iso_appliance_test_door(bus->appliance, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

int iso__bus_install_panel(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_fault fault = {.text = ""};
    const int r = iso_appliance_install_panel(bus->appliance, &fault);
    return r < 0 ? iso__bus_refuse(out, r, &fault) : sd_bus_reply_method_return(call, NULL);
}

int iso__bus_get_address(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    char address[ISO_TRANSFER_ADDRESS_SIZE];
    (void)out;
    iso_transfer_address(bus->borrowed->ring, address);
    return sd_bus_reply_method_return(call, "s", address);
}

int iso__bus_verify_log(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const struct iso_bus *bus = context;
    struct iso_audit_writer *log = iso_appliance_log(bus->appliance);
    struct iso_audit_report report;
    struct iso_fault fault = {.text = ""};
    uint64_t sequence;
    const char *head;
    struct iso__bus_progress progress;
    const struct iso_work_listener listener = iso__bus_report_progress(&progress, bus, call);
    int r = sd_bus_message_read(call, "ts", &sequence, &head);
    if (r < 0) {
        return r;
    }
    r = iso_audit_verify(iso_audit_writer_hold(log), sequence, *head ? head : NULL, &listener,
                         &report, &fault);
    iso_audit_writer_release(log);
    if (r < 0) {
        return iso__bus_refuse(out, r, &fault);
    }
    return sd_bus_reply_method_return(call, "bttsts", report.sound, report.first, report.last,
                                      report.head, report.flaw_at, report.flaw);
}
