#include "firmware/policy/zones/zone_file.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/base/fault.h"
#include "drivers/file/file.h"

/* The longest file of tzdata 2025b has 3545 bytes. */
enum { FILE_MAX_BYTES = 1 << 16 };

static bool is_letter(char c)
{
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '+' || c == '-';
}

bool iso_zone_name_is_right(const char *name)
{
    const size_t size = strlen(name);
    for (size_t i = 0; i < size; i++) {
        const bool ends_part = name[i] == '/' && i > 0 && name[i - 1] != '/' && i + 1 < size;
        if (!is_letter(name[i]) && !ends_part) {
            return false;
        }
    }
    return size > 0 && size < ISO_ZONE_NAME_SIZE;
}

int iso_zone_file_read(void *context, const char *name, struct iso_zone *out,
                       struct iso_fault *fault)
{
    char path[PATH_MAX], real[PATH_MAX];
    if (!iso_zone_name_is_right(name)) {
        return iso_fault_set(fault, -EINVAL, "\"%.*s\" is not the name of a time zone",
                             ISO_ZONE_NAME_SIZE, name);
    }
    const int length = snprintf(path, sizeof path, "%s/%s", (const char *)context, name);
    if (length < 0 || (size_t)length >= sizeof path) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the path is too long", name);
    }
    /* Many zones are symbolic links to others, and iso_file_read() follows none. */
    if (!realpath(path, real)) {
        const int error = -errno;
        return error == -ENOENT ? iso_fault_set(fault, error, "there is no time zone \"%s\"", name)
                                : iso_fault_set(fault, error, "%s: %s", name, strerror(-error));
    }
    char *bytes = NULL;
    size_t size = 0;
    int error = iso_file_read(real, FILE_MAX_BYTES, &bytes, &size, fault);
    if (error == 0) {
        error = iso_zone_read(name, (const uint8_t *)bytes, size, out, fault);
        free(bytes);
    }
    return error;
}
