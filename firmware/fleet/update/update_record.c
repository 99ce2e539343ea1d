#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/data_file.h"
#include "firmware/fleet/update/update_inner.h"

enum { BYTES_MAX = 4096, TRIES_MOST = 1000 };

static const char *member(const json_t *object, const char *name)
{
    const char *text = json_string_value(json_object_get(object, name));

    return text ? text : "";
}

/* "INODE.SECONDS.NANOSECONDS"; an earlier release has none. */
static void read_stamp(const char *text, struct link_update_stamp *out)
{
    unsigned long long inode = 0;
    long long seconds = 0;
    long nanoseconds = 0;
    int end = 0;

    if (sscanf(text, "%20llu.%20lld.%9ld%n", &inode, &seconds, &nanoseconds, &end) == 3 &&
        !text[end]) {
        *out = (struct link_update_stamp){
            .inode = (ino_t)inode, .changed = {.tv_sec = (time_t)seconds, .tv_nsec = nanoseconds}};
    }
}

/* {"busy": 2}; an earlier version has one number for all reasons, which says nothing of one. */
static void read_tries(const json_t *counts, unsigned out[LINK_UPDATE_REASONS])
{
    for (size_t i = 0; i < LINK_UPDATE_REASONS; i++) {
        const json_int_t n = json_integer_value(
            json_object_get(counts, link_update_reason_code(i)));
        out[i] = n > 0 && n < TRIES_MOST ? (unsigned)n : 0;
    }
}

/* NULL if there is no memory. */
static json_t *tries_json(const unsigned tries[LINK_UPDATE_REASONS])
{
    json_t *counts = json_object();

    for (size_t i = 0; counts && i < LINK_UPDATE_REASONS; i++) {
        if (tries[i] > 0 && json_object_set_new(counts, link_update_reason_code(i),
                                                json_integer((json_int_t)tries[i]))) {
            json_decref(counts);
            counts = NULL;
        }
    }
    return counts;
}

static bool read_object(const json_t *object, struct link_update_record *out)
{
    size_t n = 0;
    const char *digits = member(object, "sha256");

    read_tries(json_object_get(object, "tries"), out->tries);
    read_stamp(member(object, "stamp"), &out->stamp);
    (void)snprintf(out->former, sizeof out->former, "%s", member(object, "former"));

    (void)snprintf(out->version, sizeof out->version, "%s", member(object, "version"));
    (void)snprintf(out->fault, sizeof out->fault, "%s", member(object, "fault"));
    return iso_fleet_id_read(member(object, "rollout"), &out->rollout) == 0 &&
           iso_fleet_update_word_is_good(out->version) &&
           iso_fleet_update_state_read(member(object, "state"), &out->state) == 0 &&
           sodium_hex2bin(out->sha256, sizeof out->sha256, digits, strlen(digits), NULL, &n,
                          NULL) == 0 &&
           n == sizeof out->sha256;
}

void link_update_record_read(const char *path, struct link_update_record *out)
{
    struct link_update_record read = {.state = ISO_FLEET_UPDATE_IDLE};
    void *bytes = NULL;
    size_t size = 0;

    *out = read;
    if (iso_data_file_read(path, BYTES_MAX, &bytes, &size, NULL) < 0) {
        return;
    }
    json_t *object = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, NULL);
    if (read_object(object, &read)) {
        *out = read;
    }
    json_decref(object);
    free(bytes);
}

int link_update_record_write(const char *path, const struct link_update_record *record,
                             struct iso_fault *fault)
{
    char rollout[ISO_FLEET_ID_TEXT_SIZE], digits[65], stamp[64];

    (void)snprintf(stamp, sizeof stamp, "%llu.%lld.%09ld", (unsigned long long)record->stamp.inode,
                   (long long)record->stamp.changed.tv_sec, record->stamp.changed.tv_nsec);
    json_t *object = json_pack(
        "{s:s, s:s, s:s, s:s, s:s, s:s, s:o, s:s}", "rollout",
        iso_fleet_id_text(&record->rollout, rollout), "version", record->version, "sha256",
        sodium_bin2hex(digits, sizeof digits, record->sha256, sizeof record->sha256), "state",
        iso_fleet_update_state_word(record->state), "fault", record->fault, "former",
        record->former, "tries", tries_json(record->tries), "stamp", stamp);
    char *text = object ? json_dumps(object, JSON_INDENT(2)) : NULL;
    const int r = text ? iso_data_file_replace(path, text, strlen(text), fault)
                       : iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);

    free(text);
    json_decref(object);
    return r;
}
