#include "firmware/policy/credential/credential_record.h"

#include <errno.h>
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/bytes.h"
#include "core/base/fault.h"

enum { FORMAT = 1, BLOCK = 64 };

/* ---- cards ---- */

const char *iso_card_number_text(const struct iso_card_number *card,
                                 char text[ISO_CARD_NUMBER_TEXT_SIZE])
{
    if (card->bits == 0) {
        (void)snprintf(text, ISO_CARD_NUMBER_TEXT_SIZE, "%" PRIu64 "/%" PRIu64, card->code >> 32,
                       card->code & 0xffffffff);
    } else {
        (void)snprintf(text, ISO_CARD_NUMBER_TEXT_SIZE, "%u:%0*" PRIx64, card->bits,
                       (card->bits + 3) / 4, card->code);
    }
    return text;
}

/* Reads digits of a base up to the character `end`. Returns the character after it, or NULL. */
static const char *read_digits(const char *text, int base, char end, uint64_t most, uint64_t *out)
{
    const char *digits = base == 16 ? "0123456789abcdefABCDEF" : "0123456789";
    const size_t n = strspn(text, digits);
    if (n == 0 || n > 16 || text[n] != end) {
        return NULL;
    }
    *out = strtoull(text, NULL, base);
    return *out <= most ? text + n + (end ? 1 : 0) : NULL;
}

int iso_card_number_read(const char *text, struct iso_card_number *out)
{
    uint64_t first = 0, second = 0;
    const char *rest = read_digits(text, 10, '/', UINT16_MAX, &first);
    if (rest && read_digits(rest, 10, '\0', UINT16_MAX, &second)) {
        *out = (struct iso_card_number){.code = first << 32 | second};
        return 0;
    }
    rest = read_digits(text, 10, ':', 64, &first);
    if (!rest || first == 0 || !read_digits(rest, 16, '\0', UINT64_MAX >> (64 - first), &second)) {
        return -EINVAL;
    }
    *out = (struct iso_card_number){.bits = (uint8_t)first, .code = second};
    return 0;
}

bool iso_card_number_is_same(const struct iso_card_number *a, const struct iso_card_number *b)
{
    return a->bits == b->bits && a->code == b->code;
}

bool iso_credential_record_has_card(const struct iso_credential_record *record,
                                    const struct iso_card_number *card)
{
    for (int i = 0; i < record->n_cards; i++) {
        if (iso_card_number_is_same(&record->cards[i], card)) {
            return true;
        }
    }
    return false;
}

/* ---- the record ---- */

struct iso_credential_record iso_credential_record_new(void)
{
    return (struct iso_credential_record){.enabled = true};
}

void iso_credential_record_wipe(struct iso_credential_record *record)
{
    explicit_bzero(record, sizeof *record);
}

static bool is_pin(iso_pin pin)
{
    /* A 1 before the digits (policy.h). */
    uint64_t least = 1;
    for (int i = 0; i < ISO_PIN_DIGITS_MIN; i++) {
        least *= 10;
    }
    for (int n = ISO_PIN_DIGITS_MIN; n <= ISO_PIN_DIGITS_MAX; n++, least *= 10) {
        if (pin >= least && pin < 2 * least) {
            return true;
        }
    }
    return false;
}

/* A text for people: not too long for its array, without control characters. */
static bool is_text(const char *text, size_t size)
{
    const char *end = memchr(text, '\0', size);
    for (const char *p = text; end && p < end; p++) {
        if ((unsigned char)*p < 0x20 || *p == 0x7f) {
            return false;
        }
    }
    return end != NULL;
}

static int check_pins(const struct iso_credential_record *record, struct iso_fault *fault)
{
    if (record->pin && !is_pin(record->pin)) {
        return iso_fault_set(fault, -EINVAL, "pin: it needs %d to %d digits", ISO_PIN_DIGITS_MIN,
                             ISO_PIN_DIGITS_MAX);
    }
    if (record->duress_pin && !is_pin(record->duress_pin)) {
        return iso_fault_set(fault, -EINVAL, "duress_pin: it needs %d to %d digits",
                             ISO_PIN_DIGITS_MIN, ISO_PIN_DIGITS_MAX);
    }
    if (record->duress_pin && !record->pin) {
        return iso_fault_set(fault, -EINVAL, "duress_pin: there is no pin that it can stand for");
    }
    return record->duress_pin && record->duress_pin == record->pin
               ? iso_fault_set(fault, -EINVAL, "duress_pin: it is the same as the pin")
               : 0;
}

