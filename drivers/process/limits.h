/* What the system has to allow a program that computes. */
#ifndef ISO_DRIVERS_PROCESS_LIMITS_H
#define ISO_DRIVERS_PROCESS_LIMITS_H

/* The least stack that a program with the computation is started with. No function has a frame of
 * more than 16 KiB (cmake/IsothermWarnings.cmake), and programs need less than 136 KiB. */
enum { ISO_STACK_LEAST_BYTES = 256 << 10 };

/* -ENOMEM, after one line to standard error that begins with the program's name, if the limit of
 * the main thread's stack is below that: the program has to end, or it would die of a signal in the
 * middle of its work. 0 else. */
int iso_limits_check(const char *program) __attribute__((warn_unused_result));

#endif
