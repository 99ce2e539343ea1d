#include "firmware/policy/credential/credential_json.h"

#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"

static int wrong(const char *member, const char *what, struct iso_fault *fault)
{
    return iso_fault_set(fault, -EINVAL, "%.40s: %s", member, what);
}

/* ---- reading: each function takes one member, which may be null ---- */

static int read_flag(const char *member, const json_t *value, bool without, bool *out,
                     struct iso_fault *fault)
{
    if (!json_is_boolean(value) && !json_is_null(value)) {
        return wrong(member, "it must be true or false", fault);
    }
    *out = json_is_null(value) ? without : json_is_true(value);
    return 0;
}

static int read_text(const char *member, const json_t *value, char *out, size_t size,
                     struct iso_fault *fault)
{
    const char *text = json_is_null(value) ? "" : json_string_value(value);
    const size_t length = json_is_string(value) ? json_string_length(value) : 0;
    if (!text) {
        return wrong(member, "it must be a text", fault);
    }
    if (length >= size || length != strlen(text)) {
        return wrong(member, "the text is too long, or contains a zero byte", fault);
    }
    memset(out, 0, size);
    memcpy(out, text, length);
    return 0;
}

static int read_pin(const char *member, const json_t *value, iso_pin *out, struct iso_fault *fault)
{
    const char *digits = json_is_null(value) ? "" : json_string_value(value);
    if (!digits || strspn(digits, "0123456789") != strlen(digits) ||
        strlen(digits) != (json_is_string(value) ? json_string_length(value) : 0)) {
        return wrong(member, "it must be a text of digits", fault);
    }
    const size_t n = strlen(digits);
    if (n > 0 && (n < ISO_PIN_DIGITS_MIN || n > ISO_PIN_DIGITS_MAX)) {
        return iso_fault_set(fault, -EINVAL, "%s: it needs %d to %d digits", member,
                             ISO_PIN_DIGITS_MIN, ISO_PIN_DIGITS_MAX);
    }
    iso_pin pin = n > 0 ? 1 : 0;
    for (size_t i = 0; i < n; i++) {
        pin = pin * 10 + (iso_pin)(digits[i] - '0');
    }
    *out = pin;
    return 0;
}

static int read_class(const json_t *value, uint8_t *out, struct iso_fault *fault)
{
    const json_int_t number = json_is_null(value) ? 0 : json_integer_value(value);
    if ((!json_is_integer(value) && !json_is_null(value)) || number < 0 || number > 255) {
        return wrong("two_person_class", "it must be a number from 0 to 255", fault);
    }
    *out = (uint8_t)number;
    return 0;
}

static int read_cards(const json_t *value, struct iso_credential_record *record,
                      struct iso_fault *fault)
{
    if (!json_is_array(value) && !json_is_null(value)) {
        return wrong("cards", "it must be an array", fault);
    }
    if (json_array_size(value) > ISO_CREDENTIAL_CARDS_MAX) {
        return iso_fault_set(fault, -EINVAL, "cards: at most %d", ISO_CREDENTIAL_CARDS_MAX);
    }
    record->n_cards = 0;
    memset(record->cards, 0, sizeof record->cards);
    for (size_t i = 0; i < json_array_size(value); i++) {
        const char *text = json_string_value(json_array_get(value, i));
        if (!text || iso_card_number_read(text, &record->cards[record->n_cards])) {
            return iso_fault_set(fault, -EINVAL,
                                 "cards: '%.40s' is no card: write facility and number as 17/4711, "
                                 "or bits and code as 56:04a2b3c4d5e6f7",
                                 text ? text : "");
        }
        record->n_cards++;
    }
    return 0;
}

static int read_profiles(const json_t *value, struct iso_credential_record *record,
                         struct iso_fault *fault)
{
    if (!json_is_array(value) && !json_is_null(value)) {
        return wrong("profiles", "it must be an array", fault);
    }
    if (json_array_size(value) > ISO_CREDENTIAL_PROFILES_MAX) {
        return iso_fault_set(fault, -EINVAL, "profiles: at most %d", ISO_CREDENTIAL_PROFILES_MAX);
    }
    record->n_profiles = 0;
    memset(record->profiles, 0, sizeof record->profiles);
    for (size_t i = 0; i < json_array_size(value); i++) {
        char *own = record->profiles[record->n_profiles];
        const int error = read_text("profiles", json_array_get(value, i), own, ISO_TOKEN_SIZE,
                                    fault);
        if (error) {
            return error;
        }
        record->n_profiles++;
    }
    return 0;
}

