#include "firmware/config/config.h"

#include <errno.h>
#include <ini.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/text.h"
#include "firmware/config/config_options.h"
#include "firmware/config/config_value.h"

/* libinih cuts lines at its ini_max_line of 200 bytes, without a report. Therefore a line of more
 * than LINE_MAX_BYTES is a fault. */
enum { LINE_MAX_BYTES = 190, FILE_MAX_BYTES = 65536 };

/* The state of parsing while libinih goes through the text. */
struct parse {
    struct iso_config config;
    const char *rest;                        /* the text that libinih has not asked for yet */
    int line;                                /* number of the line that it asked for last, from 1 */
    bool seen[ISO_CONFIG_KEYS_MAX];          /* keys[i] was given */
    struct iso__config_pending sensor, door; /* keys that are for the back ends */
    int fault_line;                          /* number of the first line at fault; 0: none */
    struct iso_fault reason;
};

/* ---- parsing ---- */

static const struct iso_config_key *find_key(const char *section, const char *name)
{
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        if (strcmp(iso_config_keys[i].section, section) == 0 &&
            strcmp(iso_config_keys[i].name, name) == 0) {
            return &iso_config_keys[i];
        }
    }
    return NULL;
}

static bool section_is_known(const char *name, size_t length)
{
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        if (strlen(iso_config_keys[i].section) == length &&
            strncmp(iso_config_keys[i].section, name, length) == 0) {
            return true;
        }
    }
    return false;
}

/* Notes a fault, unless this line or an earlier one has a fault already. */
__attribute__((format(printf, 3, 4))) static void refuse(struct parse *parse, int line,
                                                         const char *format, ...)
{
    va_list arguments;
    if (parse->fault_line && parse->fault_line <= line) {
        return;
    }
    parse->fault_line = line;
    va_start(arguments, format);
    (void)vsnprintf(parse->reason.text, sizeof parse->reason.text, format, arguments);
    va_end(arguments);
}

/* Checks the length of a line, and the name of a section. libinih does not report a section that
 * has no keys. */
static void check_line(struct parse *parse, const char *line, size_t length)
{
    if (length > LINE_MAX_BYTES) {
        refuse(parse, parse->line, "line is longer than %d bytes", LINE_MAX_BYTES);
        return;
    }
    const size_t blanks = strspn(line, " \t");
    if (line[blanks] == '[') {
        const char *name = line + blanks + 1;
        const size_t name_length = strcspn(name, "]\n");
        if (name[name_length] == ']' && !section_is_known(name, name_length)) {
            refuse(parse, parse->line, "unknown section [%.*s]", (int)name_length, name);
        }
    }
}

/* The reader of libinih: passes one line at a time, so that the handler knows its number. */
static char *next_line(char *line, int size, void *context)
{
    struct parse *parse = context;
    if (!*parse->rest) {
        return NULL;
    }
    const size_t length = strcspn(parse->rest, "\n");
    const size_t whole = length + (parse->rest[length] == '\n');
    const size_t room = (size_t)size - 1;
    parse->line++;
    check_line(parse, parse->rest, length);
    memcpy(line, parse->rest, whole < room ? whole : room);
    line[whole < room ? whole : room] = '\0';
    parse->rest += whole;
    return line;
}

/* Handles a key that is not the appliance's: an obsolete one, an option of a back end, or an
 * unknown one. Returns 0 if the line is at fault. */
static int on_other_key(struct parse *parse, const char *section, const char *name,
                        const char *value)
{
    struct iso_fault why = {.text = ""};
    struct iso__config_pending *pending = NULL;
    const char *obsolete = iso_config_find_obsolete(section, name);
    if (obsolete) {
        parse->config.obsolete = obsolete;
        return 1;
    }
    if (strcmp(section, iso__config_sensor_class.section) == 0) {
        pending = &parse->sensor;
    } else if (strcmp(section, iso__config_door_class.section) == 0) {
        pending = &parse->door;
    }
    if (pending) {
        if (!iso__config_pending_add(pending, name, value, parse->line, &why)) {
            return 1;
        }
        refuse(parse, parse->line, "%s", why.text);
    } else if (section_is_known(section, strlen(section))) {
        refuse(parse, parse->line, "unknown key '%s' in [%s]", name, section);
    } else {
        refuse(parse, parse->line, "key '%s' is in no known section", name);
    }
    return 0;
}

/* The handler of libinih. Returns 0 if the line is at fault. */
static int on_key(void *context, const char *section, const char *name, const char *value)
{
    struct parse *parse = context;
    const struct iso_config_key *key = find_key(section, name);
    char expected[96];
    if (!key) {
        return on_other_key(parse, section, name, value);
    }
    if (parse->seen[key - iso_config_keys]) {
        refuse(parse, parse->line, "'%s' is given twice", name);
        return 0;
    }
    parse->seen[key - iso_config_keys] = true;
    if (iso__config_store(key, value, &parse->config)) {
        iso__config_describe(key, expected, sizeof expected);
        refuse(parse, parse->line, "bad value '%s' for '%s' (%s)", value, name, expected);
        return 0;
    }
    return 1;
}

/* Called at the end of the file, when the names of the back ends are known. */
static void resolve_options(struct parse *parse)
{
    struct iso_config *config = &parse->config;
    struct iso_fault why = {.text = ""};
    int line = 0;
    if (iso__config_pending_resolve(&iso__config_sensor_class, config->sensor.backend,
                                    &parse->sensor, &config->sensor.options, &line, &why)) {
        refuse(parse, line, "%s", why.text);
    }
    if (iso__config_pending_resolve(&iso__config_door_class, config->door.backend, &parse->door,
                                    &config->door.options, &line, &why)) {
        refuse(parse, line, "%s", why.text);
    }
}

struct iso_config iso_config_default(void)
{
    struct iso_config config = {0};
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        (void)iso__config_store(&iso_config_keys[i], iso_config_keys[i].standard, &config);
    }
    return config;
}

/* Reports what is wrong with a parsed text. `line`: the first line at fault that libinih reports;
 * 0: none. */
static int judge_text(const struct parse *parse, const char *name, int line,
                      struct iso_fault *fault)
{
    if (line > 0 && (!parse->fault_line || line < parse->fault_line)) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL,
                                  "%s:%d: not `key = value`", name, line);
    }
    if (parse->fault_line) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL, "%s:%d: %s", name,
                                  parse->fault_line, parse->reason.text);
    }
    const char *conflict = iso__config_find_conflict(&parse->config);
    return conflict ? iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL, "%s: %s", name,
                                         conflict)
                    : 0;
}

int iso_config_parse(const char *name, const char *text, struct iso_config *out,
                     struct iso_fault *fault)
{
    struct parse *parse = calloc(1, sizeof *parse);
    if (!parse) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    parse->config = iso_config_default();
    parse->rest = text;
    const int line = ini_parse_stream(next_line, parse, on_key, parse);
    int error = line < 0 ? iso_fault_set(fault, -ENOMEM, "%s: out of memory", name) : 0;
    if (!error) {
        resolve_options(parse);
        error = judge_text(parse, name, line, fault);
    }
    if (!error) {
        *out = parse->config;
    }
    free(parse);
    return error;
}

int iso_config_load(const char *path, struct iso_config *out, struct iso_fault *fault)
{
    char *text = NULL;
    int error = iso_text_read(path, FILE_MAX_BYTES, &text, fault);
    if (error == -ENOENT) {
        return iso_fault_recode(fault, ISO_FAULT_NOT_CONFIGURED, error);
    }
    if (!error) {
        error = iso_config_parse(path, text, out, fault);
        free(text);
    }
    return error;
}
