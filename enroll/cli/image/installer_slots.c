/* The slots of the image, as RAUC reports them. */
#include "enroll/cli/image/installer.h"

#include <stdio.h>
#include <string.h>

#include "enroll/cli/image/installer_inner.h"

/* Reads one entry of the description of a slot. Entries that are not texts are left out. */
static int read_entry(sd_bus_message *reply, struct cli_slot *slot)
{
    const char *key, *contents, *text;
    int r = sd_bus_message_read_basic(reply, 's', &key);

    if (r >= 0) {
        r = sd_bus_message_peek_type(reply, NULL, &contents);
    }
    if (r < 0 || strcmp(contents, "s") != 0) {
        return r < 0 ? r : sd_bus_message_skip(reply, "v");
    }
    r = sd_bus_message_read(reply, "v", "s", &text);
    if (r >= 0 && strcmp(key, "bootname") == 0) {
        (void)snprintf(slot->name, sizeof slot->name, "%s", text);
    } else if (r >= 0 && strcmp(key, "bundle.version") == 0) {
        (void)snprintf(slot->version, sizeof slot->version, "%s", text);
    } else if (r >= 0 && strcmp(key, "state") == 0) {
        slot->running = strcmp(text, "booted") == 0;
    } else if (r >= 0 && strcmp(key, "boot-status") == 0) {
        slot->good = strcmp(text, "good") == 0;
    }
    return r;
}

static int read_slot(sd_bus_message *reply, struct cli_slot *slot)
{
    const char *name;
    int r = sd_bus_message_read_basic(reply, 's', &name);

    if (r >= 0) {
        (void)snprintf(slot->rauc_name, sizeof slot->rauc_name, "%s", name);
        r = sd_bus_message_enter_container(reply, 'a', "{sv}");
    }
    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'e', "sv")) > 0) {
        r = read_entry(reply, slot);
        if (r >= 0) {
            r = sd_bus_message_exit_container(reply);
        }
    }
    return r < 0 ? r : sd_bus_message_exit_container(reply);
}

/* Keeps the slots that have a name in the boot loader: the others are parts of them. */
static int read_slots(sd_bus_message *reply, struct cli_slots *out)
{
    int r = sd_bus_message_enter_container(reply, 'a', "(sa{sv})");

    while (r >= 0 && (r = sd_bus_message_enter_container(reply, 'r', "sa{sv}")) > 0) {
        struct cli_slot slot = {.name = ""};
        r = read_slot(reply, &slot);
        if (r >= 0 && slot.name[0] && out->n < CLI_SLOTS_MAX) {
            out->slots[out->n++] = slot;
        }
        if (r >= 0) {
            r = sd_bus_message_exit_container(reply);
        }
    }
    return r;
}

/* If the boot loader can start nothing, RAUC answers with an error, and no slot is the next. */
static void mark_next(struct cli_installer *installer, struct cli_slots *slots)
{
    sd_bus_error ignored = SD_BUS_ERROR_NULL;
    sd_bus_message *reply = NULL;
    const char *name;
    int r = sd_bus_call_method(installer->bus, RAUC, RAUC_PATH, RAUC_INTERFACE, "GetPrimary",
                               &ignored, &reply, "");

    if (r >= 0) {
        r = sd_bus_message_read(reply, "s", &name);
    }
    for (size_t i = 0; r >= 0 && i < slots->n; i++) {
        slots->slots[i].next = strcmp(slots->slots[i].rauc_name, name) == 0;
    }
    sd_bus_message_unref(reply);
    sd_bus_error_free(&ignored);
}

enum cli_exit cli_installer_slots(struct cli_installer *installer, struct cli_slots *out,
                                  struct cli_fault *fault)
{
    sd_bus_error error = SD_BUS_ERROR_NULL;
    sd_bus_message *reply = NULL;
    enum cli_exit exit = CLI_EXIT_OK;
    int r = sd_bus_call_method(installer->bus, RAUC, RAUC_PATH, RAUC_INTERFACE, "GetSlotStatus",
                               &error, &reply, "");

    *out = (struct cli_slots){.n = 0};
    if (r >= 0) {
        r = read_slots(reply, out);
    }
    if (r < 0) {
        exit = cli_installer_fault(&error, r, fault);
    } else {
        mark_next(installer, out);
    }
    sd_bus_message_unref(reply);
    sd_bus_error_free(&error);
    return exit;
}
