#include <errno.h>
#include <ini.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>

#include "drivers/recording/recording.h"
#include "drivers/text.h"

/* What is gathered while the lines go by. */
struct parse {
    struct iso_recording_meta meta;
    int format;
    unsigned seen;           /* bit i: keys[i] was given */
    struct iso_fault reason; /* of the first line at fault, without the file's name */
};

enum kind { KIND_INTEGER, KIND_NUMBER, KIND_SENSOR, KIND_PROJECTION };

/* Which recordings a key belongs to, and whether it may be left out. */
enum belongs { ALWAYS, PINHOLE, PINHOLE_OPTIONAL, ORTHOGRAPHIC };

#define CAMERA(field) offsetof(struct parse, meta.camera.field)

static const struct key {
    const char *section, *name;
    enum kind kind;
    enum belongs belongs;
    size_t offset; /* in struct parse */
} keys[] = {
    {"recording", "format", KIND_INTEGER, ALWAYS, offsetof(struct parse, format)},
    {"recording", "sensor", KIND_SENSOR, ALWAYS, offsetof(struct parse, meta.sensor)},
    {"depth", "projection", KIND_PROJECTION, ALWAYS, CAMERA(projection)},
    {"depth", "width_px", KIND_INTEGER, ALWAYS, CAMERA(width_px)},
    {"depth", "height_px", KIND_INTEGER, ALWAYS, CAMERA(height_px)},
    {"depth", "fx_px", KIND_NUMBER, PINHOLE, CAMERA(fx_px)},
    {"depth", "fy_px", KIND_NUMBER, PINHOLE, CAMERA(fy_px)},
    {"depth", "pitch_mm", KIND_NUMBER, ORTHOGRAPHIC, CAMERA(pitch_mm)},
    {"depth", "cx_px", KIND_NUMBER, ALWAYS, CAMERA(cx_px)},
    {"depth", "cy_px", KIND_NUMBER, ALWAYS, CAMERA(cy_px)},
    {"depth", "k1", KIND_NUMBER, PINHOLE_OPTIONAL, CAMERA(k1)},
    {"depth", "k2", KIND_NUMBER, PINHOLE_OPTIONAL, CAMERA(k2)},
    {"depth", "k3", KIND_NUMBER, PINHOLE_OPTIONAL, CAMERA(k3)},
    {"depth", "p1", KIND_NUMBER, PINHOLE_OPTIONAL, CAMERA(p1)},
    {"depth", "p2", KIND_NUMBER, PINHOLE_OPTIONAL, CAMERA(p2)},
    {"depth", "unit_mm", KIND_NUMBER, ALWAYS, offsetof(struct parse, meta.unit_mm)},
};

enum { KEYS = sizeof keys / sizeof *keys };

static bool sensor_is_sound(const char *sensor)
{
    size_t length = strnlen(sensor, ISO_RECORDING_SENSOR_MAX);
    return length > 0 && length < ISO_RECORDING_SENSOR_MAX &&
           strspn(sensor, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_.") ==
               length;
}

static int parse_projection(const char *value, enum iso_projection *out)
{
    if (strcmp(value, "pinhole") == 0) {
        *out = ISO_PINHOLE;
    } else if (strcmp(value, "orthographic") == 0) {
        *out = ISO_ORTHOGRAPHIC;
    } else {
        return -EINVAL;
    }
    return 0;
}

static int parse_integer(const char *value, int *out)
{
    size_t count;
    int error = iso_text_count(value, &count);
    if (error || count > INT_MAX) {
        return -EINVAL;
    }
    *out = (int)count;
    return 0;
}

static int parse_value(const struct key *key, const char *value, struct parse *parse)
{
    char *field = (char *)parse + key->offset;
    switch (key->kind) {
    case KIND_INTEGER:
        return parse_integer(value, (int *)(void *)field);
    case KIND_NUMBER:
        return iso_text_number(value, (double *)(void *)field);
    case KIND_PROJECTION:
        return parse_projection(value, (enum iso_projection *)(void *)field);
    case KIND_SENSOR:
        if (!sensor_is_sound(value)) {
            return -EINVAL;
        }
        (void)snprintf(field, ISO_RECORDING_SENSOR_MAX, "%s", value);
        return 0;
    }
    return -EINVAL;
}

static const struct key *find_key(const char *section, const char *name)
{
    for (int i = 0; i < KEYS; i++) {
        if (strcmp(keys[i].section, section) == 0 && strcmp(keys[i].name, name) == 0) {
            return &keys[i];
        }
    }
    return NULL;
}

/* libinih's handler: 0 makes this the line that ini_parse_string returns, if it is the first. */
static int on_key(void *user, const char *section, const char *name, const char *value)
{
    struct parse *parse = user;
    const struct key *key = find_key(section, name);
    struct iso_fault reason = {""};
    if (!key) {
        (void)iso_fault_set(&reason, 0, "unknown key '%s' in [%s]", name, section);
    } else if (parse->seen & 1u << (key - keys)) {
        (void)iso_fault_set(&reason, 0, "%s is given twice", name);
    } else if (parse_value(key, value, parse)) {
        (void)iso_fault_set(&reason, 0, "bad value '%s' for %s", value, name);
    } else {
        parse->seen |= 1u << (key - keys);
        return 1;
    }
    if (!parse->reason.text[0]) {
        parse->reason = reason;
    }
    return 0;
}

/* Every key that this projection needs is there, and none that it does not know. */
static int check_keys(const char *name, const struct parse *parse, struct iso_fault *fault)
{
    bool pinhole = parse->meta.camera.projection == ISO_PINHOLE;
    for (int i = 0; i < KEYS; i++) {
        const struct key *key = &keys[i];
        bool seen = parse->seen & 1u << i;
        bool applies = key->belongs == ALWAYS || (key->belongs == ORTHOGRAPHIC) != pinhole;
        if (!seen && applies && key->belongs != PINHOLE_OPTIONAL) {
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

int iso_recording_meta_check(const struct iso_recording_meta *meta, const char **what)
{
    const char *fault = NULL;
    if (!sensor_is_sound(meta->sensor)) {
        fault = "sensor must be 1..31 letters, digits, '-', '_' or '.'";
    } else if (!(meta->unit_mm >= 0.001 && meta->unit_mm <= 100.0)) {
        fault = "unit_mm must be 0.001..100";
    } else if (iso_camera_check(&meta->camera, &fault) == 0) {
        return 0;
    }
    if (what) {
        *what = fault;
    }
    return -EINVAL;
}

int iso_recording_meta_parse(const char *name, const char *text, struct iso_recording_meta *out,
                             struct iso_fault *fault)
{
    struct parse parse = {0};
    const char *what = "";
    int line = iso_text_find_long_line(text, ISO_TEXT_INI_LINE_MAX);
    if (line) {
        return iso_fault_set(fault, -EBADMSG, "%s:%d: line too long", name, line);
    }
    line = ini_parse_string(text, on_key, &parse);
    if (line < 0) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    if (line > 0) {
        const char *reason = parse.reason.text[0] ? parse.reason.text : "not `key = value`";
        return iso_fault_set(fault, -EBADMSG, "%s:%d: %s", name, line, reason);
    }
    int error = check_keys(name, &parse, fault);
    if (error) {
        return error;
    }
    if (parse.format != 1) {
        return iso_fault_set(fault, -EBADMSG, "%s: format %d is not supported", name, parse.format);
    }
    if (iso_recording_meta_check(&parse.meta, &what)) {
        return iso_fault_set(fault, -EBADMSG, "%s: %s", name, what);
    }
    *out = parse.meta;
    return 0;
}
