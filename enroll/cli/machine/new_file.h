/* Replaces a file as a whole or not at all: the new text is written to another file first, and the
 * old file is kept under another name and can be restored. */
#ifndef CLI_MACHINE_NEW_FILE_H
#define CLI_MACHINE_NEW_FILE_H

#include <limits.h>
#include <stdbool.h>

#include "enroll/cli/client/fault.h"

struct cli_new_file {
    char path[PATH_MAX];
    char draft[PATH_MAX];  /* the file with the new text; "" once it is in place, or deleted */
    char backup[PATH_MAX]; /* the old file; "" if there is or was none */
    bool placed;
};

/* Writes the text into a new file in the folder of `path` (mode 0644) and synchronises it to the
 * disk. Creates the folder if only this one is missing. CLI_EXIT_FAULT. */
enum cli_exit cli_new_file_write(const char *path, const char *text, struct cli_new_file *out,
                                 struct cli_fault *fault) __attribute__((warn_unused_result));

/* Renames it to `path`, atomically; the old file becomes PATH.bak-YYYYMMDD-HHMMSS. CLI_EXIT_FAULT:
 * the old file is unchanged. */
enum cli_exit cli_new_file_place(struct cli_new_file *file, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* After place: restores the old file, or removes the new one if there was no old file.
 * CLI_EXIT_FAULT if that fails; the fault names the old file. */
enum cli_exit cli_new_file_undo(struct cli_new_file *file, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Removes a draft that has not been placed. An all-zero one is fine. */
void cli_new_file_done(struct cli_new_file *file);

#endif
