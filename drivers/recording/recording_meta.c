#include <errno.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "drivers/file/ini_table.h"
#include "drivers/recording/recording.h"

/* The contents of a file. */
struct parse {
    struct iso_recording_meta meta;
    int format;
};

/* The mark of a key: which recordings have it, and whether it may be left out. */
enum belongs { ALWAYS, PINHOLE, PINHOLE_OPTIONAL, ORTHOGRAPHIC };

static bool sensor_is_sound(const char *sensor)
{
    const size_t length = strnlen(sensor, ISO_RECORDING_SENSOR_MAX);
    return length > 0 && length < ISO_RECORDING_SENSOR_MAX &&
           strspn(sensor, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") ==
               length;
}

static int parse_sensor(const char *value, void *field)
{
    if (!sensor_is_sound(value)) {
        return -EINVAL;
    }
    (void)snprintf(field, ISO_RECORDING_SENSOR_MAX, "%s", value);
    return 0;
}

static int parse_projection(const char *value, void *field)
{
    enum iso_projection *out = field;
    if (strcmp(value, "pinhole") == 0) {
        *out = ISO_PINHOLE;
    } else if (strcmp(value, "orthographic") == 0) {
        *out = ISO_ORTHOGRAPHIC;
    } else {
        return -EINVAL;
    }
    return 0;
}

static int parse_switch(const char *value, void *field)
{
    const bool yes = strcmp(value, "yes") == 0;
    if (!yes && strcmp(value, "no") != 0) {
        return -EINVAL;
    }
    *(bool *)field = yes;
    return 0;
}

#define CAMERA(field) offsetof(struct parse, meta.camera.field)

static const struct iso_ini_key keys[] = {
    {"recording", "format", iso_ini_parse_int, offsetof(struct parse, format), ALWAYS},
    {"recording", "sensor", parse_sensor, offsetof(struct parse, meta.sensor), ALWAYS},
    {"depth", "projection", parse_projection, CAMERA(projection), ALWAYS},
    {"depth", "width_px", iso_ini_parse_int, CAMERA(width_px), ALWAYS},
    {"depth", "height_px", iso_ini_parse_int, CAMERA(height_px), ALWAYS},
    {"depth", "fx_px", iso_ini_parse_number, CAMERA(fx_px), PINHOLE},
    {"depth", "fy_px", iso_ini_parse_number, CAMERA(fy_px), PINHOLE},
    {"depth", "pitch_mm", iso_ini_parse_number, CAMERA(pitch_mm), ORTHOGRAPHIC},
    {"depth", "cx_px", iso_ini_parse_number, CAMERA(cx_px), ALWAYS},
    {"depth", "cy_px", iso_ini_parse_number, CAMERA(cy_px), ALWAYS},
    {"depth", "k1", iso_ini_parse_number, CAMERA(k1), PINHOLE_OPTIONAL},
    {"depth", "k2", iso_ini_parse_number, CAMERA(k2), PINHOLE_OPTIONAL},
    {"depth", "k3", iso_ini_parse_number, CAMERA(k3), PINHOLE_OPTIONAL},
    {"depth", "p1", iso_ini_parse_number, CAMERA(p1), PINHOLE_OPTIONAL},
    {"depth", "p2", iso_ini_parse_number, CAMERA(p2), PINHOLE_OPTIONAL},
    {"depth", "nominal", parse_switch, offsetof(struct parse, meta.nominal), PINHOLE_OPTIONAL},
    {"depth", "unit_mm", iso_ini_parse_number, offsetof(struct parse, meta.unit_mm), ALWAYS},
};

enum { KEYS = sizeof keys / sizeof *keys };
_Static_assert((int)KEYS <= (int)ISO_INI_KEYS_MAX, "bits of what was seen");

/* Checks that every key which this projection needs is there, and no key that does not belong to
 * it. */
static int check_keys(const char *name, uint64_t seen_keys, const struct parse *parse,
                      struct iso_fault *fault)
{
    const bool pinhole = parse->meta.camera.projection == ISO_PINHOLE;
    for (int i = 0; i < KEYS; i++) {
        const struct iso_ini_key *key = &keys[i];
        const bool seen = seen_keys & UINT64_C(1) << i;
        const bool applies = key->mark == ALWAYS || (key->mark == ORTHOGRAPHIC) != pinhole;
        if (!seen && applies && key->mark != PINHOLE_OPTIONAL) {
            return iso_fault_set(fault, -EBADMSG, "%s: %s is missing from [%s]", name, key->name,
                                 key->section);
        }
        if (seen && !applies) {
            return iso_fault_set(fault, -EBADMSG, "%s: %s does not belong to this projection", name,
                                 key->name);
        }
    }
    return 0;
}

int iso_recording_meta_check(const struct iso_recording_meta *meta, struct iso_fault *fault)
{
    if (!sensor_is_sound(meta->sensor)) {
        return iso_fault_set(fault, -EINVAL,
                             "sensor must be 1..31 letters, digits, '-', '_' or '.'");
    }
    if (!(meta->unit_mm >= 0.001 && meta->unit_mm <= 100.0)) {
        return iso_fault_set(fault, -EINVAL, "unit_mm must be 0.001..100");
    }
    return iso_camera_check(&meta->camera, fault);
}

int iso_recording_meta_parse(const char *name, const char *text, struct iso_recording_meta *out,
                             struct iso_fault *fault)
{
    struct parse parse = {.format = 0};
    struct iso_fault why;
    uint64_t seen = 0;
    int error = iso_ini_read(name, text, keys, KEYS, &parse, &seen, fault);
    if (!error) {
        error = check_keys(name, seen, &parse, fault);
    }
    if (error) {
        return error;
    }
    if (parse.format != 1) {
        return iso_fault_set(fault, -EBADMSG, "%s: format %d is not supported", name, parse.format);
    }
    if (iso_recording_meta_check(&parse.meta, &why)) {
        return iso_fault_set_code(fault, why.code, -EBADMSG, "%s: %s", name, why.text);
    }
    *out = parse.meta;
    return 0;
}
