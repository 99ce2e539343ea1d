#include "enroll/hub/outlet/carry/syslog_text.h"

#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { AUTHPRIV = 10, ALERT = 1, WARNING = 4, INFO = 6, HOST_MOST = 255 };

static int severity(const char *event)
{
    static const char *const warnings[] = {"attack",        "lockdown",     "lockout",
                                           "log-recovered", "records-lost", "sensor"};
    if (strcmp(event, "duress") == 0) {
        return ALERT;
    }
    for (size_t i = 0; i < sizeof warnings / sizeof *warnings; i++) {
        if (strcmp(event, warnings[i]) == 0) {
            return WARNING;
        }
    }
    return INFO;
}

/* A word of the header: printable ASCII without blanks, or "-". */
static void put_word(FILE *out, const char *text, size_t most)
{
    if (!*text) {
        (void)fputc('-', out);
    }
    for (size_t i = 0; text[i] && i < most; i++) {
        (void)fputc(text[i] > ' ' && text[i] < 0x7f ? text[i] : '-', out);
    }
}

static void put_parameter(FILE *out, const char *name, const char *value)
{
    (void)fprintf(out, " %s=\"", name);
    for (; *value; value++) {
        if (strchr("\"\\]", *value)) {
            (void)fputc('\\', out);
        }
        (void)fputc(*value, out);
    }
    (void)fputc('"', out);
}

static void put_data(FILE *out, const struct hub__batch_event *event)
{
    char door[ISO_FLEET_ID_TEXT_SIZE], number[24];
    (void)snprintf(number, sizeof number, "%" PRIu64, event->number);
    (void)fputs("[isotherm@32473", out);
    put_parameter(out, "door", iso_fleet_id_text(&event->door, door));
    put_parameter(out, "name", event->door_name);
    put_parameter(out, "number", number);
    put_parameter(out, "event", event->event);
    (void)fputs("] ", out);
}

static void put_local_time(FILE *out, const char *time, int64_t now_s)
{
    static const char *const months[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                         "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    struct tm utc = {0}, local = {0};
    const bool has_time = strptime(time, "%Y-%m-%dT%H:%M:%S", &utc) != NULL;
    const time_t at = has_time ? timegm(&utc) : (time_t)now_s;
    (void)localtime_r(&at, &local);
    (void)fprintf(out, "%s %2d %02d:%02d:%02d", months[local.tm_mon], local.tm_mday, local.tm_hour,
                  local.tm_min, local.tm_sec);
}

static void put_all(FILE *out, const struct hub__batch_event *event, enum hub__syslog_form form,
                    int64_t now_s, const char *record)
{
    (void)fprintf(out, "<%d>", 8 * AUTHPRIV + severity(event->event));
    if (form == HUB__SYSLOG_LOCAL) {
        put_local_time(out, event->time, now_s);
        (void)fputs(" isotherm-hub: ", out);
    } else {
        (void)fputs("1 ", out);
        put_word(out, event->time, 32);
        (void)fputc(' ', out);
        put_word(out, event->door_name, HOST_MOST);
        (void)fputs(" isotherm - ", out);
        put_word(out, event->event, 32);
        (void)fputc(' ', out);
    }
    put_data(out, event);
    (void)fputs(record, out);
}

char *hub__syslog_text(const struct hub__batch_event *event, enum hub__syslog_form form,
                       int64_t now_s)
{
    json_t *json = json_loads(event->record, 0, NULL);
    char *record = json ? json_dumps(json, JSON_COMPACT | JSON_ENSURE_ASCII) : NULL;
    char *text = NULL;
    size_t size = 0;
    FILE *out = record ? open_memstream(&text, &size) : NULL;
    if (out) {
        put_all(out, event, form, now_s, record);
        const bool failed = ferror(out);
        if (fclose(out) || failed) {
            free(text);
            text = NULL;
        }
    }
    json_decref(json);
    free(record);
    return text;
}
