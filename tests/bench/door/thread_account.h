/* Reads from the kernel how a thread is scheduled, how long it waited for a processor, and how many
 * page faults it had. */
#ifndef TESTS_BENCH_DOOR_THREAD_ACCOUNT_H
#define TESTS_BENCH_DOOR_THREAD_ACCOUNT_H

#include <stddef.h>
#include <stdint.h>
#include <sys/types.h>

/* Counts since the thread began; stolen_ns is of all processors since the machine started. */
struct bench_account {
    int64_t waited_ns; /* the thread was ready to run, but no processor ran it */
    int64_t stolen_ns; /* the host of the virtual machine ran something else; in steps of 10 ms */
    long minor, major; /* page faults without and with reading from the disk */
};

/* The thread of that process that has this name; 0: there is none. */
pid_t bench_thread_named(pid_t process, const char *name);

/* Reads the present counts; 0 for those that cannot be read. */
struct bench_account bench_account_of(pid_t process, pid_t thread);

/* later - earlier */
struct bench_account bench_account_between(const struct bench_account *earlier,
                                           const struct bench_account *later);

/* "SCHED_FIFO, priority 20", or "no real-time priority". */
const char *bench_thread_policy(pid_t thread, char *text, size_t size);

/* How many KiB of its memory a process has locked; 0 if this is not known. */
long bench_locked_kib(pid_t process);

#endif
