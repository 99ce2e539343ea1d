#include "enroll/cli/arguments/option_value.h"

#include <stddef.h>
#include <stdint.h>
#include <string.h>
#include <time.h>

#include "enroll/cli/arguments/value.h"
#include "enroll/cli/arguments/when.h"
#include "enroll/cli/arguments/when_next.h"

/* The member that an option of `credential` without a value sets; NULL if it sets none. */
static bool *credential_flag(struct cli_credential_change *change, enum cli_option_id id)
{
    switch (id) {
    case CLI_OPTION_NO_CARDS:
        return &change->no_cards;
    case CLI_OPTION_PIN:
        return &change->pin;
    case CLI_OPTION_NO_PIN:
        return &change->no_pin;
    case CLI_OPTION_DURESS_PIN:
        return &change->duress_pin;
    case CLI_OPTION_NO_DURESS_PIN:
        return &change->no_duress_pin;
    case CLI_OPTION_NO_PROFILES:
        return &change->no_profiles;
    case CLI_OPTION_ENABLE:
        return &change->enable;
    default:
        return NULL;
    }
}

/* The member that an option without a value sets; NULL if it sets none. */
static bool *flag_member(struct cli_arguments *out, enum cli_option_id id)
{
    switch (id) {
    case CLI_OPTION_ALLOW_DUPLICATE:
        return &out->allow_duplicate;
    case CLI_OPTION_QUICK:
        return &out->quick;
    case CLI_OPTION_NONE:
        return &out->none;
    case CLI_OPTION_EXPIRED:
        return &out->expired;
    case CLI_OPTION_FOLLOW:
        return &out->follow;
    case CLI_OPTION_CSV:
        return &out->csv;
    case CLI_OPTION_FULL:
        return &out->full;
    case CLI_OPTION_RESET:
        return &out->reset;
    case CLI_OPTION_REPLACE:
        return &out->replace;
    case CLI_OPTION_COMMISSION:
        return &out->commission;
    case CLI_OPTION_YES:
        return &out->yes;
    case CLI_OPTION_DRY_RUN:
        return &out->dry_run;
    case CLI_OPTION_ALL:
        return &out->all;
    case CLI_OPTION_STATUS:
        return &out->status;
    case CLI_OPTION_SESSION:
        return &out->bus.session;
    case CLI_OPTION_HELP:
        return &out->help;
    case CLI_OPTION_VERSION:
        return &out->version;
    default:
        return credential_flag(&out->credential, id);
    }
}

/* The member that an option with a text sets; the text must not be empty. NULL for all other
 * options. */
static const char **text_member(struct cli_arguments *out, enum cli_option_id id)
{
    switch (id) {
    case CLI_OPTION_HEAD:
        return &out->head;
    case CLI_OPTION_ADDRESS:
        return &out->address;
    case CLI_OPTION_PASSPHRASE_FILE:
        return &out->passphrase_file;
    case CLI_OPTION_EVENT:
        return &out->events;
    case CLI_OPTION_ANSWERS:
        return &out->answers;
    case CLI_OPTION_PICTURE:
        return &out->picture;
    case CLI_OPTION_SENSOR:
        return &out->sensor;
    case CLI_OPTION_BOARD:
        return &out->board;
    case CLI_OPTION_DOOR:
        return &out->door;
    case CLI_OPTION_SHOWN:
        return &out->shown;
    case CLI_OPTION_ZONE:
        return &out->zone;
    case CLI_OPTION_DISABLE:
        return &out->credential.disable;
    case CLI_OPTION_BUS:
        return &out->bus.address;
    default:
        return NULL;
    }
}

/* Reads a limit: a point in time, or the word "none". */
static bool read_limit(const char *text, bool end_of_day, bool *named, int64_t *unix_s)
{
    *named = true;
    if (strcmp(text, "none") == 0) {
        *unix_s = 0;
        return true;
    }
    return cli_when_parse(text, end_of_day, unix_s);
}

static bool add_person(struct cli_arguments *out, const char *name)
{
    if (out->n_people == CLI_PEOPLE_MAX) {
        return false;
    }
    out->people[out->n_people++] = name;
    return *name != '\0';
}

static bool add_text(const char **texts, size_t *n, size_t max, const char *text)
{
    if (*n == max) {
        return false;
    }
    texts[(*n)++] = text;
    return *text != '\0';
}

static bool read_yes_or_no(const char **out, const char *text)
{
    *out = text;
    return strcmp(text, "yes") == 0 || strcmp(text, "no") == 0;
}

static bool read_class(struct cli_arguments *out, const char *text)
{
    unsigned long long number = 0;

    if (strcmp(text, "0") != 0 && !cli_value_count(text, 255, &number)) {
        return false;
    }
    out->credential.has_class = true;
    out->credential.two_person_class = (unsigned)number;
    return true;
}

/* The options of `credential` and `policy` that have a value of their own. */
static bool store_access(struct cli_arguments *out, enum cli_option_id id, const char *value)
{
    struct cli_credential_change *change = &out->credential;

    switch (id) {
    case CLI_OPTION_CARD:
        return add_text(change->cards, &change->n_cards, CLI_CARDS_MAX, value);
    case CLI_OPTION_PROFILE:
        return add_text(change->profiles, &change->n_profiles, CLI_PROFILES_MAX, value);
    case CLI_OPTION_ESCORT:
        return read_yes_or_no(&change->escort, value);
    case CLI_OPTION_ANTIPASSBACK:
        return read_yes_or_no(&change->antipassback, value);
    case CLI_OPTION_CLASS:
        return read_class(out, value);
    case CLI_OPTION_AT:
        out->has_at = true;
        return cli_when_parse_next(value, time(NULL), &out->at_s);
    default:
        return false;
    }
}

static bool read_count(struct cli_arguments *out, const char *text)
{
    unsigned long long number = 0;

    if (!cli_value_count(text, 100000, &number)) {
        return false;
    }
    out->count = (unsigned)number;
    return true;
}

bool cli_option_store(struct cli_arguments *out, enum cli_option_id id, const char *value)
{
    bool *flag = flag_member(out, id);
    const char **text = text_member(out, id);

    if (flag) {
        *flag = true;
        return true;
    }
    if (text) {
        *text = value;
        return *value != '\0';
    }
    switch (id) {
    case CLI_OPTION_JSON:
        return true;
    case CLI_OPTION_FROM:
        out->from_text = value;
        return true;
    case CLI_OPTION_TIMEOUT:
        return cli_value_seconds(value, &out->timeout_s);
    case CLI_OPTION_COUNT:
        return read_count(out, value);
    case CLI_OPTION_PERSON:
        return add_person(out, value);
    case CLI_OPTION_DAY:
        return cli_when_parse_day(value, time(NULL), &out->day_begins_s, &out->day_ends_s);
    case CLI_OPTION_VALID_FROM:
        return read_limit(value, false, &out->names_from, &out->valid_from_s);
    case CLI_OPTION_VALID_UNTIL:
    case CLI_OPTION_UNTIL:
        return read_limit(value, true, &out->names_until, &out->valid_until_s);
    default:
        return store_access(out, id, value);
    }
}

bool cli_option_read_from(struct cli_arguments *out)
{
    unsigned long long number = 0;

    if (!out->from_text) {
        return true;
    }
    if (out->verb != CLI_LOG) {
        return read_limit(out->from_text, false, &out->names_from, &out->valid_from_s);
    }
    if (!cli_value_count(out->from_text, UINT64_MAX, &number)) {
        return false;
    }
    out->from = number;
    return true;
}
