/* Runs a program and captures its output. A program that prints nothing for a minute and does not
 * end is killed and fails the test. */
#ifndef TEST_RUN_H
#define TEST_RUN_H

#include <sys/types.h>

enum { RUN_OUTPUT_SIZE = 256 * 1024 };

struct run {
    pid_t pid;          /* 0 after run_finish() */
    int out_fd, err_fd; /* -1 at their end */
    int exit;           /* after run_finish(): the exit code, or 1000 + the signal */
    char what[512];     /* the command line */
    char *out, *err;    /* the output so far, null-terminated */
    size_t out_size, err_size;
};

/* Starts a program. argv ends with NULL; argv[0] is a path. Output beyond RUN_OUTPUT_SIZE fails the
 * test. */
void run_start(struct run *run, const char *const argv[]);

/* The same, with standard output to the file at `out_path`; NULL: captured. */
void run_start_to(struct run *run, const char *const argv[], const char *out_path);

/* Waits until the program has printed `text`. The test fails if the program ends before. */
void run_until(struct run *run, const char *text);

/* Waits until the program ends, and sets run->exit. */
void run_finish(struct run *run);

/* Fails the test unless the program ended with this code. The message has the command, its end and
 * its last line. */
void run_expect(const struct run *run, int exit);

/* Frees the output. */
void run_free(struct run *run);

#endif
