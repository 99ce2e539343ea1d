#include "drivers/file/ini_table.h"

#include <errno.h>
#include <ini.h>
#include <limits.h>
#include <string.h>

#include "drivers/file/text.h"

/* The state while libinih reads the lines. */
struct reading {
    const struct iso_ini_key *keys;
    size_t n_keys;
    char *out;
    uint64_t seen;
    struct iso_fault reason; /* why the first wrong line is refused, without the file's name */
};

int iso_ini_parse_int(const char *value, void *field)
{
    size_t count;
    if (iso_text_count(value, &count) || count > INT_MAX) {
        return -EINVAL;
    }
    *(int *)field = (int)count;
    return 0;
}

int iso_ini_parse_number(const char *value, void *field)
{
    return iso_text_number(value, field);
}

static const struct iso_ini_key *find_key(const struct reading *reading, const char *section,
                                          const char *name)
{
    for (size_t i = 0; i < reading->n_keys; i++) {
        const struct iso_ini_key *key = &reading->keys[i];
        if (strcmp(key->section, section) == 0 && strcmp(key->name, name) == 0) {
            return key;
        }
    }
    return NULL;
}

/* libinih's handler. If it returns 0 for the first time, ini_parse_string returns the number of
 * this line. */
static int on_key(void *user, const char *section, const char *name, const char *value)
{
    struct reading *reading = user;
    const struct iso_ini_key *key = find_key(reading, section, name);
    const uint64_t bit = key ? UINT64_C(1) << (key - reading->keys) : 0;
    struct iso_fault reason = {.text = ""};
    if (!key) {
        (void)iso_fault_set(&reason, 0, "unknown key '%s' in [%s]", name, section);
    } else if (reading->seen & bit) {
        (void)iso_fault_set(&reason, 0, "%s is given twice in [%s]", name, section);
    } else if (key->parse(value, reading->out + key->offset)) {
        (void)iso_fault_set(&reason, 0, "bad value '%s' for %s", value, name);
    } else {
        reading->seen |= bit;
        return 1;
    }
    if (!reading->reason.text[0]) {
        reading->reason = reason;
    }
    return 0;
}

int iso_ini_read(const char *name, const char *text, const struct iso_ini_key *keys, size_t n_keys,
                 void *out, uint64_t *seen, struct iso_fault *fault)
{
    struct reading reading = {.keys = keys, .n_keys = n_keys, .out = out};
    int line = iso_text_find_long_line(text, ISO_TEXT_INI_LINE_MAX);
    if (line) {
        return iso_fault_set(fault, -EBADMSG, "%s:%d: line too long", name, line);
    }
    line = ini_parse_string(text, on_key, &reading);
    if (line < 0) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    if (line > 0) {
        const char *reason = reading.reason.text[0] ? reading.reason.text : "not `key = value`";
        return iso_fault_set(fault, -EBADMSG, "%s:%d: %s", name, line, reason);
    }
    *seen = reading.seen;
    return 0;
}
