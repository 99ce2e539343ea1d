/* Small text files. */
#ifndef CLI_SETUP_TEXT_FILE_H
#define CLI_SETUP_TEXT_FILE_H

#include <stddef.h>

/* The whole file, terminated, to be freed. NULL with errno: EFBIG above 1 MiB, EBADMSG it holds
 * a zero byte, ENOMEM, and those of open() and read(). */
char *cli_text_file_read(const char *path);

/* Its first line without the newline (or up to a zero byte), cut to fit; "" if it cannot be read.
 */
void cli_text_file_line(const char *path, char *out, size_t size);

#endif
