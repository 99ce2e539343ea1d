/* Takes from the process what a reader of a file does not need. */
#ifndef ISO_ENROLL_POLICY_READER_CONFINE_H
#define ISO_ENROLL_POLICY_READER_CONFINE_H

/* From now on the process can use 5 seconds of processor time and 512 MiB of memory. It can open no
 * file and start no program; only the descriptors that are open already work. Every system call but
 * a few fails with -EPERM. Returns 0 or a negative errno; the process must not read the file then.
 */
int reader_confine(void);

#endif
