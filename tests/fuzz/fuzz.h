/* What the fuzz targets share. A target is one file with libFuzzer's entry point; it must come back
 * from any input without a crash, a leak or a sanitizer's complaint. */
#ifndef TESTS_FUZZ_FUZZ_H
#define TESTS_FUZZ_FUZZ_H

#include <stddef.h>
#include <stdint.h>

/* libFuzzer's entry point, defined once in each target. */
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

/* A copy of the input: writable, ended by a NUL that is not counted, exactly so large that reading
 * past it is caught. Free with free(). */
uint8_t *fuzz_copy(const uint8_t *data, size_t size);

/* A path under which the input can be opened as a file, for readers that take a name. The same path
 * each time. */
const char *fuzz_file(const uint8_t *data, size_t size);

/* Ends the program if `condition` is false: a promise of the interface was broken. */
void fuzz_check(int condition, const char *promise);

#endif
