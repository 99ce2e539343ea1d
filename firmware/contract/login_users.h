/* Which person each Unix user of a machine is: a file for logins by face, read by the PAM module
 * and by the daemon. Whoever can change it can log in as somebody else, so it is read strictly.
 *
 * Each line is `USER PERSON`: the name of a Unix user, one blank, and the name of a person as
 * enrolled, which may contain blanks. Empty lines and lines that begin with '#' are ignored. One
 * person may have several users. Any line that is wrong makes the whole file wrong, and so does a
 * second line of the user who is looked for. The file must belong to root, and nobody else may
 * write it: neither its group nor others. It must be a regular file of at most 64 KiB, and no
 * symbolic link. */
#ifndef ISO_FIRMWARE_CONTRACT_LOGIN_USERS_H
#define ISO_FIRMWARE_CONTRACT_LOGIN_USERS_H

#include <stddef.h>
#include <sys/types.h>

#include "core/base/fault.h"
#include "firmware/contract/person_name.h"

/* The longest name of a Unix user, in bytes without the NUL. */
enum { ISO_LOGIN_USER_BYTES = 255 };

/* Finds the person of a user in a text of `size` bytes, which is changed meanwhile and ends with
 * one more byte, a NUL. `name` is the name of the file in faults. -EBADMSG with a fault: the text
 * breaks a rule above; -ESRCH with a fault: it is right and does not name the user. */
int iso_login_users_parse(const char *name, char *text, size_t size, const char *user,
                          char person[ISO_PERSON_NAME_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* The same for a file. `owner` is the user to whom it must belong: 0, which is root. Also the
 * errors of iso_file_open (drivers/file/file.h), -EPERM with a fault if it has another owner or if
 * others may write it, -ENOMEM, and the errno of read(). */
int iso_login_users_find(const char *path, uid_t owner, const char *user,
                         char person[ISO_PERSON_NAME_SIZE], struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
