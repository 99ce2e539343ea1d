/* Finds the key of the appliance: in the credentials of the service manager, or in a file. Internal
 * to firmware/keys. */
#ifndef ISO_FIRMWARE_KEYS_MASTER_KEYS_H
#define ISO_FIRMWARE_KEYS_MASTER_KEYS_H

#include <stdbool.h>

#include "core/base/fault.h"
#include "firmware/keys/seal.h"

/* The first and the second choice; either may be missing. */
struct iso_master_keys {
    struct iso_seal_key keys[2];
    bool have[2];
};

/* Reads isotherm.key and isotherm.key.old from a directory of credentials. Returns 0 also if there
 * is none; -EINVAL one of them is not a key, -ENAMETOOLONG, or an errno of reading. */
int iso_master_keys_of_credentials(const char *directory, struct iso_master_keys *out,
                                   struct iso_fault *fault);

/* Reads the file of the key, and FILE.new, which remains if a change of the key was interrupted and
 * may be incomplete. Returns 0 also if there is none; -EACCES others can read the file, -EINVAL it
 * is not a key, or an errno of reading. */
int iso_master_keys_of_file(const char *file, struct iso_master_keys *out, struct iso_fault *fault);

#endif
