/* A software TPM for one test: swtpm, with its memory in a directory of the test. */
#ifndef TEST_SOFT_TPM_H
#define TEST_SOFT_TPM_H

#include <stdbool.h>
#include <sys/types.h>

struct soft_tpm {
    pid_t pid;    /* 0: swtpm does not run */
    pid_t bridge; /* 0: there is no device */
    int port;
    char tcti[160];     /* its address for the TPM libraries */
    char device[128];   /* "": clients reach it by TCP */
    char directory[96]; /* the directory of its memory */
};

/* Makes DIRECTORY/tpm and starts a TPM with empty memory there. If there is no swtpm on this
 * machine, prints a line and returns false: the caller then skips the test. Any other failure fails
 * the test.
 */
bool soft_tpm_start(struct soft_tpm *tpm, const char *directory);

/* Gives the TPM a device, DIRECTORY/tpm0, as the kernel does: a pseudo-terminal whose other end
 * passes on the commands. From now on clients reach the TPM by this device. */
void soft_tpm_make_device(struct soft_tpm *tpm, const char *directory);

/* Switches the TPM off; and on again, at the same address, with its memory. */
void soft_tpm_off(struct soft_tpm *tpm);
void soft_tpm_on(struct soft_tpm *tpm);

/* Replaces the TPM with another one: switches it off, deletes its memory, and switches it on again
 * at the same address. */
void soft_tpm_replace(struct soft_tpm *tpm);

#endif
