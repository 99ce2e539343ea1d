#include "enroll/cli/image/rauc_reply.h"

#include <stdint.h>
#include <stdio.h>
#include <string.h>

/* ---- state ---- */

bool cli_rauc_is_busy(const struct cli_installer_state *state)
{
    return strcmp(state->operation, "idle") != 0;
}

/* Copies the first line of a text. */
static int read_text(sd_bus_message *message, char *out, size_t size)
{
    const char *text;
    const int r = sd_bus_message_read(message, "v", "s", &text);

    if (r >= 0) {
        (void)snprintf(out, size, "%.*s", (int)strcspn(text, "\n"), text);
    }
    return r;
}

static int read_percent(sd_bus_message *message, int *out)
{
    const char *step;
    int32_t percent, depth;
    const int r = sd_bus_message_read(message, "v", "(isi)", &percent, &step, &depth);

    if (r >= 0) {
        *out = percent;
    }
    return r;
}

static int read_property(sd_bus_message *message, struct cli_installer_state *state)
{
    const char *name;
    const int r = sd_bus_message_read_basic(message, 's', &name);

    if (r < 0) {
        return r;
    }
    if (strcmp(name, "Operation") == 0) {
        return read_text(message, state->operation, sizeof state->operation);
    }
    if (strcmp(name, "Compatible") == 0) {
        return read_text(message, state->board, sizeof state->board);
    }
    if (strcmp(name, "LastError") == 0) {
        return read_text(message, state->error, sizeof state->error);
    }
    return strcmp(name, "Progress") == 0 ? read_percent(message, &state->percent)
                                         : sd_bus_message_skip(message, "v");
}

int cli_rauc_read_state(sd_bus_message *message, struct cli_installer_state *state)
{
    int r = sd_bus_message_enter_container(message, 'a', "{sv}");

    while (r >= 0 && (r = sd_bus_message_enter_container(message, 'e', "sv")) > 0) {
        r = read_property(message, state);
        if (r >= 0) {
            r = sd_bus_message_exit_container(message);
        }
    }
    return r < 0 ? r : sd_bus_message_exit_container(message);
}

/* ---- slots ---- */

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
int cli_rauc_read_slots(sd_bus_message *reply, struct cli_slots *out)
{
    *out = (struct cli_slots){.n = 0};
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

void cli_rauc_read_primary(sd_bus_message *reply, struct cli_slots *slots)
{
    const char *name;
    const int r = sd_bus_message_read(reply, "s", &name);

    for (size_t i = 0; r >= 0 && i < slots->n; i++) {
        slots->slots[i].next = strcmp(slots->slots[i].rauc_name, name) == 0;
    }
}
