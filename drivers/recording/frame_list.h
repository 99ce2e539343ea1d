/* The lists of a recording (depth.txt, ir.txt, rgb.txt), with the file and the time of each
 * frame. */
#ifndef ISO_DRIVERS_RECORDING_FRAME_LIST_H
#define ISO_DRIVERS_RECORDING_FRAME_LIST_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

struct iso_frame_entry {
    int64_t t_ns;
    const char *file; /* relative to the recording's directory, inside it; points into `text` */
};

struct iso_frame_list {
    size_t n;
    struct iso_frame_entry *entries; /* by rising time */
    char *text;
};

/* Reads a list; -EBADMSG for a malformed line, a file outside the directory, time that does not
 * rise, no frames; -ENOMEM, or the errno of open and read. */
int iso__frame_list_read(const char *path, struct iso_frame_list *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees the list and sets it to all zero. An all-zero list is accepted. */
void iso__frame_list_done(struct iso_frame_list *list);

#endif
