/* Replaces a file as a whole or not at all: the new text is written to another file first, and the
 * old file is kept under another name and can be restored. */
#ifndef CLI_MACHINE_NEW_FILE_H
#define CLI_MACHINE_NEW_FILE_H

#include <limits.h>
#include <stdbool.h>

#include "enroll/cli/client/fault.h"

struct cli_new_file {
    char path[PATH_MAX];
    char draft[PATH_MAX];  /* the new text, beside the file; "" once it is in place, or dropped */
    char backup[PATH_MAX]; /* the old file; "" if there is or was none */
    bool placed;
};

/* Writes the text into a new file beside `path` (mode 0644), on the disk; makes the folder if it is
 * the only one that is missing. CLI_EXIT_FAULT. */
enum cli_exit cli_new_file_write(const char *path, const char *text, struct cli_new_file *out,
                                 struct cli_fault *fault) __attribute__((warn_unused_result));

/* Puts it in place at one stroke; the old file becomes PATH.bak-YYYYMMDD-HHMMSS. CLI_EXIT_FAULT:
 * the old file is as it was. */
enum cli_exit cli_new_file_place(struct cli_new_file *file, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* After place: puts the old file back, or removes the new one if there was none. CLI_EXIT_FAULT: it
 * could not; the fault says where the old file is. */
enum cli_exit cli_new_file_undo(struct cli_new_file *file, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Removes a draft that has not been placed. An all-zero one is fine. */
void cli_new_file_done(struct cli_new_file *file);

#endif
