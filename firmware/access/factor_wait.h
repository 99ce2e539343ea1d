/* What the people at the door have shown until the policy is satisfied: a face, a card, a PIN, a
 * second person. Pure; times are of the monotonic clock.
 *
 *   NOBODY   a face or a card of a known person   -> WAITING, that person is the first
 *   WAITING  more of the same person              -> WAITING, added
 *            another person, and a second one is  -> WAITING, that person is the second
 *            wanted
 *            a card of somebody else              -> WAITING, "differed": the policy refuses
 *            another face after a card            -> WAITING, "differed": the policy refuses
 *            another face after a face            -> WAITING, begun anew: the first has left
 *            a face that is refused               -> NOBODY: the first has left
 *            the policy allows or refuses         -> NOBODY
 *            `wait_ns` without anything new       -> NOBODY
 *
 * Who asks the policy calls iso_factor_wait_answer() with its answer after each step. */
#ifndef ISO_FIRMWARE_ACCESS_FACTOR_WAIT_H
#define ISO_FIRMWARE_ACCESS_FACTOR_WAIT_H

#include <stdbool.h>
#include <stdint.h>

#include "firmware/policy/decide.h"

enum { ISO_FACTOR_KEYS_MAX = ISO_PIN_DIGITS_MAX };

/* All zero: nobody. */
struct iso_factor_wait {
    int64_t person, companion; /* ids of people; 0: nobody */
    struct iso_shown shown, companion_shown;
    bool by_card;          /* the first thing that the first person showed was a card */
    bool companion_wanted; /* the last answer wanted a second person */
    uint8_t wanted;        /* enum iso_recognition: what the last answer wanted */
    int64_t until_ns;      /* the end of the wait */
    bool changed;          /* something new was shown since the last answer */
    uint32_t keys;         /* a 1 before the digits that were typed so far; 0: none */
    int n_keys;
};

/* Whether somebody is waited for. */
bool iso_factor_wait_is_active(const struct iso_factor_wait *wait);

/* Whether a face of this person would begin anew although somebody else is waited for. */
bool iso_factor_wait_begins_anew(const struct iso_factor_wait *wait, int64_t person);

/* A face was recognised as this person's; or somebody showed a card of this person. */
void iso_factor_wait_face(struct iso_factor_wait *wait, int64_t person);
void iso_factor_wait_card(struct iso_factor_wait *wait, int64_t holder);

/* Somebody showed a card that nobody has. Does nothing without a first person. */
void iso_factor_wait_strange_card(struct iso_factor_wait *wait);

/* A key was pressed: '0' to '9', '*' (begins anew) or '#' (ends the PIN). Returns true if a PIN is
 * complete and was taken; it belongs to the last person who came. Keys without a first person, and
 * more digits than a PIN has, are ignored. */
bool iso_factor_wait_key(struct iso_factor_wait *wait, char key);

/* Takes the answer of the policy. WANT: waits until now_ns + wait_ns. Otherwise: NOBODY, wiped. */
void iso_factor_wait_answer(struct iso_factor_wait *wait, const struct iso_access *answer,
                            int64_t now_ns, int64_t wait_ns);

/* Ends the wait, and wipes what was shown. */
void iso_factor_wait_end(struct iso_factor_wait *wait);

#endif
