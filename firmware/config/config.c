#include "firmware/config/config.h"

#include <errno.h>
#include <ini.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/text.h"
#include "firmware/config/config_options.h"

/* libinih cuts lines at its ini_max_line of 200 bytes, silently: longer ones are refused first. */
enum { LINE_MAX_BYTES = 190, FILE_MAX_BYTES = 65536 };

_Static_assert(sizeof(enum iso_door_fail) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_counter_kind) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_image_check) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_icp_transform) == sizeof(int), "choices are stored as int");

/* What is gathered while libinih goes through the text. */
struct parse {
    struct iso_config config;
    const char *rest;                        /* what libinih has not asked for yet */
    int line;                                /* of the line it asked for last, from 1 */
    bool seen[ISO_CONFIG_KEYS_MAX];          /* keys[i] was given */
    struct iso__config_pending sensor, door; /* keys that are for the back ends */
    int fault_line;                          /* of the first line at fault, 0: none */
    struct iso_fault reason;
};

/* ---- values ---- */

static int store_text(const char *value, void *field)
{
    if (strlen(value) >= ISO_CONFIG_TEXT_SIZE) {
        return -EINVAL;
    }
    memset(field, 0, ISO_CONFIG_TEXT_SIZE);
    memcpy(field, value, strlen(value));
    return 0;
}

static int store_count(const struct iso_config_key *key, const char *value, void *field)
{
    size_t count;
    if (iso_text_count(value, &count) || (double)count < key->min || (double)count > key->max) {
        return -EINVAL;
    }
    memcpy(field, &(int){(int)count}, sizeof(int));
    return 0;
}

static int store_number(const struct iso_config_key *key, const char *value, void *field)
{
    double number;
    if (iso_text_number(value, &number) || number < key->min || number > key->max) {
        return -EINVAL;
    }
    memcpy(field, &number, sizeof number);
    return 0;
}

static int store_choice(const char *choices, const char *value, void *field, size_t size)
{
    const int choice = iso_option_find_choice(choices, value);
    if (choice < 0) {
        return -EINVAL;
    }
    if (size == sizeof(bool)) {
        memcpy(field, &(bool){choice != 0}, sizeof(bool));
    } else {
        memcpy(field, &choice, sizeof choice);
    }
    return 0;
}

static int store(const struct iso_config_key *key, const char *value, struct iso_config *config)
{
    void *field = (char *)config + key->offset;
    switch (key->type) {
    case ISO_CONFIG_TEXT:
        return store_text(value, field);
    case ISO_CONFIG_NUMBER:
        return store_number(key, value, field);
    case ISO_CONFIG_COUNT:
        return store_count(key, value, field);
    case ISO_CONFIG_CHOICE:
        return store_choice(key->choices, value, field, sizeof(int));
    case ISO_CONFIG_SWITCH:
        return store_choice("no|yes", value, field, sizeof(bool));
    }
    return -EINVAL;
}

/* What a value has to be, in words. */
static void describe(const struct iso_config_key *key, char *text, size_t size)
{
    switch (key->type) {
    case ISO_CONFIG_TEXT:
        (void)snprintf(text, size, "text of less than %d bytes", ISO_CONFIG_TEXT_SIZE);
        break;
    case ISO_CONFIG_NUMBER:
        (void)snprintf(text, size, "a number, %g to %g", key->min, key->max);
        break;
    case ISO_CONFIG_COUNT:
        (void)snprintf(text, size, "a whole number, %.0f to %.0f", key->min, key->max);
        break;
    case ISO_CONFIG_CHOICE:
        (void)snprintf(text, size, "%s", key->choices);
        break;
    case ISO_CONFIG_SWITCH:
        (void)snprintf(text, size, "no|yes");
        break;
    }
}

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

/* Notes the fault of the first line only. */
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

/* libinih tells of no section without keys. */
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

/* libinih's reader: one line at a time, so that the handler knows where it is. */
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

/* A key that is not the appliance's: an obsolete one, an option of a back end, or an unknown one.
 */
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
        refuse(parse, parse->line, "key '%s' stands in no known section", name);
    }
    return 0;
}

/* libinih's handler: 0 makes this line one at fault. */
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
    if (store(key, value, &parse->config)) {
        describe(key, expected, sizeof expected);
        refuse(parse, parse->line, "bad value '%s' for '%s' (%s)", value, name, expected);
        return 0;
    }
    return 1;
}

/* At the end of the file, where the back ends are known. */
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

