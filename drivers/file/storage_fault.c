#include "drivers/file/storage_fault.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>

int iso_storage_refused(const char *path, int error, struct iso_fault *fault)
{
    enum iso_fault_code code = ISO_FAULT_DISK_FAILED;
    int said = -EIO;
    if (error == -ENOSPC || error == -EDQUOT || error == -EFBIG) {
        code = ISO_FAULT_DISK_FULL;
        said = -ENOSPC;
    } else if (error == -EROFS) {
        code = ISO_FAULT_DISK_READ_ONLY;
        said = -EROFS;
    }
    return iso_fault_set_code(fault, code, said, "%s: the disk refused: %s", path,
                              strerror(error == -EFBIG ? ENOSPC : -error));
}

int iso_storage_reword(const char *path, int error, struct iso_fault *fault)
{
    const bool refused = iso_storage_is_refusal(error) || error == -EDQUOT;
    return refused ? iso_storage_refused(path, error, fault) : error;
}

void iso_storage_add(struct iso_fault *fault, const char *text)
{
    if (fault) {
        const size_t used = strlen(fault->text);
        (void)snprintf(fault->text + used, sizeof fault->text - used, "; %s", text);
    }
}

bool iso_storage_is_refusal(int error)
{
    return error == -EIO || error == -ENOSPC || error == -EROFS;
}
