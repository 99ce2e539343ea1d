/* INI files by a table: which keys exist, how a value is read, and where it is stored.
 *
 * The daemon's configuration (firmware/config) has a reader of its own. It keeps keys that it does
 * not know until the back ends are known to which these options may belong. It names sections that
 * have no key. And it describes the expected value if a value is bad. Recordings and calibrations
 * need none of this. */
#ifndef ISO_DRIVERS_FILE_INI_TABLE_H
#define ISO_DRIVERS_FILE_INI_TABLE_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { ISO_INI_KEYS_MAX = 64 };

struct iso_ini_key {
    const char *section, *name;
    int (*parse)(const char *value, void *field); /* 0, or -EINVAL */
    size_t offset; /* offset of the field in the struct that is filled in */
    int mark;      /* a number for the owner of the table */
};

/* Reads a text; `name` is its name in faults. *seen has bit i set if keys[i] was given. -EBADMSG
 * for a line longer than ISO_TEXT_INI_LINE_MAX, one that is not `key = value`, a key that is
 * unknown or given twice, or a bad value. The fault names the first of them with its line; *out is
 * then partly filled. -ENOMEM. */
int iso_ini_read(const char *name, const char *text, const struct iso_ini_key *keys, size_t n_keys,
                 void *out, uint64_t *seen, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* For `parse`: a whole number of 0 or more into an int, and a number into a double. -EINVAL for
 * other values. */
int iso_ini_parse_int(const char *value, void *field);
int iso_ini_parse_number(const char *value, void *field);

#endif
