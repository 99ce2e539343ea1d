/* How the entries of an LDAP directory become people. Pure. Internal to this room, and for its
 * tests. */
#ifndef ISO_ENROLL_HUB_DIRECTORY_LDAP_MAP_H
#define ISO_ENROLL_HUB_DIRECTORY_LDAP_MAP_H

#include "enroll/hub/directory/hub_directory.h"

enum { HUB__ATTRIBUTE_SIZE = 64 };

/* Which attribute of an entry says what; "": none does. */
struct hub__ldap_map {
    char id[HUB__ATTRIBUTE_SIZE], name[HUB__ATTRIBUTE_SIZE], group[HUB__ATTRIBUTE_SIZE];
    char disabled[HUB__ATTRIBUTE_SIZE], from[HUB__ATTRIBUTE_SIZE], until[HUB__ATTRIBUTE_SIZE];
};

/* Reads "name=displayName,id=objectGUID,disabled=userAccountControl,until=accountExpires"; what it
 * does not name is id=entryUUID, name=cn, group=memberOf, and no limits. NULL: this alone. -EINVAL.
 */
int hub__ldap_map_read(const char *text, struct hub__ldap_map *out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* An id as text: printable ASCII stays as it is, other bytes (objectGUID) become hexadecimal.
 * -EINVAL it is empty or too long. */
int hub__ldap_id(const void *bytes, size_t size, char out[HUB_EXTERNAL_SIZE])
    __attribute__((warn_unused_result));

/* Whether a value of the group's attribute is this group: the whole value or, if it is a
 * distinguished name, the value of its first part ("cn=Staff,ou=groups,dc=example" is "staff"). */
bool hub__ldap_is_group(const char *value, const char *group);

/* Whether a value says that the account is disabled: of userAccountControl the bit 2, of every
 * other attribute anything but "", "FALSE" and "0". */
bool hub__ldap_is_disabled(const char *attribute, const char *value);

/* A time, in seconds since 1970: a GeneralizedTime in UTC ("20261231235959Z"), or the 100 ns since
 * 1601 of Active Directory. 0: no limit, also for its "never". -EINVAL it is neither. */
int hub__ldap_time(const char *text, int64_t *out) __attribute__((warn_unused_result));

#endif
