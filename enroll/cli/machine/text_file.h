/* Small text files. */
#ifndef CLI_MACHINE_TEXT_FILE_H
#define CLI_MACHINE_TEXT_FILE_H

#include <stddef.h>

#include "core/base/fault.h"

/* The whole file, terminated, to be freed. NULL with errno and a line in *why (which may be NULL):
 * EFBIG above 1 MiB, EBADMSG it holds a zero byte, and those of iso_text_read
 * (drivers/file/text.h). */
char *cli_text_file_read(const char *path, struct iso_fault *why);

/* Its first line without the newline (or up to a zero byte), cut to fit; "" if it cannot be read.
 */
void cli_text_file_line(const char *path, char *out, size_t size);

#endif