/* Keys that are sound alone and make no sense together: what is wrong, or NULL. */
static const char *find_conflict(const struct iso_config *config)
{
    if (config->sensor.distance_min_mm >= config->sensor.distance_max_mm) {
        return "[sensor] distance_min_mm is not below distance_max_mm";
    }
    if (config->sensor.retry_ms > config->sensor.retry_max_ms) {
        return "[sensor] retry_ms is above retry_max_ms";
    }
    if (config->door.retry_ms > config->door.retry_max_ms) {
        return "[door] retry_ms is above retry_max_ms";
    }
    if (config->lockout.first_ms > config->lockout.longest_ms) {
        return "[lockout] first_ms is above longest_ms";
    }
    if (config->update.templates > 0 && config->update.score < iso_config_threshold(config)) {
        return "[update] score is below the threshold";
    }
    if (config->decision.agree > config->decision.max_frames) {
        return "[decision] agree is above max_frames";
    }
    if (config->motion.still_mm_s > config->motion.jump_mm_s ||
        config->motion.still_deg_s > config->motion.jump_deg_s) {
        return "[motion] what is still is faster than a jump";
    }
    return NULL;
}

bool iso_config_has_relay(const struct iso_config *config)
{
    const struct iso_config_options *options = &config->door.options;
    return *iso_config_option(options, "relay") || !*iso_config_option(options, "wiegand_d0");
}

double iso_config_threshold(const struct iso_config *config)
{
    static const double of_level[] = {
        [ISO_LEVEL_CONVENIENT] = 2.0, [ISO_LEVEL_BALANCED] = 3.0, [ISO_LEVEL_STRICT] = 4.0};
    const double set = config->decision.threshold;
    return set < 0.0 || set > 0.0 ? set : of_level[config->decision.level];
}

double iso_config_threshold_among(const struct iso_config *config, size_t n_people)
{
    const struct iso_config_decision *decision = &config->decision;
    const bool is_set = decision->threshold < 0.0 || decision->threshold > 0.0;
    const double times = (double)n_people / (double)ISO_CONFIG_PEOPLE_AT_LEVEL;
    if (is_set || !iso_method_at(config->match.method)->calibrated || times <= 1.0) {
        return iso_config_threshold(config);
    }
    return iso_config_threshold(config) + log10(times);
}

struct iso_config iso_config_default(void)
{
    struct iso_config config = {0};
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        (void)store(&iso_config_keys[i], iso_config_keys[i].standard, &config);
    }
    return config;
}

/* What is wrong with a text that was parsed, of which the parser refused `line` (0: none). */
static int judge(const struct parse *parse, const char *name, int line, struct iso_fault *fault)
{
    if (line > 0 && (!parse->fault_line || line < parse->fault_line)) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL,
                                  "%s:%d: not `key = value`", name, line);
    }
    if (parse->fault_line) {
        return iso_fault_set_code(fault, ISO_FAULT_CONFIG_WRONG, -EINVAL, "%s:%d: %s", name,
                                  parse->fault_line, parse->reason.text);
    }
    const char *conflict = find_conflict(&parse->config);
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
        error = judge(parse, name, line, fault);
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

/* ---- the sample ---- */

static void print_key(const struct iso_config_key *key, FILE *out)
{
    char expected[96];
    describe(key, expected, sizeof expected);
    fprintf(out, "# %s", key->help);
    if (key->type != ISO_CONFIG_TEXT) {
        fprintf(out, " (%s)", expected);
    }
    fprintf(out, "\n#%s =%s%s\n", key->name, *key->standard ? " " : "", key->standard);
}

/* What a section has besides the keys of the table. */
static void print_options(const char *section, FILE *out)
{
    static const struct iso__config_class *const classes[] = {&iso__config_sensor_class,
                                                              &iso__config_door_class};
    for (size_t i = 0; i < sizeof classes / sizeof *classes; i++) {
        if (strcmp(section, classes[i]->section) == 0) {
            iso__config_print_options(classes[i], out);
        }
    }
}

void iso_config_print_sample(FILE *out)
{
    fputs(
        "# Configuration of isothermd, see isotherm.conf(5). Every key is shown with the value "
        "that\n"
        "# holds when it is left out; `isothermd --check-config` says what is wrong with a file.\n",
        out);
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const char *section = iso_config_keys[i].section;
        if (i == 0 || strcmp(section, iso_config_keys[i - 1].section) != 0) {
            fprintf(out, "\n[%s]\n", section);
        }
        print_key(&iso_config_keys[i], out);
        if (i + 1 == iso_config_n_keys || strcmp(section, iso_config_keys[i + 1].section) != 0) {
            print_options(section, out);
        }
    }
}
