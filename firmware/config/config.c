#include "firmware/config/config.h"

#include <errno.h>
#include <ini.h>
#include <math.h>
#include <stdarg.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/text.h"

/* libinih cuts lines at its ini_max_line of 200 bytes, silently: longer ones are refused first. */
enum { LINE_MAX_BYTES = 190, FILE_MAX_BYTES = 65536 };

_Static_assert(sizeof(enum iso_door_fail) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_counter_kind) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_image_check) == sizeof(int), "choices are stored as int");
_Static_assert(sizeof(enum iso_icp_transform) == sizeof(int), "choices are stored as int");

/* What is gathered while libinih goes through the text. */
struct parse {
    struct iso_config config;
    const char *rest;               /* what libinih has not asked for yet */
    int line;                       /* of the line it asked for last, from 1 */
    bool seen[ISO_CONFIG_KEYS_MAX]; /* keys[i] was given */
    int fault_line;                 /* of the first line at fault, 0: none */
    struct iso_fault reason;
};

/* ---- values ---- */

/* The number of a word among "word|word", or -1. */
static int find_choice(const char *choices, const char *word)
{
    const size_t length = strlen(word);
    for (int i = 0;; i++) {
        const char *end = strchrnul(choices, '|');
        if ((size_t)(end - choices) == length && strncmp(choices, word, length) == 0) {
            return i;
        }
        if (!*end) {
            return -1;
        }
        choices = end + 1;
    }
}

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
    const int choice = find_choice(choices, value);
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

/* Notes the first fault only. */
__attribute__((format(printf, 2, 3))) static void refuse(struct parse *parse, const char *format,
                                                         ...)
{
    va_list arguments;
    if (parse->fault_line) {
        return;
    }
    parse->fault_line = parse->line;
    va_start(arguments, format);
    (void)vsnprintf(parse->reason.text, sizeof parse->reason.text, format, arguments);
    va_end(arguments);
}

/* libinih tells of no section without keys. */
static void check_line(struct parse *parse, const char *line, size_t length)
{
    if (length > LINE_MAX_BYTES) {
        refuse(parse, "line is longer than %d bytes", LINE_MAX_BYTES);
        return;
    }
    const size_t blanks = strspn(line, " \t");
    if (line[blanks] == '[') {
        const char *name = line + blanks + 1;
        const size_t name_length = strcspn(name, "]\n");
        if (name[name_length] == ']' && !section_is_known(name, name_length)) {
            refuse(parse, "unknown section [%.*s]", (int)name_length, name);
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

/* libinih's handler: 0 makes this line one at fault. */
static int on_key(void *context, const char *section, const char *name, const char *value)
{
    struct parse *parse = context;
    const struct iso_config_key *key = find_key(section, name);
    char expected[96];
    if (!key) {
        if (section_is_known(section, strlen(section))) {
            refuse(parse, "unknown key '%s' in [%s]", name, section);
        } else {
            refuse(parse, "key '%s' stands in no known section", name);
        }
        return 0;
    }
    if (parse->seen[key - iso_config_keys]) {
        refuse(parse, "'%s' is given twice", name);
        return 0;
    }
    parse->seen[key - iso_config_keys] = true;
    if (store(key, value, &parse->config)) {
        describe(key, expected, sizeof expected);
        refuse(parse, "bad value '%s' for '%s' (%s)", value, name, expected);
        return 0;
    }
    return 1;
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
    return *config->door.relay || !*config->door.wiegand_d0;
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
    if (is_set || config->match.method != ISO_MATCH_BY_METRIC || times <= 1.0) {
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

int iso_config_parse(const char *name, const char *text, struct iso_config *out,
                     struct iso_fault *fault)
{
    struct parse parse = {.config = iso_config_default(), .rest = text};
    const int line = ini_parse_stream(next_line, &parse, on_key, &parse);
    if (line < 0) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", name);
    }
    if (line > 0 && (!parse.fault_line || line < parse.fault_line)) {
        return iso_fault_set(fault, -EINVAL, "%s:%d: not `key = value`", name, line);
    }
    if (parse.fault_line) {
        return iso_fault_set(fault, -EINVAL, "%s:%d: %s", name, parse.fault_line,
                             parse.reason.text);
    }
    const char *conflict = find_conflict(&parse.config);
    if (conflict) {
        return iso_fault_set(fault, -EINVAL, "%s: %s", name, conflict);
    }
    *out = parse.config;
    return 0;
}

int iso_config_load(const char *path, struct iso_config *out, struct iso_fault *fault)
{
    char *text = NULL;
    int error = iso_text_read(path, FILE_MAX_BYTES, &text, fault);
    if (!error) {
        error = iso_config_parse(path, text, out, fault);
        free(text);
    }
    return error;
}

/* ---- options of the back ends ---- */

static size_t collect_options(const struct iso_config *config, const char *section,
                              struct iso_option out[ISO_CONFIG_OPTIONS_MAX])
{
    size_t n = 0;
    for (size_t i = 0; i < iso_config_n_keys && n < ISO_CONFIG_OPTIONS_MAX; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        const char *value = (const char *)config + key->offset;
        if (key->option && strcmp(key->section, section) == 0 && *value) {
            out[n++] = (struct iso_option){.key = key->name, .value = value};
        }
    }
    return n;
}

size_t iso_config_sensor_options(const struct iso_config *config,
                                 struct iso_option out[ISO_CONFIG_OPTIONS_MAX])
{
    return collect_options(config, "sensor", out);
}

size_t iso_config_door_options(const struct iso_config *config,
                               struct iso_option out[ISO_CONFIG_OPTIONS_MAX])
{
    return collect_options(config, "door", out);
}

/* ---- the sample ---- */

void iso_config_print_sample(FILE *out)
{
    const char *section = "";
    fputs(
        "# Configuration of isothermd, see isotherm.conf(5). Every key is shown with the value "
        "that\n"
        "# holds when it is left out; `isothermd --check-config` says what is wrong with a file.\n",
        out);
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        char expected[96];
        describe(key, expected, sizeof expected);
        if (strcmp(section, key->section) != 0) {
            section = key->section;
            fprintf(out, "\n[%s]\n", section);
        }
        fprintf(out, "# %s", key->help);
        if (key->type != ISO_CONFIG_TEXT) {
            fprintf(out, " (%s)", expected);
        }
        fprintf(out, "\n#%s =%s%s\n", key->name, *key->standard ? " " : "", key->standard);
    }
}
