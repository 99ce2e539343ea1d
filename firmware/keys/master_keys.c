#include "firmware/keys/master_keys.h"

#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "drivers/file/data_file.h"
#include "drivers/file/file.h"

static int check_private(const char *path, struct iso_fault *fault)
{
    struct stat status;
    if (stat(path, &status)) {
        return iso_file_fault(path, -errno, fault);
    }
    return status.st_mode & 077
               ? iso_fault_set_code(fault, ISO_FAULT_KEY_EXPOSED, -EACCES,
                                    "%s: others can read this key: chmod 600", path)
               : 0;
}

/* Returns 0 with *have false if the file does not exist. */
static int read_key(const char *path, struct iso_seal_key *out, bool *have, struct iso_fault *fault)
{
    void *bytes = NULL;
    size_t size = 0;
    *have = false;
    int error = iso_data_file_read(path, 1 << 12, &bytes, &size, fault);
    if (error) {
        return error == -ENOENT ? 0 : error;
    }
    if (size == sizeof out->bytes) {
        memcpy(out->bytes, bytes, size);
        *have = true;
    } else {
        error = iso_fault_set_code(fault, ISO_FAULT_KEY_WRONG, -EINVAL,
                                   "%s: a key has %zu bytes, this has %zu", path, sizeof out->bytes,
                                   size);
    }
    sodium_memzero(bytes, size);
    free(bytes);
    return error;
}

int iso_master_keys_of_credentials(const char *directory, struct iso_master_keys *out,
                                   struct iso_fault *fault)
{
    static const char *const names[] = {"isotherm.key", "isotherm.key.old"};
    int error = 0;
    for (size_t i = 0; !error && i < 2; i++) {
        char path[PATH_MAX];
        if (snprintf(path, sizeof path, "%s/%s", directory, names[i]) >= PATH_MAX) {
            return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", directory);
        }
        error = read_key(path, &out->keys[i], &out->have[i], fault);
    }
    return error;
}

int iso_master_keys_of_file(const char *file, struct iso_master_keys *out, struct iso_fault *fault)
{
    char beside[PATH_MAX + 8];
    (void)snprintf(beside, sizeof beside, "%s.new", file);
    int error = read_key(file, &out->keys[0], &out->have[0], fault);
    if (!error && out->have[0]) {
        error = check_private(file, fault);
    }
    if (!error && read_key(beside, &out->keys[1], &out->have[1], NULL)) {
        out->have[1] = false;
    }
    return error;
}
