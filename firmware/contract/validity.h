/* From when and until when the door opens to a person. Pure. */
#ifndef ISO_FIRMWARE_CONTRACT_VALIDITY_H
#define ISO_FIRMWARE_CONTRACT_VALIDITY_H

#include <stdbool.h>
#include <stdint.h>

struct iso_validity {
    int64_t from_s, until_s; /* since 1970; 0: no limit */
};

/* A change of the limits: those that are not named stay as they are. */
struct iso_validity_change {
    bool names_from, names_until;
    struct iso_validity limits; /* the limits that are named */
    bool expired;               /* a limit in the past is intended */
};

/* The limits after a change of the limits `before`. */
struct iso_validity iso_validity_after(const struct iso_validity *before,
                                       const struct iso_validity_change *change);

bool iso_validity_is_same(const struct iso_validity *a, const struct iso_validity *b);

enum { ISO_VALIDITY_TEXT_SIZE = 80, ISO_VALIDITY_FLAW_SIZE = 160 };

/* Whether the resulting limits make sense. Returns false, with a line for people, if one is before
 * 1970, if the end is not after the beginning, or if the change names an end before now_s and does
 * not set `expired`. The end is not compared with now_s while the clock is not set. */
bool iso_validity_is_fine(const struct iso_validity *before,
                          const struct iso_validity_change *change, int64_t now_s,
                          char flaw[ISO_VALIDITY_FLAW_SIZE]);

/* "no limits", "from 2026-12-01T00:00:00Z", "until ...", "from ... until ...". */
void iso_validity_text(const struct iso_validity *validity, char text[ISO_VALIDITY_TEXT_SIZE]);

/* A date as text, UTC: "2026-11-21T08:33:20Z". Returns the text. */
enum { ISO_VALIDITY_DATE_SIZE = 32 };
const char *iso_validity_date(int64_t seconds, char text[ISO_VALIDITY_DATE_SIZE]);

#endif
