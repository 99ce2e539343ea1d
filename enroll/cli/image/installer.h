/* RAUC, which installs updates of the image: its service de.pengutronix.rauc on the system bus. The
 * package rauc-service describes the interface in
 * /usr/share/dbus-1/interfaces/de.pengutronix.rauc.Installer.xml. */
#ifndef CLI_IMAGE_INSTALLER_H
#define CLI_IMAGE_INSTALLER_H

#include <stdbool.h>

#include "enroll/cli/client/bus.h"
#include "enroll/cli/client/fault.h"
#include "enroll/cli/image/rauc_reply.h"

struct cli_installer;

/* Connects to the bus, and asks RAUC for its state, which starts RAUC if the bus can start it.
 *   CLI_EXIT_NOT_FOUND  no-image: there is no RAUC
 *   CLI_EXIT_NO         access-denied
 *   CLI_EXIT_TIMED_OUT  no-reply
 *   CLI_EXIT_FAULT      no-bus, update-fault (RAUC reports another error) */
enum cli_exit cli_installer_open(const struct cli_bus *bus, struct cli_installer **out,
                                 struct cli_fault *fault) __attribute__((warn_unused_result));

/* Closes the connection. NULL is accepted. */
void cli_installer_close(struct cli_installer *installer);

/* The state when it was asked or reported last. It belongs to the installer. */
const struct cli_installer_state *cli_installer_state(const struct cli_installer *installer);

/* Whether RAUC is at work now. It then answers no question but that for its state. */
bool cli_installer_is_busy(const struct cli_installer *installer);

/* Asks for the slots that the boot loader can start. Faults of cli_installer_open. */
enum cli_exit cli_installer_slots(struct cli_installer *installer, struct cli_slots *out,
                                  struct cli_fault *fault) __attribute__((warn_unused_result));

/* Installs the bundle at `path`, which is absolute, into the slot that does not run, and shows the
 * progress on standard error. cli_interrupt_catch() must have been called. Besides the faults of
 * cli_installer_open:
 *   CLI_EXIT_NO          foreign-key: no bundle that is signed with a key of this image;
 *                        other-board; not-newer; on-trial (the running version is not yet found to
 *                        be good): check-update (board/image/programs) refuses it
 *   CLI_EXIT_FAULT       busy, also if it began after the state was asked; not-installed: any other
 *                        reason, in RAUC's words; update-fault: RAUC has ended
 *   CLI_EXIT_TIMED_OUT   no-reply: RAUC has reported nothing for ten minutes
 *   CLI_EXIT_INTERRUPTED interrupted: RAUC goes on alone */
enum cli_exit cli_installer_install(struct cli_installer *installer, const char *path,
                                    struct cli_fault *fault) __attribute__((warn_unused_result));

#endif
