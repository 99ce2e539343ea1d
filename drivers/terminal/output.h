/* Checks at the end of a program that its output was written. */
#ifndef ISO_DRIVERS_TERMINAL_OUTPUT_H
#define ISO_DRIVERS_TERMINAL_OUTPUT_H

/* Writes the rest of standard output. If that, or any print before it, has failed, prints "PROGRAM:
 * standard output: No space left on device" (or "cannot be written" if the cause is no longer
 * known) to standard error and returns a negative errno. main() calls it once, at the very end. */
int iso_output_end(const char *program) __attribute__((warn_unused_result));

#endif
