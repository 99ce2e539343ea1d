/* The machine on which a benchmark runs. */
#ifndef TESTS_BENCH_MACHINE_H
#define TESTS_BENCH_MACHINE_H

/* Prints a line with the name of the processor from /proc/cpuinfo, if there is one, and the system.
 */
void bench_print_machine(void);

/* Prints the present memory of this process and its maximum; prints nothing without /proc. */
void bench_print_memory(void);

/* Measures the rate at which a core can read and write its second-level cache, in GB/s: it reads
 * seven streams and writes one, 256 KiB in all, and takes the best of many passes. */
double bench_l2_gb_s(void);

#endif