static bool is_card(const struct iso_card_number *card)
{
    const uint64_t wiegand = (uint64_t)UINT16_MAX << 32 | UINT16_MAX;
    return card->bits <= 64 && (card->bits == 0 ? (card->code & ~wiegand) == 0
                                                : card->code <= UINT64_MAX >> (64 - card->bits));
}

static int check_cards(const struct iso_credential_record *record, struct iso_fault *fault)
{
    char text[ISO_CARD_NUMBER_TEXT_SIZE];
    if (record->n_cards > ISO_CREDENTIAL_CARDS_MAX) {
        return iso_fault_set(fault, -EINVAL, "cards: at most %d", ISO_CREDENTIAL_CARDS_MAX);
    }
    for (int i = 0; i < record->n_cards; i++) {
        if (!is_card(&record->cards[i])) {
            return iso_fault_set(fault, -EINVAL, "cards: number %d is no card", i + 1);
        }
        for (int j = 0; j < i; j++) {
            if (iso_card_number_is_same(&record->cards[i], &record->cards[j])) {
                return iso_fault_set(fault, -EINVAL, "cards: %s is there twice",
                                     iso_card_number_text(&record->cards[i], text));
            }
        }
    }
    return 0;
}

static int check_profiles(const struct iso_credential_record *record, struct iso_fault *fault)
{
    if (record->n_profiles > ISO_CREDENTIAL_PROFILES_MAX) {
        return iso_fault_set(fault, -EINVAL, "profiles: at most %d", ISO_CREDENTIAL_PROFILES_MAX);
    }
    for (int i = 0; i < record->n_profiles; i++) {
        if (!is_text(record->profiles[i], sizeof record->profiles[i]) || !*record->profiles[i]) {
            return iso_fault_set(fault, -EINVAL, "profiles: a name is empty, too long or no text");
        }
        for (int j = 0; j < i; j++) {
            if (strcmp(record->profiles[i], record->profiles[j]) == 0) {
                return iso_fault_set(fault, -EINVAL, "profiles: %s is there twice",
                                     record->profiles[i]);
            }
        }
    }
    return 0;
}

int iso_credential_record_check(const struct iso_credential_record *record, struct iso_fault *fault)
{
    int error = check_pins(record, fault);
    if (!error) {
        error = check_cards(record, fault);
    }
    if (!error) {
        error = check_profiles(record, fault);
    }
    if (!error && !is_text(record->disabled_reason, sizeof record->disabled_reason)) {
        error = iso_fault_set(fault, -EINVAL, "disabled_reason: too long, or not a line of text");
    }
    return error;
}

/* ---- bytes ---- */

enum { ENABLED = 1, NO_ANTIPASSBACK = 2, NEEDS_ESCORT = 4, OF_FLEET = 8, FLAGS_END = 16 };

/* The part of the fleet: person[16], revision u64, zones u8, offline_ok u8, templates[16]. */
enum { FLEET_BYTES = 16 + 8 + 1 + 1 + 16 };

static uint8_t *put_text(uint8_t *p, const char *text)
{
    const size_t n = strlen(text);
    *p++ = (uint8_t)n;
    return iso_put_bytes(p, text, n);
}

static uint8_t *put_fleet(uint8_t *p, const struct iso_credential_fleet *fleet)
{
    p = iso_put_bytes(p, fleet->person, sizeof fleet->person);
    p = iso_put_u64(p, fleet->revision);
    *p++ = fleet->zones;
    *p++ = fleet->offline_ok ? 1 : 0;
    return iso_put_bytes(p, fleet->templates, sizeof fleet->templates);
}

_Static_assert(16 + 32 + FLEET_BYTES + ISO_CREDENTIAL_CARDS_MAX * 9 +
                       ISO_CREDENTIAL_PROFILES_MAX * ISO_TOKEN_SIZE + BLOCK <=
                   ISO_CREDENTIAL_BYTES_MAX,
               "the longest record fits");

