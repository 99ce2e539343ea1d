#include "enroll/cli/text/log_record.h"

#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "drivers/terminal/terminal.h"
#include "enroll/cli/arguments/when.h"
#include "enroll/cli/text/name.h"

enum { VALUE_SIZE = 1024 };

enum form {
    FORM_AS_IT_IS,
    FORM_SCORE,   /* shown with two digits, except in a full record */
    FORM_PROGRAM, /* shown only in a full record */
};

/* The members after number, time and event, in the order of the text and of the columns. */
static const struct member {
    const char *name;
    enum form form;
} members[] = {
    {"verdict", FORM_AS_IT_IS},     {"person", FORM_AS_IT_IS},     {"reason", FORM_AS_IT_IS},
    {"door", FORM_AS_IT_IS},        {"door_fault", FORM_AS_IT_IS}, {"score", FORM_SCORE},
    {"threshold", FORM_SCORE},      {"frames", FORM_AS_IT_IS},     {"attack_frames", FORM_AS_IT_IS},
    {"sensor", FORM_AS_IT_IS},      {"gallery", FORM_AS_IT_IS},    {"before", FORM_AS_IT_IS},
    {"after", FORM_AS_IT_IS},       {"note", FORM_AS_IT_IS},       {"grant", FORM_AS_IT_IS},
    {"monotonic_ns", FORM_PROGRAM},
};

enum { MEMBERS = sizeof members / sizeof *members };

static const char *text_of(const json_t *record, const char *name)
{
    return json_string_value(json_object_get(record, name));
}

uint64_t cli_log_sequence(const json_t *record)
{
    return (uint64_t)json_integer_value(json_object_get(record, "sequence"));
}

int64_t cli_log_time_s(const json_t *record)
{
    const char *text = text_of(record, "time");
    struct tm fields = {0};

    return text && strptime(text, "%Y-%m-%dT%H:%M:%S", &fields) ? timegm(&fields) : 0;
}

bool cli_log_chooses(const struct cli_arguments *arguments)
{
    return arguments->n_people > 0 || arguments->events || arguments->day_ends_s;
}

/* Whether the list, such as "visit,door", contains the word. */
static bool has_word(const char *list, const char *word)
{
    const size_t length = strlen(word);

    for (const char *at = list; at; at = strchr(at, ','), at = at ? at + 1 : NULL) {
        if (strcspn(at, ",") == length && strncmp(at, word, length) == 0) {
            return true;
        }
    }
    return false;
}

/* Whether the record is about one of these people, or n is 0. The record of a renamed person has
 * two names. */
static bool is_about(const json_t *record, const char *const *people, size_t n)
{
    const char *event = text_of(record, "event"), *person = text_of(record, "person");
    const char *renamed = event && strcmp(event, "rename") == 0 ? text_of(record, "after") : NULL;

    for (size_t i = 0; i < n; i++) {
        if ((person && cli_name_is_same(person, people[i])) ||
            (renamed && cli_name_is_same(renamed, people[i]))) {
            return true;
        }
    }
    return n == 0;
}

bool cli_log_matches(const json_t *record, const struct cli_arguments *arguments)
{
    const char *event = text_of(record, "event");
    const int64_t time_s = cli_log_time_s(record);

    return is_about(record, arguments->people, arguments->n_people) &&
           (!arguments->events || (event && has_word(arguments->events, event))) &&
           (!arguments->day_ends_s ||
            (time_s >= arguments->day_begins_s && time_s < arguments->day_ends_s));
}

static void format_value(const json_t *value, enum form form, bool full, char text[VALUE_SIZE])
{
    if (json_is_string(value)) {
        (void)snprintf(text, VALUE_SIZE, "%s", json_string_value(value));
    } else if (json_is_number(value) && form == FORM_SCORE && !full) {
        (void)snprintf(text, VALUE_SIZE, "%.2f", json_number_value(value));
    } else {
        char *dumped = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT);
        (void)snprintf(text, VALUE_SIZE, "%s", dumped ? dumped : "?");
        free(dumped);
    }
}

