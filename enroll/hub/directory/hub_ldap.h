/* Reads the people of an LDAP directory (RFC 4511). */
#ifndef ISO_ENROLL_HUB_DIRECTORY_HUB_LDAP_H
#define ISO_ENROLL_HUB_DIRECTORY_HUB_LDAP_H

#include "enroll/hub/directory/hub_directory.h"

struct hub_ldap_group {
    const char *group; /* its name, or its distinguished name */
    struct iso_fleet_id zone;
};

struct hub_ldap_options {
    const char *uri; /* "ldaps://HOST", "ldap://HOST", which begins TLS, or "ldapi://SOCKET" */
    const char *base, *filter; /* filter: NULL: everything below the base */
    const char *map;           /* ldap_map.h; NULL: the standard */
    const char *bind;          /* the name with which it logs in; NULL: none */
    const char *password;      /* with `bind` */
    const char *ca_file;       /* PEM; NULL: the certificates of the system */
    const struct hub_ldap_group *groups;
    size_t n_groups;
};

/* Reads everybody, in pages. The caller frees *out. Nobody is left out: an entry without an id or a
 * name, a time that cannot be read, or a server that does not answer to the end is an error,
 * because whoever is missing in a run loses the zones. Entries with an empty list of groups are in
 * no zone. -EINVAL       an option is not allowed, or the server does not understand the filter
 *   -ENOTCONN     the server does not answer, or TLS fails
 *   -EACCES       the name or the password is wrong
 *   -EBADMSG      an entry cannot be read
 *   -EIO          another refusal of the server; -ENOMEM */
int hub_ldap_read(const struct hub_ldap_options *options, struct hub_named **out, size_t *n,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
