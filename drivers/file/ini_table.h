/* INI files by a table: which keys there are, how a value is read, and where it goes.
 *
 * The daemon's configuration (firmware/config) has a reader of its own: it keeps the keys that it
 * does not know until the back ends are known whose options they may be, names sections that have
 * no key, and says of a bad value what was expected. No table of recordings or calibrations needs
 * that. */
#ifndef ISO_DRIVERS_FILE_INI_TABLE_H
#define ISO_DRIVERS_FILE_INI_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { ISO_INI_KEYS_MAX = 64 };

struct iso_ini_key {
    const char *section, *name;
    int (*parse)(const char *value, void *field); /* 0, or -EINVAL */
    size_t offset;                                /* of the field, in what is filled in */
    int mark;                                     /* what the table's owner means by it */
};

/* Reads a text; `name` stands for it in faults. *seen has bit i for keys[i] that was given.
 * -EBADMSG for a line longer than ISO_TEXT_INI_LINE_MAX, one that is not `key = value`, a key that
 * is unknown or given twice, a bad value: the first of them, with its line; *out is then half
 * filled. -ENOMEM. */
int iso_ini_read(const char *name, const char *text, const struct iso_ini_key *keys, size_t n_keys,
                 void *out, uint64_t *seen, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Values: a whole number of 0 or more into an int, a number into a double. */
int iso_ini_parse_int(const char *value, void *field);
int iso_ini_parse_number(const char *value, void *field);

#endif
