/* A TPM of the test's own: swtpm, with its memory in a directory of the test's. */
#ifndef TEST_SOFT_TPM_H
#define TEST_SOFT_TPM_H

#include <stdbool.h>
#include <sys/types.h>

struct soft_tpm {
    pid_t pid;    /* 0: it does not run */
    pid_t bridge; /* 0: there is no device */
    int port;
    char tcti[160];     /* how it is reached */
    char device[128];   /* "": it is reached by TCP */
    char directory[96]; /* its memory */
};

/* Begins a TPM that remembers nothing, in DIRECTORY/tpm, which is made. False, with a line that
 * says so, if there is no swtpm on this machine: the test is to be skipped. Anything else that goes
 * wrong fails the test. */
bool soft_tpm_start(struct soft_tpm *tpm, const char *directory);

/* Gives it a device, DIRECTORY/tpm0, as the kernel gives a TPM: a pseudo-terminal, whose other end
 * passes commands on. From now on it is reached by that. */
void soft_tpm_make_device(struct soft_tpm *tpm, const char *directory);

/* Switches it off; and on again, at the same address, with what it remembers. */
void soft_tpm_off(struct soft_tpm *tpm);
void soft_tpm_on(struct soft_tpm *tpm);

/* Switches it off and deletes what it remembers: the next is another TPM. */
void soft_tpm_replace(struct soft_tpm *tpm);

#endif
