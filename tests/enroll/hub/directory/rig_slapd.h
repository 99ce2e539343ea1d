/* A real slapd in a temporary directory, which is changed by ldapmodify's own format. Failures fail
 * the running cmocka test. */
#ifndef TESTS_ENROLL_HUB_DIRECTORY_RIG_SLAPD_H
#define TESTS_ENROLL_HUB_DIRECTORY_RIG_SLAPD_H

#include <stdbool.h>
#include <sys/types.h>

#define RIG_SLAPD_BASE     "dc=example,dc=org"
#define RIG_SLAPD_ROOT     "cn=admin,dc=example,dc=org"
#define RIG_SLAPD_PASSWORD "admin password"

struct rig_slapd {
    char directory[64], uri[64]; /* uri: ldap://127.0.0.1:PORT */
    char tls_uri[64];            /* ldaps://127.0.0.1:PORT */
    char certificate[96];        /* of the server, which has signed it itself: a file */
    pid_t pid;
};

/* Starts the server with the base, people and groups below it. Returns false, and prints why, if it
 * is not installed. */
bool rig_slapd_start(struct rig_slapd *rig);
void rig_slapd_stop(struct rig_slapd *rig);

/* Adds a person with this uid and name; deletes one. */
void rig_slapd_add(struct rig_slapd *rig, const char *uid, const char *name);
void rig_slapd_delete(struct rig_slapd *rig, const char *uid);

/* Replaces the values of an attribute of a person; NULL: it has none. */
void rig_slapd_set(struct rig_slapd *rig, const char *uid, const char *attribute,
                   const char *value);

/* Adds a person to a group, or takes the person out of it. The server keeps memberOf. */
void rig_slapd_join(struct rig_slapd *rig, const char *group, const char *uid);
void rig_slapd_leave(struct rig_slapd *rig, const char *group, const char *uid);

#endif
