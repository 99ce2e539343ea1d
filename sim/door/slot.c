#include "sim/door/slot.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

/* 1 if the path is a link, 0 if it does not exist, -EINVAL if it is something else. */
static int look(const char *slot, struct iso_fault *fault)
{
    struct stat info;

    if (lstat(slot, &info) != 0) {
        return errno == ENOENT ? 0 : iso_fault_set(fault, -errno, "%s: %s", slot, strerror(errno));
    }
    return S_ISLNK(info.st_mode) ? 1
                                 : iso_fault_set(fault, -EINVAL, "%s: is no symbolic link", slot);
}

int sim_slot_point(const char *slot, const char *corpus, const char *recording,
                   struct iso_fault *fault)
{
    char directory[PATH_MAX], target[PATH_MAX + NAME_MAX], beside[PATH_MAX];
    const int there = look(slot, fault);

    if (there < 0) {
        return there;
    }
    if (!realpath(corpus, directory)) {
        return iso_fault_set(fault, -errno, "%s: %s", corpus, strerror(errno));
    }
    if (snprintf(target, sizeof target, "%s/%s", directory, recording) >= (int)sizeof target ||
        snprintf(beside, sizeof beside, "%s.next", slot) >= (int)sizeof beside) {
        return iso_fault_set(fault, -ENAMETOOLONG, "%s: the name is too long", slot);
    }
    (void)unlink(beside); /* may be left over from a run that was killed */
    if (symlink(target, beside) != 0 || rename(beside, slot) != 0) {
        return iso_fault_set(fault, -errno, "%s: %s", slot, strerror(errno));
    }
    return 0;
}

int sim_slot_clear(const char *slot, struct iso_fault *fault)
{
    const int there = look(slot, fault);

    if (there > 0 && unlink(slot) != 0) {
        return iso_fault_set(fault, -errno, "%s: %s", slot, strerror(errno));
    }
    return there < 0 ? there : 0;
}