size_t iso_credential_record_put(const struct iso_credential_record *record,
                                 uint8_t bytes[ISO_CREDENTIAL_BYTES_MAX])
{
    memset(bytes, 0, ISO_CREDENTIAL_BYTES_MAX);
    uint8_t *p = bytes;
    *p++ = FORMAT;
    *p++ = (uint8_t)((record->enabled ? ENABLED : 0) |
                     (record->no_antipassback ? NO_ANTIPASSBACK : 0) |
                     (record->needs_escort ? NEEDS_ESCORT : 0) |
                     (iso_credential_is_of_fleet(record) ? OF_FLEET : 0));
    *p++ = record->two_person_class;
    p = iso_put_u32(p, record->pin);
    p = iso_put_u32(p, record->duress_pin);
    p = put_text(p, record->disabled_reason);
    *p++ = record->n_cards;
    for (int i = 0; i < record->n_cards; i++) {
        *p++ = record->cards[i].bits;
        p = iso_put_u64(p, record->cards[i].code);
    }
    *p++ = record->n_profiles;
    for (int i = 0; i < record->n_profiles; i++) {
        p = put_text(p, record->profiles[i]);
    }
    if (iso_credential_is_of_fleet(record)) {
        p = put_fleet(p, &record->fleet);
    }
    return ((size_t)(p - bytes) + BLOCK - 1) / BLOCK * BLOCK;
}

/* Bytes that are read from their beginning; `at` is NULL once they were too short. */
struct reading {
    const uint8_t *at, *end;
};

static const uint8_t *take(struct reading *reading, size_t n)
{
    const uint8_t *taken = reading->at;
    if (taken) {
        reading->at = (size_t)(reading->end - taken) >= n ? taken + n : NULL;
    }
    return reading->at ? taken : NULL;
}

static unsigned take_byte(struct reading *reading)
{
    const uint8_t *p = take(reading, 1);
    return p ? *p : 0;
}

static void take_text(struct reading *reading, char *text, size_t size)
{
    const size_t n = take_byte(reading);
    const uint8_t *p = take(reading, n);
    if (!p || n >= size || memchr(p, '\0', n)) {
        reading->at = NULL;
        return;
    }
    memcpy(text, p, n);
    text[n] = '\0';
}

static void take_lists(struct reading *reading, struct iso_credential_record *record)
{
    record->n_cards = (uint8_t)take_byte(reading);
    for (int i = 0; i < record->n_cards && i < ISO_CREDENTIAL_CARDS_MAX; i++) {
        const uint8_t *p = take(reading, 9);
        if (p) {
            record->cards[i] = (struct iso_card_number){p[0], iso_get_u64(p + 1)};
        }
    }
    record->n_profiles = (uint8_t)take_byte(reading);
    for (int i = 0; i < record->n_profiles && i < ISO_CREDENTIAL_PROFILES_MAX; i++) {
        take_text(reading, record->profiles[i], sizeof record->profiles[i]);
    }
}

/* A part without a revision or with another flag is none that put() has written. */
static void take_fleet(struct reading *reading, struct iso_credential_fleet *fleet)
{
    const uint8_t *p = take(reading, FLEET_BYTES);
    if (!p) {
        return;
    }
    memcpy(fleet->person, p, sizeof fleet->person);
    fleet->revision = iso_get_u64(p + 16);
    fleet->zones = p[24];
    fleet->offline_ok = p[25] == 1;
    memcpy(fleet->templates, p + 26, sizeof fleet->templates);
    if (fleet->revision == 0 || p[25] > 1) {
        reading->at = NULL;
    }
}

int iso_credential_record_get(const void *bytes, size_t size, struct iso_credential_record *out)
{
    struct reading reading = {bytes, (const uint8_t *)bytes + size};
    struct iso_credential_record record = {.enabled = false};
    const unsigned format = take_byte(&reading);
    if (format > FORMAT) {
        return -EPROTONOSUPPORT;
    }
    const unsigned flags = take_byte(&reading);
    record.enabled = flags & ENABLED;
    record.no_antipassback = flags & NO_ANTIPASSBACK;
    record.needs_escort = flags & NEEDS_ESCORT;
    record.two_person_class = (uint8_t)take_byte(&reading);
    const uint8_t *pins = take(&reading, 8);
    if (pins) {
        record.pin = iso_get_u32(pins);
        record.duress_pin = iso_get_u32(pins + 4);
    }
    take_text(&reading, record.disabled_reason, sizeof record.disabled_reason);
    take_lists(&reading, &record);
    if (flags & OF_FLEET) {
        take_fleet(&reading, &record.fleet);
    }
    const bool sound = reading.at && format == FORMAT && flags < FLAGS_END &&
                       iso_credential_record_check(&record, NULL) == 0;
    if (sound) {
        *out = record;
    }
    iso_credential_record_wipe(&record);
    return sound ? 0 : -EBADMSG;
}
