/* The policy that the daemon has stored. */
#ifndef CLI_POLICY_POLICY_STORE_H
#define CLI_POLICY_POLICY_STORE_H

#include <jansson.h>
#include <stdint.h>

#include "enroll/cli/client/daemon.h"
#include "firmware/policy/document/policy_document.h"

/* Reads a policy with the time zones of this machine. The caller frees *out with
 * iso_policy_document_free(). Returns CLI_EXIT_USAGE "invalid-policy" if the policy is wrong; the
 * line of the fault names the record. */
enum cli_exit cli_policy_read(const char *json, struct iso_policy_document **out,
                              struct cli_fault *fault) __attribute__((warn_unused_result));

/* Asks the daemon for its policy. The caller frees *document, which is "" if there is no policy;
 * then *revision is 0. Faults of cli_daemon_send(), and "bad-reply". */
enum cli_exit cli_policy_fetch(struct cli_daemon *daemon, char **document, uint64_t *revision,
                               struct cli_fault *fault) __attribute__((warn_unused_result));

/* Stores a policy that is based on `revision`; "" removes the policy. *revision becomes that of the
 * new one. The caller releases *remarks, an array of texts. Faults of cli_daemon_send();
 * CLI_EXIT_NO "conflict" if another policy was stored meanwhile. */
enum cli_exit cli_policy_store(struct cli_daemon *daemon, const char *document, uint64_t *revision,
                               json_t **remarks, struct cli_fault *fault)
    __attribute__((warn_unused_result));

/* Lists the changes between two policies; NULL is no policy. Each is an object with "kind", "token"
 * and "change", which is "added", "removed" or "changed". NULL: no memory. */
json_t *cli_policy_changes(const struct iso_policy_document *before,
                           const struct iso_policy_document *after);

#endif
