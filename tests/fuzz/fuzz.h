/* Functions that the fuzz targets share. A target is one file with libFuzzer's entry point, which
 * must return for every input without a crash, a leak or a report of a sanitizer. */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* libFuzzer's entry point, defined once in each target. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* Returns a writable copy of the input with a NUL after it. The copy has exactly this size, so that
 * a sanitizer finds reads beyond it. Free it with free(). */
uint8_t *fuzz_copy(const uint8_t *data, size_t size);

/* Returns the path of a file with the input, for readers that take a path. The path is the same in
 * every call. */
const char *fuzz_file(const uint8_t *data, size_t size);

/* Ends the program if `condition` is false, because the interface has broken a promise. */
void fuzz_check(int condition, const char *promise);

#endif
