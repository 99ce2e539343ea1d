#include "enroll/web/account/account_list.h"

#include <errno.h>
#include <jansson.h>
#include <stdbool.h>
#include <string.h>

static bool is_hash(const char *hash)
{
    return strncmp(hash, crypto_pwhash_STRPREFIX, strlen(crypto_pwhash_STRPREFIX)) == 0 &&
           strlen(hash) < WEB_PASSWORD_HASH_SIZE;
}

static bool is_known(const struct web_account_list *list, const char *name)
{
    for (size_t i = 0; i < list->n; i++) {
        if (strcmp(list->items[i].name, name) == 0) {
            return true;
        }
    }
    return false;
}

static bool read_account(json_t *item, struct web_account_list *list)
{
    const char *name, *role, *hash;
    struct web_account *account = &list->items[list->n];

    if (json_unpack(item, "{s:s, s:s, s:s !}", "name", &name, "role", &role, "hash", &hash) ||
        web_account_name_flaw(name) || web_role_of(role) == WEB_ROLE_NONE || !is_hash(hash) ||
        is_known(list, name)) {
        return false;
    }
    strcpy(account->name, name);
    strcpy(account->hash, hash);
    account->role = web_role_of(role);
    list->n++;
    return true;
}

int web__account_list_read(const char *text, size_t size, const char *path,
                           struct web_account_list *out, struct iso_fault *fault)
{
    struct web_account_list list = {0};
    json_t *root = json_loadb(text, size, JSON_REJECT_DUPLICATES, NULL), *items, *item;
    bool ok = false;
    int version;
    size_t i;

    if (root && json_unpack(root, "{s:i, s:o !}", "version", &version, "accounts", &items) == 0 &&
        version == 1 && json_is_array(items) && json_array_size(items) <= WEB_ACCOUNTS_MOST) {
        ok = true;
        json_array_foreach(items, i, item)
        {
            ok = ok && read_account(item, &list);
        }
    }
    json_decref(root);
    if (ok) {
        *out = list;
    }
    sodium_memzero(&list, sizeof list);
    return ok ? 0 : iso_fault_set(fault, -EBADMSG, "%s: is not a list of accounts", path);
}

char *web__account_list_text(const struct web_account_list *list)
{
    json_t *items = json_array();
    json_t *root = json_pack("{s:i, s:O}", "version", 1, "accounts", items);
    char *text = NULL;
    bool ok = root != NULL;

    for (size_t i = 0; ok && i < list->n; i++) {
        const struct web_account *a = &list->items[i];
        ok = json_array_append_new(items, json_pack("{s:s, s:s, s:s}", "name", a->name, "role",
                                                    web_role_word(a->role), "hash", a->hash)) == 0;
    }
    if (ok) {
        text = json_dumps(root, JSON_INDENT(2));
    }
    json_decref(root);
    json_decref(items);
    return text;
}
