#include "enroll/cli/setup/compose.h"

#include <stdlib.h>
#include <string.h>

static const char first_line[] = "# Written by isotherm setup for the board ";

/* One line of the text, without its newline. */
struct line {
    const char *text;
    size_t length;
    const char *next; /* NULL: this is the last line */
};

static struct line line_at(const char *at)
{
    const size_t length = strcspn(at, "\n");

    return (struct line){at, length, at[length] && at[length + 1] ? at + length + 1 : NULL};
}

/* Whether the line begins a section. If so, its name is copied. */
static bool is_header(struct line line, char name[32])
{
    const size_t blanks = strspn(line.text, " \t");
    const char *begin = line.text + blanks + 1;

    if (blanks >= line.length || line.text[blanks] != '[') {
        return false;
    }
    const size_t length = strcspn(begin, "]\n");
    (void)snprintf(name, 32, "%.*s", (int)(length < 31 ? length : 31), begin);
    return true;
}

/* Whether the line sets a key and is not a comment. If so, the key's name is copied. */
static bool is_setting(struct line line, char name[32])
{
    const size_t blanks = strspn(line.text, " \t");
    const char *begin = line.text + blanks;
    const size_t length = strcspn(begin, " \t=\n");

    if (blanks >= line.length || strchr("#;[\n", *begin) || !memchr(line.text, '=', line.length)) {
        return false;
    }
    (void)snprintf(name, 32, "%.*s", (int)(length < 31 ? length : 31), begin);
    return true;
}

bool cli_compose_find(const char *text, const char *section, const char *key, char *out,
                      size_t size)
{
    char name[32], current[32] = "";

    for (const char *at = *text ? text : NULL; at;) {
        const struct line line = line_at(at);
        if (is_header(line, name)) {
            (void)snprintf(current, sizeof current, "%s", name);
        } else if (strcmp(current, section) == 0 && is_setting(line, name) &&
                   strcmp(name, key) == 0) {
            const char *value = (const char *)memchr(line.text, '=', line.length) + 1;
            value += strspn(value, " \t");
            (void)snprintf(out, size, "%.*s", (int)(line.text + line.length - value), value);
            return true;
        }
        at = line.next;
    }
    return false;
}

static void write_line(struct line line, FILE *out)
{
    fprintf(out, "%.*s\n", (int)line.length, line.text);
}

/* Whether a section of the old file is kept. */
static bool is_old_own(const char *name)
{
    return strcmp(name, "sensor") != 0 && strcmp(name, "door") != 0;
}

static bool has_section(const char *text, const char *section)
{
    char name[32];

    for (const char *at = text && *text ? text : NULL; at;) {
        const struct line line = line_at(at);
        if (is_header(line, name) && strcmp(name, section) == 0) {
            return true;
        }
        at = line.next;
    }
    return false;
}

/* ---- the sensor ---- */

/* Writes the options of the word that the board's file does not set, or all if `board_text` is
 * NULL. */
static void write_missing_options(const struct cli_sensor_word *sensor, const char *board_text,
                                  FILE *out)
{
    char value[CLI_SENSOR_VALUE_SIZE];

    for (size_t i = 0; i < sensor->n_options; i++) {
        const struct cli_sensor_option *option = &sensor->options[i];
        if (!board_text ||
            !cli_compose_find(board_text, "sensor", option->key, value, sizeof value)) {
            fprintf(out, "%s = %s\n", option->key, option->value);
        }
    }
}

/* Writes a line of the board's sensor, or the option that replaces it. */
static void write_sensor_line(const struct cli_sensor_word *sensor, struct line line, FILE *out)
{
    char name[32] = "";
    const char *value = is_setting(line, name) ? cli_sensor_word_get(sensor, name) : NULL;

    if (value) {
        fprintf(out, "%s = %s\n", name, value);
    } else {
        write_line(line, out);
    }
}

static void write_new_sensor(const struct cli_sensor_word *sensor, FILE *out)
{
    fprintf(out, "[sensor]\nbackend = %s\n", sensor->backend);
    write_missing_options(sensor, NULL, out);
}

/* ---- the complete file ---- */

/* Writes a line of the board's file, which belongs to `section`. */
static void write_board_line(const struct cli_composition *composition, bool keep_sensor,
                             const char *section, struct line line, FILE *out)
{
    const bool blank = line.length == strspn(line.text, " \t");
    const bool old = *section && is_old_own(section) && has_section(composition->old_text, section);

    if (strcmp(section, "sensor") == 0 && keep_sensor) {
        write_sensor_line(composition->sensor, line, out);
    } else if (strcmp(section, "sensor") == 0 ? blank : !old) {
        write_line(line, out);
    }
}

static void write_board(const struct cli_composition *composition, bool keep_sensor, FILE *out)
{
    const char *text = composition->board_text;
    char name[32], section[32] = "";

    for (const char *at = *text ? text : NULL; at;) {
        const struct line line = line_at(at);
        const bool header = is_header(line, name), sensor = header && strcmp(name, "sensor") == 0;
        if (header) {
            (void)snprintf(section, sizeof section, "%s", name);
        }
        if (sensor && !keep_sensor) {
            write_new_sensor(composition->sensor, out);
        }
        write_board_line(composition, keep_sensor, section, line, out);
        if (sensor && keep_sensor) {
            write_missing_options(composition->sensor, text, out);
        }
        at = line.next;
    }
}

/* Writes the sections of the old file that are kept. */
static void write_old(const char *text, FILE *out)
{
    char name[32];
    bool kept = false;

    for (const char *at = text && *text ? text : NULL; at;) {
        const struct line line = line_at(at);
        if (is_header(line, name)) {
            const bool before = kept;
            kept = is_old_own(name);
            if (kept && !before) {
                fputc('\n', out);
            }
        }
        if (kept) {
            write_line(line, out);
        }
        at = line.next;
    }
}

static void write_all(const struct cli_composition *composition, FILE *out)
{
    char backend[32] = "";
    const bool set = cli_compose_find(composition->board_text, "sensor", "backend", backend,
                                      sizeof backend);
    const bool keep_sensor = set && strcmp(backend, composition->sensor->backend) == 0;

    fprintf(out, "%s%s.\n", first_line, composition->board);
    write_board(composition, keep_sensor, out);
    if (!has_section(composition->board_text, "sensor")) {
        fputc('\n', out);
        write_new_sensor(composition->sensor, out);
    }
    write_old(composition->old_text, out);
}

/* Leaves at most one empty line between two others, and none at the end. */
static void squeeze_empty_lines(char *text)
{
    char *to = text;
    size_t newlines = 2;

    for (const char *from = text; *from; from++) {
        newlines = *from == '\n' ? newlines + 1 : 0;
        if (newlines <= 2) {
            *to++ = *from;
        }
    }
    while (to - text > 1 && to[-1] == '\n' && to[-2] == '\n') {
        to--;
    }
    *to = '\0';
}

char *cli_compose(const struct cli_composition *composition)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);

    if (!out) {
        return NULL;
    }
    write_all(composition, out);
    const bool failed = ferror(out) != 0;
    if (fclose(out) != 0 || failed) {
        free(text);
        return NULL;
    }
    squeeze_empty_lines(text);
    return text;
}
