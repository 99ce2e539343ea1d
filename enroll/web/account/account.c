#include "enroll/web/account/account.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/file/file.h"
#include "enroll/web/account/account_list.h"
#include "enroll/web/account/state_file.h"

enum { FILE_MOST_BYTES = 64 << 10 };

struct web_accounts {
    char path[PATH_MAX];
    struct web_account_list list;
};

const char *web_account_name_flaw(const char *name)
{
    const size_t n = strlen(name);

    if (n == 0 || n >= WEB_ACCOUNT_NAME_SIZE) {
        return "the name of an account has 1 to 32 characters";
    }
    if (name[0] < 'a' || name[0] > 'z' ||
        strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789.-_") != n) {
        return "the name of an account has small letters, digits, '.', '-' and '_', and begins "
               "with a letter";
    }
    return NULL;
}

int web_accounts_open(const char *path, struct web_accounts **out, struct iso_fault *fault)
{
    struct web_accounts *accounts = calloc(1, sizeof *accounts);
    char *text = NULL;
    size_t size = 0;
    int r;

    if (!accounts) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", path);
    }
    if (snprintf(accounts->path, sizeof accounts->path, "%s", path) >= (int)sizeof accounts->path) {
        r = iso_file_fault(path, -ENAMETOOLONG, fault);
    } else {
        r = iso_file_read(path, FILE_MOST_BYTES, &text, &size, fault);
        if (r == 0) {
            r = web__account_list_read(text, size, path, &accounts->list, fault);
            sodium_memzero(text, size);
        } else if (r == -ENOENT) {
            r = 0;
        }
    }
    free(text);
    if (r < 0) {
        web_accounts_close(accounts);
        return r;
    }
    *out = accounts;
    return 0;
}

void web_accounts_close(struct web_accounts *accounts)
{
    if (accounts) {
        sodium_memzero(accounts, sizeof *accounts);
        free(accounts);
    }
}

size_t web_accounts_count(const struct web_accounts *accounts)
{
    return accounts->list.n;
}

const struct web_account *web_accounts_at(const struct web_accounts *accounts, size_t index)
{
    return &accounts->list.items[index];
}

const struct web_account *web_accounts_find(const struct web_accounts *accounts, const char *name)
{
    for (size_t i = 0; i < accounts->list.n; i++) {
        if (strcmp(accounts->list.items[i].name, name) == 0) {
            return &accounts->list.items[i];
        }
    }
    return NULL;
}

/* The index of an account; negative errno with a fault. */
static int index_of(const struct web_accounts *accounts, const char *name, struct iso_fault *fault)
{
    const struct web_account *account = web_accounts_find(accounts, name);

    if (!account) {
        return iso_fault_set(fault, -ENOENT, "there is no account of this name");
    }
    return (int)(account - accounts->list.items);
}

/* Writes the changed list to the disk and, if that succeeds, makes it valid. */
static int store(struct web_accounts *accounts, struct web_account_list *changed,
                 struct iso_fault *fault)
{
    char *text = web__account_list_text(changed);
    int r;

    if (!text) {
        r = iso_fault_set(fault, -ENOMEM, "%s: out of memory", accounts->path);
    } else {
        r = web_state_file_write(accounts->path, text, strlen(text), fault);
        sodium_memzero(text, strlen(text));
        free(text);
    }
    if (r == 0) {
        accounts->list = *changed;
    }
    sodium_memzero(changed, sizeof *changed);
    return r;
}

static bool is_last_administrator(const struct web_accounts *accounts, int index)
{
    size_t n = 0;

    for (size_t i = 0; i < accounts->list.n; i++) {
        n += accounts->list.items[i].role == WEB_ROLE_ADMINISTRATOR;
    }
    return n == 1 && accounts->list.items[index].role == WEB_ROLE_ADMINISTRATOR;
}

int web_accounts_add(struct web_accounts *accounts, const char *name, const char *password,
                     enum web_role role, struct iso_fault *fault)
{
    struct web_account_list changed = accounts->list;
    struct web_account *account = &changed.items[changed.n];
    const char *flaw = web_account_name_flaw(name);

    flaw = flaw ? flaw : web_password_flaw(name, password);
    flaw = flaw ? flaw : (role == WEB_ROLE_NONE ? "there is no such role" : NULL);
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (web_accounts_find(accounts, name)) {
        return iso_fault_set(fault, -EEXIST, "there is an account of this name already");
    }
    if (changed.n == WEB_ACCOUNTS_MOST) {
        return iso_fault_set(fault, -ENOSPC, "there are %d accounts already", WEB_ACCOUNTS_MOST);
    }
    *account = (struct web_account){.role = role};
    strcpy(account->name, name);
    if (web_password_hash(password, account->hash)) {
        return iso_fault_set(fault, -ENOMEM, "out of memory for the hash of the password");
    }
    changed.n++;
    return store(accounts, &changed, fault);
}

int web_accounts_set_password(struct web_accounts *accounts, const char *name, const char *password,
                              struct iso_fault *fault)
{
    struct web_account_list changed = accounts->list;
    const int index = index_of(accounts, name, fault);
    const char *flaw = web_password_flaw(name, password);

    if (index < 0) {
        return index;
    }
    if (flaw) {
        return iso_fault_set(fault, -EINVAL, "%s", flaw);
    }
    if (web_password_hash(password, changed.items[index].hash)) {
        return iso_fault_set(fault, -ENOMEM, "out of memory for the hash of the password");
    }
    return store(accounts, &changed, fault);
}

int web_accounts_set_role(struct web_accounts *accounts, const char *name, enum web_role role,
                          struct iso_fault *fault)
{
    struct web_account_list changed = accounts->list;
    const int index = index_of(accounts, name, fault);

    if (index < 0) {
        return index;
    }
    if (role == WEB_ROLE_NONE) {
        return iso_fault_set(fault, -EINVAL, "there is no such role");
    }
    if (role != WEB_ROLE_ADMINISTRATOR && is_last_administrator(accounts, index)) {
        return iso_fault_set(fault, -EBUSY, "this is the last administrator");
    }
    changed.items[index].role = role;
    return store(accounts, &changed, fault);
}

int web_accounts_remove(struct web_accounts *accounts, const char *name, struct iso_fault *fault)
{
    struct web_account_list changed = accounts->list;
    const int index = index_of(accounts, name, fault);

    if (index < 0) {
        return index;
    }
    if (is_last_administrator(accounts, index)) {
        return iso_fault_set(fault, -EBUSY, "this is the last administrator");
    }
    changed.n--;
    memmove(&changed.items[index], &changed.items[index + 1],
            (changed.n - (size_t)index) * sizeof *changed.items);
    return store(accounts, &changed, fault);
}
