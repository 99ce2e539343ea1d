/* What a person may be called. */
#ifndef ISO_FIRMWARE_PERSON_NAME_H
#define ISO_FIRMWARE_PERSON_NAME_H

enum {
    ISO_PERSON_NAME_CHARACTERS = 64,
    ISO_PERSON_NAME_SIZE = 4 * ISO_PERSON_NAME_CHARACTERS + 1, /* in UTF-8, with its end */
};

/* Valid UTF-8 of 1..64 characters, none of them a control character (C0, DEL, C1, line and
 * paragraph separators, marks that turn the direction of writing, which would forge log lines and
 * lists), no blank at either end. NULL if the name is fine, else what is wrong with it. */
const char *iso_person_name_flaw(const char *name);

#endif
