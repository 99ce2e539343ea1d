#include <errno.h>
#include <getopt.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "enroll/hub/command/hub_command.h"
#include "enroll/hub/update/hub_update.h"

enum { CONFIG = 1 << 30, WAIT_MOST_S = 31 * 24 * 3600 };

static const struct option longs[] = {
    {"config", required_argument, NULL, CONFIG},
    {"zone", required_argument, NULL, HUB_OPTION_ZONE},
    {"lease", required_argument, NULL, HUB_OPTION_LEASE},
    {"local-people", required_argument, NULL, HUB_OPTION_LOCAL},
    {"approve", required_argument, NULL, HUB_OPTION_APPROVE},
    {"from", required_argument, NULL, HUB_OPTION_FROM},
    {"until", required_argument, NULL, HUB_OPTION_UNTIL},
    {"search", required_argument, NULL, HUB_OPTION_SEARCH},
    {"unseen", no_argument, NULL, HUB_OPTION_UNSEEN},
    {"all", no_argument, NULL, HUB_OPTION_ALL},
    {"door", required_argument, NULL, HUB_OPTION_DOOR},
    {"person", required_argument, NULL, HUB_OPTION_PERSON},
    {"event", required_argument, NULL, HUB_OPTION_EVENT},
    {"since", required_argument, NULL, HUB_OPTION_SINCE},
    {"count", required_argument, NULL, HUB_OPTION_COUNT},
    {"wait", required_argument, NULL, HUB_OPTION_WAIT},
    {"secret-file", required_argument, NULL, HUB_OPTION_SECRET_FILE},
    {"ca", required_argument, NULL, HUB_OPTION_CA},
    {"from-beginning", no_argument, NULL, HUB_OPTION_BEGINNING},
    {"uri", required_argument, NULL, HUB_OPTION_URI},
    {"base", required_argument, NULL, HUB_OPTION_BASE},
    {"filter", required_argument, NULL, HUB_OPTION_FILTER},
    {"map", required_argument, NULL, HUB_OPTION_MAP},
    {"bind", required_argument, NULL, HUB_OPTION_BIND},
    {"dry-run", no_argument, NULL, HUB_OPTION_DRY_RUN},
    {"force", no_argument, NULL, HUB_OPTION_FORCE},
    {"first", required_argument, NULL, HUB_OPTION_FIRST},
    {"stop-after", required_argument, NULL, HUB_OPTION_STOP_AFTER},
    {NULL, 0, NULL, 0},
};

static const char *name_of(int option)
{
    for (const struct option *o = longs; o->name; o++) {
        if (o->val == option) {
            return o->name;
        }
    }
    return "";
}

static int read_number(const char *text, uint32_t most, uint32_t *out)
{
    char *end = NULL;
    errno = 0;
    const unsigned long long number = strtoull(text, &end, 10);
    if (errno || end == text || *end || text[0] < '0' || text[0] > '9' || number > most) {
        return -EINVAL;
    }
    *out = (uint32_t)number;
    return 0;
}

static int read_word(const char *text, const char *yes, const char *no, bool *out)
{
    if (strcmp(text, yes) != 0 && strcmp(text, no) != 0) {
        return -EINVAL;
    }
    *out = strcmp(text, yes) == 0;
    return 0;
}

/* A day, or a day and a time, of local time; "none" is 0. The end of a day is its last second. */
static int read_time(const char *text, bool end_of_day, int64_t *out)
{
    struct tm day = {.tm_isdst = -1};
    if (strcmp(text, "none") == 0) {
        *out = 0;
        return 0;
    }
    const char *rest = strptime(text, "%Y-%m-%d", &day);
    if (rest && *rest == '\0' && end_of_day) {
        day.tm_hour = 23;
        day.tm_min = day.tm_sec = 59;
    } else if (rest && *rest) {
        rest = strptime(rest, "T%H:%M", &day);
    }
    const struct tm asked = day;
    const time_t time_s = rest && *rest == '\0' ? mktime(&day) : -1;
    if (time_s <= 0 || day.tm_mday != asked.tm_mday || day.tm_mon != asked.tm_mon) {
        return -EINVAL;
    }
    *out = time_s;
    return 0;
}

