/* Which names a person may have, and which spellings are one name. */
#ifndef ISO_FIRMWARE_CONTRACT_PERSON_NAME_H
#define ISO_FIRMWARE_CONTRACT_PERSON_NAME_H

#include <stdbool.h>
#include <stdint.h>

enum {
    ISO_PERSON_NAME_CHARACTERS = 64,
    ISO_PERSON_NAME_SIZE = 4 * ISO_PERSON_NAME_CHARACTERS + 1, /* in UTF-8, with the NUL */
};

/* The rule for a new name: valid UTF-8 of 1..64 characters, with no blank at either end. It
 * contains no control character (C0, DEL, C1, line and paragraph separators, marks that change the
 * direction of writing), because these could forge log lines and lists. It contains no invisible
 * character: Default_Ignorable_Code_Point, Bidi_Control and the category "format" of the Unicode
 * standard, noncharacters, and the empty Braille pattern. Returns NULL if the name is fine, else
 * what is wrong with it. */
const char *iso_person_name_flaw(const char *name);

/* The rule for a name that is already in a store: an earlier version allowed invisible characters,
 * and blanks at both ends. Returns true if the name fulfils it. */
bool iso_person_name_can_be_stored(const char *name);

/* Whether a text of any length has one of the control characters above, or is not UTF-8. Texts of
 * people that get into the log must not. */
bool iso_person_name_has_control(const char *text);

/* Two names are one person's if their keys are the same ("Ada" and "ada", "STRASSE" and "Straße",
 * and other spellings that name_folding.h makes equal). The key is a digest of fixed size, which is
 * kept and compared instead of the folded name. */
struct iso_person_name_key {
    uint8_t bytes[16];
};

/* -EINVAL the name is not UTF-8, -ENOMEM. */
int iso_person_name_key(const char *name, struct iso_person_name_key *out)
    __attribute__((warn_unused_result));

bool iso_person_name_key_is_same(const struct iso_person_name_key *a,
                                 const struct iso_person_name_key *b);

#endif
