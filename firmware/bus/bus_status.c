/* GetStatus: the state of the appliance in words and numbers. */
#include <inttypes.h>
#include <stdbool.h>
#include <stdio.h>
#include <string.h>

#include "drivers/base/utf8.h"
#include "drivers/sensor/contract/sensor.h"
#include "firmware/appliance/administration/administration.h"
#include "firmware/bus/bus_state.h"
#include "firmware/contract/fault_tag.h"

void iso__bus_clean_text(char *to, size_t size, const char *from)
{
    size_t at = 0;
    uint32_t character;
    while (*from && at + 4 < size) {
        const int length = iso_utf8_decode(from, &character);
        if (length == 0) {
            to[at++] = '?';
            from++;
            continue;
        }
        memcpy(to + at, from, (size_t)length);
        at += (size_t)length;
        from += length;
    }
    to[at] = '\0';
}

static int append_text(sd_bus_message *reply, const char *key, const char *value)
{
    char clean[300];
    iso__bus_clean_text(clean, sizeof clean, value);
    return sd_bus_message_append(reply, "{sv}", key, "s", clean);
}

/* "ONE; TWO; ..." */
struct word_list {
    char text[300];
    size_t used;
};

static void add_words(struct word_list *list, const char *format, const char *first,
                      const char *second)
{
    const size_t room = sizeof list->text - list->used;
    char words[300];
    (void)snprintf(words, sizeof words, format, first, second);
    const int length = snprintf(list->text + list->used, room, "%s%s", list->used > 0 ? "; " : "",
                                words);
    if (length > 0) {
        list->used += (size_t)length < room ? (size_t)length : room - 1;
    }
}

struct device_list {
    struct word_list words;
    enum iso_fault_code code; /* the code of the first device that has one */
};

static void list_device(const struct iso_sensor_device *device, void *context)
{
    struct device_list *list = context;
    add_words(&list->words, "%.200s (%.90s)", device->id, device->label);
    list->code = list->code == ISO_FAULT_NONE ? device->code : list->code;
}

/* Lists the devices that the driver of the sensor sees. While the sensor does not deliver new
 * frames, only drivers that answer at once are asked. The others would delay the door; the fault of
 * a lost sensor names the devices then. */
static int append_devices(sd_bus_message *reply, const struct iso_bus *bus, bool sensor_runs)
{
    struct device_list list = {.code = ISO_FAULT_NONE};
    const char *back_end = bus->borrowed->config->sensor.backend;
    if ((sensor_runs || iso_sensor_probes_at_once(back_end)) &&
        iso_sensor_probe(back_end, list_device, &list, NULL)) {
        /* The driver could not list its devices. */
        list = (struct device_list){.code = ISO_FAULT_NONE};
    }
    const int r = append_text(reply, "sensor-devices", list.words.text);
    return r < 0 ? r : append_text(reply, "sensor-devices-code", iso_fault_word(list.code));
}

/* Lists the lines that the configuration names. */
static int append_lines(sd_bus_message *reply, const struct iso_config_options *options)
{
    struct word_list list = {.text = ""};
    for (size_t i = 0; i < options->n; i++) {
        const struct iso_config_option *option = &options->list[i];
        if (option->spec->kind == ISO_OPTION_LINE) {
            add_words(&list, "%s %.60s", option->spec->name, option->value);
        }
    }
    return append_text(reply, "door-lines", list.text);
}

static int append_checksum(sd_bus_message *reply, const char *key, uint32_t value)
{
    char text[16];
    (void)snprintf(text, sizeof text, "%08" PRIx32, value);
    return append_text(reply, key, text);
}

static int append_gallery(sd_bus_message *reply, const struct iso_bus *bus, size_t valid)
{
    size_t n = 0;
    uint32_t templates = 0, usable = 0;
    const struct iso_person *people = iso_gallery_people(bus->borrowed->gallery, &n);
    for (size_t i = 0; i < n; i++) {
        templates += people[i].templates;
        usable += people[i].usable;
    }
    int r = sd_bus_message_append(reply, "{sv}", "people", "u", (uint32_t)n);
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "people-valid", "u", (uint32_t)valid);
    }
    if (r >= 0) {
        const bool provisional = iso_site_is_provisional(iso_gallery_site(bus->borrowed->gallery));
        r = sd_bus_message_append(
            reply, "{sv}", "threshold", "d",
            iso_config_threshold_among(bus->borrowed->config, n, provisional));
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "templates", "u", templates);
    }
    if (r >= 0) {
        r = sd_bus_message_append(reply, "{sv}", "templates-usable", "u", usable);
    }
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}", "capacity", "u",
                                         (uint32_t)bus->borrowed->config->gallery.capacity);
}

