#include "enroll/cli/setup/sensor_word.h"

#include <stdio.h>
#include <string.h>

static const char key_letters[] = "abcdefghijklmnopqrstuvwxyz0123456789_";

static enum cli_exit refuse(struct cli_fault *fault, const char *part, const char *why)
{
    return cli_fault_set(fault, CLI_EXIT_USAGE, "usage", "--sensor: '%.100s': %s", part, why);
}

static bool can_be_written(const char *value)
{
    for (const char *at = value; *at; at++) {
        if ((unsigned char)*at < ' ' || *at == '\177') {
            return false;
        }
    }
    return !strstr(value, " ;") && *value != ' ' && value[strlen(value) - 1] != ' ';
}

/* The daemon runs in another folder, so it needs the full path of a file. */
static bool is_relative(const char *key, const char *value)
{
    static const char *const files[] = {"path", "camera", "calibration", "ir_device"};

    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        if (strcmp(key, files[i]) == 0) {
            return *value != '/';
        }
    }
    return false;
}

enum cli_exit cli_sensor_word_set(struct cli_sensor_word *word, const char *key, const char *value,
                                  struct cli_fault *fault)
{
    size_t i = 0;

    if (!*key || key[strspn(key, key_letters)] || strlen(key) >= sizeof word->options[0].key) {
        return refuse(fault, key, "this is not a key of [sensor] in isotherm.conf(5)");
    }
    if (!*value || !can_be_written(value)) {
        return refuse(fault, key,
                      "its value is empty or has characters that the file cannot contain");
    }
    if (is_relative(key, value)) {
        return refuse(fault, value, "a full name is needed, which begins with /");
    }
    if (strlen(value) >= CLI_SENSOR_VALUE_SIZE) {
        return refuse(fault, key, "its value is too long");
    }
    while (i < word->n_options && strcmp(word->options[i].key, key) != 0) {
        i++;
    }
    if (i == CLI_SENSOR_OPTIONS) {
        return refuse(fault, key, "these are too many options");
    }
    word->n_options += i == word->n_options;
    (void)snprintf(word->options[i].key, sizeof word->options[i].key, "%s", key);
    (void)snprintf(word->options[i].value, sizeof word->options[i].value, "%s", value);
    return CLI_EXIT_OK;
}

const char *cli_sensor_word_get(const struct cli_sensor_word *word, const char *key)
{
    for (size_t i = 0; i < word->n_options; i++) {
        if (strcmp(word->options[i].key, key) == 0) {
            return word->options[i].value;
        }
    }
    return NULL;
}

/* The key of [sensor] that is set to the place. */
static const char *key_of_place(const char *backend, const char *place)
{
    const size_t length = strlen(place);
    const bool recording = length > 4 && strcmp(place + length - 4, ".oni") == 0;

    return strcmp(backend, "replay") == 0 || recording ? "path" : "device";
}

/* Whether "KEY=" begins here. */
static bool begins_option(const char *text)
{
    const size_t length = strspn(text, key_letters);

    return length > 0 && text[length] == '=';
}

/* The end of the part that begins here: a comma that is followed by an option, or the end of the
 * text. */
static const char *end_of_part(const char *part)
{
    while (*part && !(*part == ',' && begins_option(part + 1))) {
        part++;
    }
    return part;
}

static enum cli_exit take_part(struct cli_sensor_word *word, const char *part,
                               struct cli_fault *fault)
{
    char key[sizeof word->options[0].key];

    if (!begins_option(part)) {
        return cli_sensor_word_set(word, key_of_place(word->backend, part), part, fault);
    }
    const size_t length = strspn(part, key_letters);
    (void)snprintf(key, sizeof key, "%.*s", (int)length, part);
    return length < sizeof key
               ? cli_sensor_word_set(word, key, part + length + 1, fault)
               : refuse(fault, part, "this is not a key of [sensor] in isotherm.conf(5)");
}

enum cli_exit cli_sensor_word_parse(const char *word, struct cli_sensor_word *out,
                                    struct cli_fault *fault)
{
    struct cli_sensor_word parsed = {.n_options = 0};
    const size_t length = strcspn(word, ":");
    enum cli_exit exit = CLI_EXIT_OK;
    char part[CLI_SENSOR_VALUE_SIZE + 32];

    if (length == 0 || length >= sizeof parsed.backend ||
        strspn(word, "abcdefghijklmnopqrstuvwxyz0123456789-") != length) {
        return refuse(fault, word,
                      "this does not name a driver such as v4l2:/dev/video0 or openni2");
    }
    (void)snprintf(parsed.backend, sizeof parsed.backend, "%.*s", (int)length, word);
    const char *at = word[length] ? word + length + 1 : word + length;
    while (*at && !exit) {
        const char *end = end_of_part(at);
        if ((size_t)(end - at) >= sizeof part) {
            return refuse(fault, at, "its value is too long");
        }
        (void)snprintf(part, sizeof part, "%.*s", (int)(end - at), at);
        exit = take_part(&parsed, part, fault);
        at = *end ? end + 1 : end;
    }
    if (!exit) {
        *out = parsed;
    }
    return exit;
}
