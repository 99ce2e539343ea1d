/* The daemon gives up rights by itself, however it was started, so that an attacker who exploits a
 * fault of the daemon does not get the whole machine. The unit file
 * (board/generic/isothermd.service.in) takes away the same rights and more from outside; the rights
 * below are given up also where there is no service manager.
 *
 *   memory   no core file, no debugger of the same user; locked, so that no template is paged out
 *   files    (Landlock) nothing can be executed. Only the directories of gallery, log and
 *            lock-out, those of temporary files, and devices can be written. The system's files,
 *            the directories of the loaded libraries, and those of the files that the configuration
 *            names can be read (all files, if the sensor replays recordings, because its slot may
 *            name any)
 *   calls    (seccomp) only those that a daemon with cameras and door lines needs. Sockets other
 *            than local ones and those of the kernel's device news are refused. So are other calls
 *            that are not needed, such as one for a real-time priority. A call that executes or
 *            traces a program, or changes mounts, modules or users, ends the process.
 *
 * "files" does not apply to threads that were started before, as libraries do before main(); the
 * unit file prevents this for the linear algebra. "calls" applies to them. Builds with a sanitizer
 * or coverage confine nothing, because these tools trace and write. */
#ifndef ISO_FIRMWARE_DAEMON_CONFINE_H
#define ISO_FIRMWARE_DAEMON_CONFINE_H

#include "core/base/fault.h"
#include "firmware/config/config.h"

/* Memory; called before anything biometric is read. -EPERM, -ENOMEM with a fault if it cannot be
 * locked; the rest is done even then. */
int iso_confine_memory(struct iso_fault *fault) __attribute__((warn_unused_result));

/* Files, permanently; called before any are opened, and before a thread is started. -ENOSYS the
 * kernel has no Landlock, -ENOTSUP the build confines nothing, or another errno; each with a
 * fault. */
int iso_confine_files(const struct iso_config *config, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The memory that iso_confine_calls may need. A process with limited memory has to reserve it,
 * because that function is called when everything else is open. */
enum { ISO_CONFINE_CALLS_BYTES = 1 << 20 };

/* Calls of all threads, permanently; called when everything is open and the real-time threads run.
 * -ENOTSUP the build confines nothing, -ENOMEM, or another errno; each with a fault. */
int iso_confine_calls(struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