static int append_texts(sd_bus_message *reply, const struct iso_bus *bus,
                        const struct iso_appliance_status *status)
{
    const struct {
        const char *key, *value;
    } texts[] = {
        {"version", ISOTHERM_VERSION},
        {"sensor", bus->borrowed->config->sensor.backend},
        {"sensor-model", status->sensor_model},
        {"sensor-state", status->sensor_state},
        {"sensor-calibration", status->sensor_calibration},
        {"sensor-fault", status->sensor_fault},
        {"clock-fault", status->clock_fault},
        {"stale-fault", status->stale_fault},
        {"storage-fault", status->storage_fault},
        {"counter-fault", status->counter_fault},
        {"sensor-health", status->sensor_health},
        {"key-place", status->key_is_credential ? "credential" : "file"},
        {"door", bus->borrowed->config->door.backend},
        {"door-fault", status->door_fault},
        {"door-state", iso_door_state_name(status->door)},
        {"mode", iso_appliance_mode_name(status->mode)},
        {"last-outcome", status->last_outcome},
        {"image-check", status->image_check},
    };
    int r = 0;
    for (size_t i = 0; r >= 0 && i < sizeof texts / sizeof *texts; i++) {
        r = append_text(reply, texts[i].key, texts[i].value);
    }
    return r;
}

static int append_codes(sd_bus_message *reply, const struct iso_appliance_status *status)
{
    const struct {
        const char *key;
        enum iso_fault_code code;
    } codes[] = {
        {"sensor-calibration-code", status->sensor_calibration_code},
        {"sensor-fault-code", status->sensor_fault_code},
        {"sensor-health-code", status->sensor_health_code},
        {"clock-fault-code", status->clock_fault_code},
        {"stale-fault-code", status->stale_fault_code},
        {"storage-fault-code", status->storage_fault_code},
        {"counter-fault-code", status->counter_fault_code},
        {"door-fault-code", status->door_fault_code},
    };
    int r = 0;
    for (size_t i = 0; r >= 0 && i < sizeof codes / sizeof *codes; i++) {
        r = append_text(reply, codes[i].key, iso_fault_word(codes[i].code));
    }
    return r;
}

static int append_counts(sd_bus_message *reply, const struct iso_appliance_counts *counts)
{
    const struct {
        const char *key;
        uint64_t count;
    } entries[] = {
        {"visits-allowed", counts->allowed},
        {"visits-denied", counts->denied},
        {"visits-attack", counts->attacks},
        {"attack-frames", counts->attack_frames},
    };
    int r = 0;
    for (size_t i = 0; r >= 0 && i < sizeof entries / sizeof *entries; i++) {
        r = sd_bus_message_append(reply, "{sv}", entries[i].key, "t", entries[i].count);
    }
    return r;
}

/* Appends how much the appliance has worked, and which model and algorithm it uses. */
static int append_work(sd_bus_message *reply, const struct iso_bus *bus,
                       const struct iso_appliance_status *status)
{
    const int64_t uptime_ms = status->uptime_ns / ISO_NS_PER_MS;
    const uint64_t log_sequence = iso_audit_writer_last(iso_appliance_log(bus->appliance));
    int r = sd_bus_message_append(reply, "{sv}", "frames", "t", status->frames);
    if (r >= 0) {
        r = append_checksum(reply, "model", status->model);
    }
    if (r >= 0) {
        r = append_checksum(reply, "algorithm", status->algorithm);
    }
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}{sv}", "uptime-ms", "x", uptime_ms,
                                         "log-sequence", "t", log_sequence);
}

