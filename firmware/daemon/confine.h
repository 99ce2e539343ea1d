/* What the daemon gives up by itself, however it was started, so that an attacker who exploits a
 * fault of it does not get the whole machine. The unit file (board/generic/isothermd.service.in)
 * takes away the same and more from outside; this holds also where there is no such manager.
 *
 *   memory   no core file, no debugger of the same user; locked, so that no template is paged out
 *   files    (Landlock) nothing is executed; written are only the directories of gallery, log and
 *            lock-out, those of temporary files, and devices; read are the system's files, those
 *            beside the libraries that are loaded, and what the configuration names (all files, if
 *            the sensor replays recordings: its slot may name any)
 *   calls    (seccomp) those that a daemon with cameras and door lines needs. Sockets other than
 *            local ones and those of the kernel's device news are refused, as is what else is not
 *            needed, such as a real-time priority; to execute a program, to trace one or to
 *            change mounts, modules or users ends the process.
 *
 * Threads that were there before are not bound by "files" (those that libraries start before
 * main(); the unit file has the linear algebra start none), but by "calls". Builds with a
 * sanitizer or coverage confine nothing: what watches them traces and writes. */
#ifndef ISO_FIRMWARE_DAEMON_CONFINE_H
#define ISO_FIRMWARE_DAEMON_CONFINE_H

#include "core/base/fault.h"
#include "firmware/config/config.h"

/* Memory; before anything biometric is read. -EPERM, -ENOMEM if it cannot be locked, with a fault;
 * the rest is done even then. */
int iso_confine_memory(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Files, for good; before any are opened, and before a thread is started. -ENOSYS the kernel has
 * no Landlock, -ENOTSUP the build confines nothing, or another errno; each with a fault. */
int iso_confine_files(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* What iso_confine_calls may need of memory: whoever is short of it keeps so much back for it,
 * since that is done when everything else is open. */
enum { ISO_CONFINE_CALLS_BYTES = 1 << 20 };

/* Calls of all threads, for good; when everything is open and the real-time threads run. -ENOTSUP
 * the build confines nothing, -ENOMEM, or another errno; each with a fault. */
int iso_confine_calls(struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
