/* Small text files. */
#ifndef CLI_MACHINE_TEXT_FILE_H
#define CLI_MACHINE_TEXT_FILE_H

#include <stddef.h>

#include "core/base/fault.h"

/* Reads a whole file as a text, which the caller frees. Returns NULL after an error, with errno set
 * and a line in *why, which may be NULL: EFBIG for a file above 1 MiB, EBADMSG if it contains a
 * zero byte, and the errors of iso_text_read (drivers/file/text.h). */
char *cli_text_file_read(const char *path, struct iso_fault *why);

/* Reads the first line of a file, without the newline and up to a zero byte. It is cut to fit. ""
 * if the file cannot be read. */
void cli_text_file_line(const char *path, char *out, size_t size);

#endif
