/* The commands. Each prints its result on stdout and remarks on stderr, and returns the exit code
 * of the program. If a command could not do its work, it fills in *fault. */
#ifndef CLI_COMMANDS_COMMANDS_H
#define CLI_COMMANDS_COMMANDS_H

#include "enroll/cli/arguments/arguments.h"
#include "enroll/cli/client/daemon.h"
#include "enroll/cli/client/fault.h"
#include "enroll/cli/machine/places.h"

enum cli_exit cli_enroll(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_identify(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault);
enum cli_exit cli_verify(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_list(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                       struct cli_fault *fault);
enum cli_exit cli_remove(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_validity(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault);
enum cli_exit cli_rename(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_status(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_site(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                       struct cli_fault *fault);
enum cli_exit cli_log(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                      struct cli_fault *fault);
enum cli_exit cli_log_verify(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                             struct cli_fault *fault);
enum cli_exit cli_export(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_import(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_key(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                      struct cli_fault *fault);
enum cli_exit cli_aim(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                      struct cli_fault *fault);
enum cli_exit cli_lockdown(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault);
enum cli_exit cli_lockout(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                          struct cli_fault *fault);
enum cli_exit cli_settings(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                           struct cli_fault *fault);
enum cli_exit cli_door_test(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                            struct cli_fault *fault);

enum cli_exit cli_panel(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                        struct cli_fault *fault);

enum cli_exit cli_policy(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                         struct cli_fault *fault);
enum cli_exit cli_policy_import(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                                struct cli_fault *fault);
enum cli_exit cli_policy_test(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                              struct cli_fault *fault);
enum cli_exit cli_credential(struct cli_daemon *daemon, const struct cli_arguments *arguments,
                             struct cli_fault *fault);

/* Opens the bus itself, because a bus that cannot be reached is one of its findings. */
enum cli_exit cli_doctor(const struct cli_arguments *arguments, struct cli_fault *fault);

/* Needs no connection to the daemon, because it starts the daemon. */
enum cli_exit cli_setup(const struct cli_arguments *arguments, struct cli_fault *fault);

/* Needs no connection to the daemon either: it asks the program isotherm-web. */
enum cli_exit cli_web(const struct cli_web_places *places, const struct cli_arguments *arguments,
                      struct cli_fault *fault);

/* Needs no connection to the daemon: it asks RAUC. */
enum cli_exit cli_update(const struct cli_image_places *places,
                         const struct cli_arguments *arguments, struct cli_fault *fault);

/* Asks the daemon, and in an image RAUC, if they answer. */
enum cli_exit cli_version(const struct cli_image_places *places,
                          const struct cli_arguments *arguments, struct cli_fault *fault);

/* Needs no connection either: it stops the daemon. */
enum cli_exit cli_factory_reset(const struct cli_reset_places *places,
                                const struct cli_arguments *arguments, struct cli_fault *fault);

#endif