static int read_member(const char *key, const json_t *value, struct iso_credential_record *record,
                       struct iso_fault *fault)
{
    if (strcmp(key, "enabled") == 0) {
        return read_flag(key, value, true, &record->enabled, fault);
    }
    if (strcmp(key, "disabled_reason") == 0) {
        return read_text(key, value, record->disabled_reason, sizeof record->disabled_reason,
                         fault);
    }
    if (strcmp(key, "cards") == 0) {
        return read_cards(value, record, fault);
    }
    if (strcmp(key, "pin") == 0) {
        return read_pin(key, value, &record->pin, fault);
    }
    if (strcmp(key, "duress_pin") == 0) {
        return read_pin(key, value, &record->duress_pin, fault);
    }
    if (strcmp(key, "profiles") == 0) {
        return read_profiles(value, record, fault);
    }
    if (strcmp(key, "no_antipassback") == 0) {
        return read_flag(key, value, false, &record->no_antipassback, fault);
    }
    if (strcmp(key, "needs_escort") == 0) {
        return read_flag(key, value, false, &record->needs_escort, fault);
    }
    if (strcmp(key, "two_person_class") == 0) {
        return read_class(value, &record->two_person_class, fault);
    }
    return wrong(key, "a credential has no such member", fault);
}

int iso_credential_patch(const char *json, struct iso_credential_record *record,
                         struct iso_fault *fault)
{
    json_error_t where;
    const size_t size = strnlen(json, ISO_CREDENTIAL_PATCH_MAX + 1);
    if (size > ISO_CREDENTIAL_PATCH_MAX) {
        return iso_fault_set(fault, -EINVAL, "a credential of more than %d bytes",
                             ISO_CREDENTIAL_PATCH_MAX);
    }
    json_t *patch = json_loadb(json, size, JSON_REJECT_DUPLICATES, &where);
    if (!json_is_object(patch)) {
        json_decref(patch);
        /* The message of jansson may quote a PIN. */
        return iso_fault_set(fault, -EINVAL,
                             "a credential is a JSON object: line %d, column %d is none",
                             where.line, where.column);
    }
    struct iso_credential_record draft = *record;
    const char *key;
    json_t *value;
    int error = 0;
    json_object_foreach(patch, key, value)
    {
        error = read_member(key, value, &draft, fault);
        if (error) {
            break;
        }
    }
    json_decref(patch);
    if (!error) {
        error = iso_credential_record_check(&draft, fault);
    }
    if (!error) {
        *record = draft;
    }
    iso_credential_record_wipe(&draft);
    return error;
}

/* ---- writing ---- */

static json_t *card_texts(const struct iso_credential_record *record)
{
    char text[ISO_CARD_NUMBER_TEXT_SIZE];
    json_t *array = json_array();
    for (int i = 0; i < record->n_cards; i++) {
        (void)json_array_append_new(array,
                                    json_string(iso_card_number_text(&record->cards[i], text)));
    }
    return array;
}

static json_t *profile_texts(const struct iso_credential_record *record)
{
    json_t *array = json_array();
    for (int i = 0; i < record->n_profiles; i++) {
        (void)json_array_append_new(array, json_string(record->profiles[i]));
    }
    return array;
}

/* The digits of a PIN, which has a 1 before them; null: there is none. */
static json_t *pin_digits(iso_pin pin)
{
    char digits[24];
    (void)snprintf(digits, sizeof digits, "%llu", (unsigned long long)pin);
    json_t *text = pin ? json_string(digits + 1) : json_null();
    explicit_bzero(digits, sizeof digits);
    return text;
}

static json_t *flag_of_pin(iso_pin pin)
{
    return json_boolean(pin != 0);
}

/* Writes a record; `pin` makes what is written of a PIN. */
static char *write_record(const struct iso_credential_record *record, json_t *(*pin)(iso_pin pin))
{
    json_t *object = json_pack("{s:b, s:s, s:o, s:o, s:o, s:o, s:b, s:b, s:i}", "enabled",
                               record->enabled, "disabled_reason", record->disabled_reason, "cards",
                               card_texts(record), "pin", pin(record->pin), "duress_pin",
                               pin(record->duress_pin), "profiles", profile_texts(record),
                               "no_antipassback", record->no_antipassback, "needs_escort",
                               record->needs_escort, "two_person_class", record->two_person_class);
    /* json_dumps() of jansson 2.14 leaves out what it has no memory for; json_dumpb() does not. */
    const size_t size = object ? json_dumpb(object, NULL, 0, JSON_COMPACT) : 0;
    char *text = size > 0 ? malloc(size + 1) : NULL;
    if (text) {
        text[json_dumpb(object, text, size, JSON_COMPACT)] = '\0';
    }
    json_decref(object);
    return text;
}

char *iso_credential_text(const struct iso_credential_record *record)
{
    return write_record(record, flag_of_pin);
}

char *iso_credential_patch_text(const struct iso_credential_record *record)
{
    return write_record(record, pin_digits);
}
