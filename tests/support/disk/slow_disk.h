/* A disk that takes its time: fsync and fdatasync of a test program do not return until the test
 * lets them, or until a stated time is over. The linker puts it before the calls of everything that
 * is linked statically (isotherm_slow_disk() in CMake). For tests with threads: the order of things
 * is what they test, and nothing depends on how long something takes. Nothing is synchronised
 * really. */
#ifndef TESTS_SUPPORT_DISK_SLOW_DISK_H
#define TESTS_SUPPORT_DISK_SLOW_DISK_H

/* From now on whoever synchronises waits. */
void slow_disk_hang(void);

/* Who waits goes on, and nobody waits any more. */
void slow_disk_go_on(void);

/* From now on each call takes so many milliseconds; 0: it takes none. */
void slow_disk_take_ms(int ms);

/* How many calls there were; those that wait are among them. */
int slow_disk_calls(void);

/* How many threads wait now. */
int slow_disk_waiting(void);

/* Waits until somebody waits for the disk; fails the test after a minute. */
void slow_disk_await(void);

/* The next call has the process stop (SIGSTOP) before it synchronises. */
void slow_disk_stop_process(void);

#endif