/* Options of the outlets and of the directory. */
static int take_more(int option, const char *value, struct hub_arguments *out)
{
    const struct {
        int option;
        const char **text;
    } texts[] = {
        {HUB_OPTION_SECRET_FILE, &out->secret_file},
        {HUB_OPTION_CA, &out->ca},
        {HUB_OPTION_URI, &out->uri},
        {HUB_OPTION_BASE, &out->base},
        {HUB_OPTION_FILTER, &out->filter},
        {HUB_OPTION_MAP, &out->map},
        {HUB_OPTION_BIND, &out->bind},
    };
    for (size_t i = 0; i < sizeof texts / sizeof *texts; i++) {
        if (texts[i].option == option) {
            *texts[i].text = value;
        }
    }
    return 0; /* also a switch without a value */
}

static int take_text(int option, const char *value, struct hub_arguments *out)
{
    switch (option) {
    case CONFIG:
        out->config = value;
        return 0;
    case HUB_OPTION_SEARCH:
        out->search = value;
        return 0;
    case HUB_OPTION_DOOR:
        out->door = value;
        return 0;
    case HUB_OPTION_PERSON:
        out->person = value;
        return 0;
    case HUB_OPTION_EVENT:
        out->event = value;
        return 0;
    case HUB_OPTION_SINCE:
        out->since = value;
        return 0;
    default:
        return take_more(option, value, out);
    }
}

static int take(int option, const char *value, struct hub_arguments *out)
{
    switch (option) {
    case HUB_OPTION_ZONE:
        if (out->n_zones == HUB_PERSON_ZONES_MAX) {
            return -EINVAL;
        }
        out->zones[out->n_zones++] = value;
        return 0;
    case HUB_OPTION_LEASE:
        return read_number(value, 30 * 24 * 3600, &out->lease_s);
    case HUB_OPTION_COUNT:
        return read_number(value, 1000000, &out->count);
    case HUB_OPTION_WAIT:
        return read_number(value, WAIT_MOST_S, &out->wait_s);
    case HUB_OPTION_FIRST:
        return read_number(value, HUB_UPDATE_DOORS_MOST, &out->first);
    case HUB_OPTION_STOP_AFTER:
        return read_number(value, HUB_UPDATE_DOORS_MOST, &out->stop_after);
    case HUB_OPTION_LOCAL:
        return read_word(value, "yes", "no", &out->local_people);
    case HUB_OPTION_APPROVE:
        return read_word(value, "auto", "person", &out->approve_auto);
    case HUB_OPTION_FROM:
        return read_time(value, false, &out->from_s);
    case HUB_OPTION_UNTIL:
        return read_time(value, true, &out->until_s);
    default:
        return take_text(option, value, out);
    }
}

int hub_arguments_read(const struct hub_command *command, int argc, char **argv,
                       struct hub_arguments *out, struct iso_fault *fault)
{
    int option;
    *out = (struct hub_arguments){.config = NULL};
    optind = 1;
    opterr = 0;
    while ((option = getopt_long(argc, argv, "", longs, NULL)) != -1) {
        if (option == '?') {
            return iso_fault_set(fault, -EINVAL,
                                 "%s: there is no such option, or its value is missing",
                                 argv[optind - 1]);
        }
        if (option != CONFIG && !(command->options & (unsigned)option)) {
            return iso_fault_set(fault, -EINVAL, "%s has no option --%s", command->words,
                                 name_of(option));
        }
        if (take(option, optarg, out)) {
            return iso_fault_set(fault, -EINVAL, "--%s: %s is not a value of it", name_of(option),
                                 optarg);
        }
        out->given |= (unsigned)option;
    }
    for (; optind < argc && out->n_words < HUB_WORDS_MAX; optind++) {
        out->words[out->n_words++] = argv[optind];
    }
    if (out->n_words < command->least || out->n_words > command->most) {
        return iso_fault_set(fault, -EINVAL, "usage: isotherm-hub %s%s%s", command->words,
                             *command->synopsis ? " " : "", command->synopsis);
    }
    return 0;
}
