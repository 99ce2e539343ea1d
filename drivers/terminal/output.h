/* What a program has printed counts only when it has been written. */
#ifndef ISO_DRIVERS_TERMINAL_OUTPUT_H
#define ISO_DRIVERS_TERMINAL_OUTPUT_H

/* Writes out what standard output still holds. If that, or any print before it, has failed: says
 * "PROGRAM: standard output: No space left on device" (or, where the cause is no longer known,
 * "cannot be written") on standard error and returns a negative errno. To be called once, by
 * main(), at the very end. */
int iso_output_end(const char *program) __attribute__((warn_unused_result));

#endif