static int append_locks(sd_bus_message *reply, const struct iso_appliance_status *status)
{
    const int64_t lockout_ms = status->lockout_ns / ISO_NS_PER_MS;
    return sd_bus_message_append(reply, "{sv}{sv}{sv}", "door-realtime", "b",
                                 (int)!status->door_ordinary, "lockdown", "b",
                                 (int)status->lockdown, "lockout-ms", "x", lockout_ms);
}

/* The policy, and the reader of cards and keys. */
static int append_access(sd_bus_message *reply, const struct iso_bus *bus,
                         const struct iso_appliance_status *status)
{
    const struct iso_site_access *access = iso_appliance_access(bus->appliance);
    int r = sd_bus_message_append(reply, "{sv}", "policy-revision", "t",
                                  iso_site_access_revision(access));
    r = r < 0 ? r : append_text(reply, "policy-fault", iso_site_access_fault(access)->text);
    r = r < 0 ? r : append_text(reply, "reader-state", status->reader_state);
    r = r < 0 ? r : append_text(reply, "reader-fault", status->reader_fault);
    r = r < 0 ? r
              : append_text(reply, "policy-fault-code",
                            *iso_site_access_fault(access)->text
                                ? iso_fault_word(ISO_FAULT_POLICY_UNUSABLE)
                                : "");
    return r < 0 ? r
                 : append_text(reply, "reader-fault-code",
                               *status->reader_fault ? iso_fault_word(ISO_FAULT_READER_LOST) : "");
}

static int append_shown(sd_bus_message *reply, const struct iso_panel_look *look)
{
    char text[sizeof look->shown.text + 4];
    (void)snprintf(text, sizeof text, "%s%s%s", look->shown.text[0],
                   look->shown.text[1][0] ? "\n" : "", look->shown.text[1]);
    int r = append_text(reply, "panel-lamp", look->lamp);
    if (r >= 0) {
        r = append_text(reply, "panel-text", text);
    }
    return r < 0
               ? r
               : sd_bus_message_append(reply, "{sv}", "panel-buzzer", "b", (int)look->shown.buzzer);
}

/* The access panel, and what it wants the door station to show. */
static int append_panel(sd_bus_message *reply, const struct iso_bus *bus)
{
    struct iso_panel *panel = bus->borrowed->panel;
    struct iso_panel_look look;
    if (!panel) {
        return append_text(reply, "panel-state", "off");
    }
    iso_panel_look(panel, &look);
    int r = append_text(reply, "panel-state", look.state);
    if (r >= 0) {
        r = append_text(reply, "panel-fault", look.fault.text);
    }
    if (r >= 0) {
        r = append_text(reply, "panel-fault-code", iso_fault_word(look.fault.code));
    }
    if (r >= 0) {
        r = append_shown(reply, &look);
    }
    return r < 0 ? r
                 : sd_bus_message_append(reply, "{sv}{sv}{sv}", "panel-install", "b",
                                         (int)look.install, "panel-cards", "t", look.delivered,
                                         "panel-cards-lost", "t", look.undelivered);
}

int iso__bus_append_status(sd_bus_message *reply, const struct iso_bus *bus)
{
    const struct iso_appliance_status status = iso_appliance_status(bus->appliance);
    int r = sd_bus_message_open_container(reply, 'a', "{sv}");
    if (r >= 0) {
        r = append_texts(reply, bus, &status);
    }
    if (r >= 0) {
        r = append_codes(reply, &status);
    }
    if (r >= 0) {
        r = append_devices(reply, bus, strcmp(status.sensor_state, "started") == 0);
    }
    if (r >= 0) {
        r = append_lines(reply, &bus->borrowed->config->door.options);
    }
    if (r >= 0) {
        r = append_access(reply, bus, &status);
    }
    if (r >= 0) {
        r = append_panel(reply, bus);
    }
    if (r >= 0) {
        r = append_gallery(reply, bus, status.people_valid);
    }
    if (r >= 0) {
        r = iso__bus_append_site(reply, bus);
    }
    if (r >= 0) {
        r = append_work(reply, bus, &status);
    }
    if (r >= 0) {
        r = append_counts(reply, &status.counts);
    }
    if (r >= 0) {
        r = append_locks(reply, &status);
    }
    if (r >= 0 && status.view) {
        r = iso__bus_append_view_entries(reply, status.view);
    }
    return r < 0 ? r : sd_bus_message_close_container(reply);
}
