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
    bool placed;           /* the new file is at `path` */
};

/* Writes the text into a new file in the folder of `path` (mode 0644) and synchronises it to the
 * disk. Creates the folder if only this one is missing. CLI_EXIT_FAULT. */
enum cli_exit cli_new_file_write(const char *path, const char *text, struct cli_new_file *out,
                                 struct cli_fault *fault) __attribute__((warn_unused_result));

/* Renames the new file to `path`, atomically. The old file becomes PATH.bak-YYYYMMDD-HHMMSS.
 * CLI_EXIT_FAULT: if file->placed is false, the old file is unchanged; if it is true, the new file
 * is in place but may not be on the disk yet. */
enum cli_exit cli_new_file_place(struct cli_new_file *file, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Restores the old file after cli_new_file_place, or removes the new one if there was no old file.
 * Does nothing if no new file is in place. CLI_EXIT_FAULT if it fails; the fault names the old
 * file. */
enum cli_exit cli_new_file_undo(struct cli_new_file *file, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Removes a draft that was not put in place. An all-zero *file is accepted. */
void cli_new_file_done(struct cli_new_file *file);

#endif
