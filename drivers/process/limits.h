/* Checks that the limits of the system allow the computations of core. */
#ifndef ISO_DRIVERS_PROCESS_LIMITS_H
#define ISO_DRIVERS_PROCESS_LIMITS_H

/* The least size of the stack with which a program that computes may start. No function has a frame
 * of more than 16 KiB (cmake/IsothermWarnings.cmake), and programs need less than 136 KiB. */
enum { ISO_STACK_LEAST_BYTES = 256 << 10 };

/* Checks the limit of the main thread's stack. Returns -ENOMEM if it is lower, after one line to
 * standard error that begins with the program's name. The program must end then, because otherwise
 * a signal would kill it in the middle of its work. */
int iso_limits_check(const char *program) __attribute__((warn_unused_result));

#endif
