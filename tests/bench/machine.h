/* What machine a benchmark ran on. */
#ifndef TESTS_BENCH_MACHINE_H
#define TESTS_BENCH_MACHINE_H

/* Prints a line: the processor's name from /proc/cpuinfo if it says one, and the system. */
void bench_print_machine(void);

/* Prints how much memory this process has now, and had at most; nothing without /proc. */
void bench_print_memory(void);

/* What a core can read and write in its second-level cache, GB/s: seven streams read and one
 * written, 256 KiB in all, the best of many passes. */
double bench_l2_gb_s(void);

#endif
