/* What a site stores about a person besides name, limits and templates: ONVIF's credential with its
 * identifiers. The face is the templates, and so is not in here. Pure.
 *
 *   JSON patch --credential_json.h--> struct iso_credential_record --put--> bytes of the gallery
 *                                            |
 *                                            '--iso_credential_of--> struct iso_credential
 * (policy.h)
 *
 * A person without a stored record has the record of iso_credential_record_new(). */
#ifndef ISO_FIRMWARE_POLICY_CREDENTIAL_CREDENTIAL_RECORD_H
#define ISO_FIRMWARE_POLICY_CREDENTIAL_CREDENTIAL_RECORD_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "firmware/policy/policy.h"

enum {
    ISO_CREDENTIAL_CARDS_MAX = 4,
    ISO_CREDENTIAL_BYTES_MAX = 1024, /* of iso_credential_record_put */
    ISO_CARD_NUMBER_TEXT_SIZE = 40,
};

/* A card as a reader reports it. Two cards are the same if both members are. */
struct iso_card_number {
    uint8_t bits;  /* 0: facility and number of a Wiegand card of 26 or 34 bits, with right parity:
                    * code is facility << 32 | number. Else the length of the code, 1 to 64 */
    uint64_t code; /* the raw code; its first bit is the most significant of `bits` */
};

/* "17/4711" (facility and number), or "56:04a2b3c4d5e6f7" (bits, and the code in hexadecimal
 * digits). read: -EINVAL the text is no card. Facility is at most 65535, number too. */
const char *iso_card_number_text(const struct iso_card_number *card,
                                 char text[ISO_CARD_NUMBER_TEXT_SIZE]);
int iso_card_number_read(const char *text, struct iso_card_number *out)
    __attribute__((warn_unused_result));
bool iso_card_number_is_same(const struct iso_card_number *a, const struct iso_card_number *b);

/* That a person came from a fleet (firmware/fleet). The person then belongs to the hub. */
struct iso_credential_fleet {
    uint8_t person[16];    /* the person's id in the fleet */
    uint64_t revision;     /* of what is stored; 0: the person does not come from a fleet */
    uint8_t zones;         /* a bit for each zone that grants, in the door's own numbering */
    bool offline_ok;       /* is admitted without a lease */
    uint8_t templates[16]; /* the first half of the digest of the templates as they came */
};

struct iso_credential_record {
    bool enabled;
    char disabled_reason[32];
    bool no_antipassback, needs_escort;
    uint8_t two_person_class;
    iso_pin pin, duress_pin; /* 0: none */
    uint8_t n_cards;
    struct iso_card_number cards[ISO_CREDENTIAL_CARDS_MAX];
    uint8_t n_profiles; /* 0: the default profile of the policy */
    char profiles[ISO_CREDENTIAL_PROFILES_MAX][ISO_TOKEN_SIZE];
    struct iso_credential_fleet fleet;
};

/* Whether the person came from a fleet. */
static inline bool iso_credential_is_of_fleet(const struct iso_credential_record *record)
{
    return record->fleet.revision != 0;
}

/* Enabled, without cards, PIN and profiles. */
struct iso_credential_record iso_credential_record_new(void);

/* Wipes it. */
void iso_credential_record_wipe(struct iso_credential_record *record);

/* Returns 0, or -EINVAL with a line that names the member: a bad PIN, a duress PIN without a PIN or
 * equal to it, the same card or profile twice, a token that is empty, a reason with control
 * characters. */
int iso_credential_record_check(const struct iso_credential_record *record,
                                struct iso_fault *fault);

/* Writes a checked record and returns the size, a multiple of 64, so that the sealed size hides how
 * long the members are. A record of a person of a fleet has a flag that earlier programs refuse.
 * get: -EBADMSG bytes that put() cannot have written; -EPROTONOSUPPORT of a
 * newer format. */
size_t iso_credential_record_put(const struct iso_credential_record *record,
                                 uint8_t bytes[ISO_CREDENTIAL_BYTES_MAX]);
int iso_credential_record_get(const void *bytes, size_t size, struct iso_credential_record *out)
    __attribute__((warn_unused_result));

/* Whether one of the cards is this one. */
bool iso_credential_record_has_card(const struct iso_credential_record *record,
                                    const struct iso_card_number *card);

#endif