/* ---- text ---- */

/* The colour of a verdict. All other members have no colour. */
static enum iso_paint paint_of(const char *name, const char *value)
{
    if (strcmp(name, "verdict") != 0) {
        return ISO_PAINT_PLAIN;
    }
    return strcmp(value, "allow") == 0 ? ISO_PAINT_GOOD : ISO_PAINT_BAD;
}

static void print_member(const char *name, const json_t *value, enum form form, bool full,
                         const struct iso_terminal *terminal)
{
    char text[VALUE_SIZE];

    format_value(value, form, full, text);
    const enum iso_paint paint = paint_of(name, text);
    const char *quote = strchr(text, ' ') ? "\"" : "";
    fprintf(terminal->out, " %s%s=%s%s%s%s", paint ? iso_terminal_paint(terminal, paint) : "", name,
            quote, text, quote, paint ? iso_terminal_paint(terminal, ISO_PAINT_PLAIN) : "");
}

/* Whether the member is at the head of the line or in the table. */
static bool is_known(const char *name)
{
    bool known = strcmp(name, "sequence") == 0 || strcmp(name, "time") == 0 ||
                 strcmp(name, "event") == 0;

    for (size_t i = 0; i < MEMBERS; i++) {
        known |= strcmp(name, members[i].name) == 0;
    }
    return known;
}

void cli_log_print_text(const json_t *record, bool full, FILE *out)
{
    const struct iso_terminal terminal = iso_terminal_of(out);
    const char *event = text_of(record, "event"), *name;
    json_t *value;
    char time[CLI_WHEN_SIZE];

    cli_when_format_second(cli_log_time_s(record), time);
    fprintf(out, "%" JSON_INTEGER_FORMAT " %s %s", (json_int_t)cli_log_sequence(record), time,
            event ? event : "-");
    for (size_t i = 0; i < MEMBERS; i++) {
        value = json_object_get(record, members[i].name);
        if (value && (full || members[i].form != FORM_PROGRAM)) {
            print_member(members[i].name, value, members[i].form, full, &terminal);
        }
    }
    json_object_foreach((json_t *)(uintptr_t)record, name, value)
    {
        if (!is_known(name)) {
            print_member(name, value, FORM_AS_IT_IS, full, &terminal);
        }
    }
    fputc('\n', out);
}

/* ---- comma-separated values ---- */

/* Prints the value, in quotes if it contains a comma, a quote or a line end. */
static void print_csv_value(const char *text, FILE *out)
{
    const bool quote = text[strcspn(text, ",\"\r\n")] != '\0';

    fprintf(out, ",%s", quote ? "\"" : "");
    for (; *text; text++) {
        fprintf(out, "%s%c", *text == '"' ? "\"" : "", *text);
    }
    fputs(quote ? "\"" : "", out);
}

void cli_log_print_csv_head(bool full, FILE *out)
{
    fputs("sequence,time,event", out);
    for (size_t i = 0; i < MEMBERS; i++) {
        if (full || members[i].form != FORM_PROGRAM) {
            fprintf(out, ",%s", members[i].name);
        }
    }
    fputc('\n', out);
}

void cli_log_print_csv(const json_t *record, bool full, FILE *out)
{
    const char *event = text_of(record, "event");
    char text[VALUE_SIZE];

    cli_when_format_second(cli_log_time_s(record), text);
    fprintf(out, "%" JSON_INTEGER_FORMAT ",%s", (json_int_t)cli_log_sequence(record), text);
    print_csv_value(event ? event : "", out);
    for (size_t i = 0; i < MEMBERS; i++) {
        const json_t *value = json_object_get(record, members[i].name);
        if (full || members[i].form != FORM_PROGRAM) {
            text[0] = '\0';
            if (value) {
                format_value(value, members[i].form, full, text);
            }
            print_csv_value(text, out);
        }
    }
    fputc('\n', out);
}
