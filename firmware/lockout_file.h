/* The lock-out's memory in a file, so that pulling the plug does not make it forget: one line,
 *
 *   isotherm-lockout 1 FAILURES ATTACKS LOCKS REMAINING_MS open|lockdown CHECKSUM
 *
 * with the CRC-32 of what stands before it. Written beside its place and moved there: after a power
 * cut the file is the old one or the new one. It is not secret, and against who can write it there
 * is no defence. */
#ifndef ISO_FIRMWARE_LOCKOUT_FILE_H
#define ISO_FIRMWARE_LOCKOUT_FILE_H

#include <stddef.h>

#include "core/fault.h"
#include "firmware/lockout.h"

/* -ENOENT there is none (the fault is untouched then), -EBADMSG it is damaged, or an errno of
 * reading it; *out is untouched. */
int iso_lockout_load(const char *path, struct iso_lockout_record *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* On the disk when it returns. An error of storage_fault.h: the file is as it was, or as it was to
 * become without being synchronised; iso_lockout_load tells. */
int iso_lockout_save(const char *path, const struct iso_lockout_record *record,
                     struct iso_fault *fault) __attribute__((warn_unused_result));

/* Reads the text of such a file, of `size` bytes with a NUL behind. -EBADMSG. */
int iso_lockout_parse(const char *text, size_t size, struct iso_lockout_record *out)
    __attribute__((warn_unused_result));

#endif
