/* A temporary directory for one test, and small files in it. Failures fail the running cmocka test.
 */
#ifndef TESTS_SUPPORT_SCRATCH_H
#define TESTS_SUPPORT_SCRATCH_H

#include <stdbool.h>
#include <stddef.h>

/* cmocka set-up and tear-down: *state becomes the path of a fresh empty directory, which is removed
 * with all its contents afterwards. */
int scratch_setup(void **state);
int scratch_teardown(void **state);

/* Returns DIRECTORY/NAME in one of 64 static buffers, which are used in turn. */
const char *scratch_path(const char *directory, const char *name);

/* Writes a file, and replaces an existing one. */
void scratch_write(const char *path, const void *bytes, size_t size);
void scratch_write_text(const char *path, const char *text);

/* Reads a file into memory, which the caller frees with free(). */
void *scratch_read(const char *path, size_t *size);

void scratch_mkdir(const char *path);
bool scratch_exists(const char *path);

/* Reads a file as a string, to be freed with free(). */
char *scratch_read_text(const char *path);

#endif
