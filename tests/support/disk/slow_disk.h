/* A slow disk: fsync and fdatasync of a test program return only when the test permits it, or after
 * a stated time. The linker replaces the calls of all statically linked code by these
 * (isotherm_slow_disk() in CMake). It is for tests with threads, which test the order of events and
 * do not depend on durations. Nothing is really synchronised. */
#ifndef TESTS_SUPPORT_DISK_SLOW_DISK_H
#define TESTS_SUPPORT_DISK_SLOW_DISK_H

/* From now on every call waits. */
void slow_disk_hang(void);

/* Waiting calls return, and later calls do not wait. */
void slow_disk_go_on(void);

/* From now on each call takes this number of milliseconds; 0: no time. */
void slow_disk_take_ms(int ms);

/* The number of calls so far, including those that wait. */
int slow_disk_calls(void);

/* The number of threads that wait now. */
int slow_disk_waiting(void);

/* Waits until a thread waits for the disk; fails the test after a minute. */
void slow_disk_await(void);

/* The next call stops the process (SIGSTOP) before it returns. */
void slow_disk_stop_process(void);

#endif
