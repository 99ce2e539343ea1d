/* The accounts of the web server: who may log in, and with which role. They are kept in memory and
 * in one JSON file (mode 0600), which is replaced as a whole before a change becomes valid.
 *
 *   {"version": 1, "accounts": [{"name": "ada", "role": "administrator", "hash": "$argon2id$..."}]}
 *
 * There are at most WEB_ACCOUNTS_MOST accounts. The last administrator can be neither removed nor
 * given another role; otherwise nobody could manage the accounts. A file that is damaged, or that
 * contains a role or member that this version does not know, is refused as a whole. */
#ifndef WEB_ACCOUNT_ACCOUNT_H
#define WEB_ACCOUNT_ACCOUNT_H

#include <stddef.h>

#include "core/base/fault.h"
#include "enroll/web/account/password.h"
#include "enroll/web/account/role.h"

enum {
    WEB_ACCOUNTS_MOST = 64,
    WEB_ACCOUNT_NAME_SIZE = 33, /* with the NUL */
};

struct web_account {
    char name[WEB_ACCOUNT_NAME_SIZE];
    enum web_role role;
    char hash[WEB_PASSWORD_HASH_SIZE]; /* of the password */
};

struct web_accounts;

/* What is wrong with a name for an account; NULL: nothing. A name has 1 to 32 characters: small
 * letters, digits, '.', '-' and '_', the first of them a letter. It appears in the log. */
const char *web_account_name_flaw(const char *name);

/* Reads the accounts. A file that does not exist has none. The caller frees *out. -EBADMSG: the
 * file is damaged; the errors of iso_file_read, with a fault that names the file. */
int web_accounts_open(const char *path, struct web_accounts **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Frees the accounts and wipes the hashes. NULL is accepted. */
void web_accounts_close(struct web_accounts *accounts);

size_t web_accounts_count(const struct web_accounts *accounts);

/* The account of an index below the count, in the order in which they were added. It is valid until
 * the next change. */
const struct web_account *web_accounts_at(const struct web_accounts *accounts, size_t index);

/* The account of a name, or NULL. It is valid until the next change. */
const struct web_account *web_accounts_find(const struct web_accounts *accounts, const char *name);

/* Changes, which return 0, or a negative errno with a fault:
 *   -EINVAL  the name, the password or the role is not allowed
 *   -EEXIST  the name is in use            -ENOSPC  there are too many accounts
 *   -ENOENT  there is no such account      -EBUSY   it is the last administrator
 * and the errors of web_state_file_write. After an error the accounts are as before. */
int web_accounts_add(struct web_accounts *accounts, const char *name, const char *password,
                     enum web_role role, struct iso_fault *fault)
    __attribute__((warn_unused_result));
int web_accounts_set_password(struct web_accounts *accounts, const char *name, const char *password,
                              struct iso_fault *fault) __attribute__((warn_unused_result));
int web_accounts_set_role(struct web_accounts *accounts, const char *name, enum web_role role,
                          struct iso_fault *fault) __attribute__((warn_unused_result));
int web_accounts_remove(struct web_accounts *accounts, const char *name, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
