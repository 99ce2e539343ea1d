#include "enroll/hub/scim/scim_token.h"

#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"

enum { SECRET_BYTES = 32, USED_EVERY_S = 60 };

static const char prefix[] = "isotherm-scim-";

void hub_scim_token_digest(const char *token, size_t length, uint8_t out[HUB_SCIM_DIGEST_BYTES])
{
    (void)crypto_hash_sha256(out, (const unsigned char *)token, length);
}

int hub__scim_token_use(struct hub_store *store, const uint8_t digest[HUB_SCIM_DIGEST_BYTES],
                        struct iso_fault *fault)
{
    struct hub_values values = {.n = 0}, used = {.n = 0};
    PGresult *rows = NULL;
    const int64_t now_s = store->now_s();

    hub_value_bytes(&values, digest, HUB_SCIM_DIGEST_BYTES);
    int error = hub_db_run(store->db, "SELECT name, used_s FROM scim_token WHERE digest = $1",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0) {
        error = iso_fault_set(fault, -EACCES, "the token is not valid");
    } else {
        (void)snprintf(store->actor, sizeof store->actor, "scim:%s", hub_row_text(rows, 0, 0));
        if (now_s - hub_row_integer(rows, 0, 1) >= USED_EVERY_S) {
            hub_value_bytes(&used, digest, HUB_SCIM_DIGEST_BYTES);
            hub_value_integer(&used, now_s);
            error = hub_db_run(store->db, "UPDATE scim_token SET used_s = $2 WHERE digest = $1",
                               &used, NULL, fault);
        }
    }
    PQclear(rows);
    return error;
}

/* ---- what administrators do ---- */

struct work {
    struct hub_store *store;
    const char *name;
    uint8_t digest[HUB_SCIM_DIGEST_BYTES];
};

static int make(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_values values = {.n = 0};

    hub_value_text(&values, w->name);
    hub_value_bytes(&values, w->digest, sizeof w->digest);
    hub_value_integer(&values, w->store->now_s());
    const int error = hub_db_run(
        w->store->db, "INSERT INTO scim_token (name, digest, added_s) VALUES ($1, $2, $3)", &values,
        NULL, fault);
    if (error) {
        return error == -EEXIST
                   ? iso_fault_set(fault, error, "%s: there is a token of this name", w->name)
                   : error;
    }
    return hub__act_add(w->store, "scim-token-add", w->name, NULL, NULL, fault);
}

int hub_scim_token_make(struct hub_store *store, const char *name, char token[HUB_SCIM_TOKEN_SIZE],
                        struct iso_fault *fault)
{
    struct work w = {.store = store, .name = name};
    uint8_t secret[SECRET_BYTES];
    char text[HUB_SCIM_TOKEN_SIZE];

    if (!*name || strlen(name) >= HUB_SCIM_NAME_SIZE ||
        name[strspn(name, "abcdefghijklmnopqrstuvwxyz0123456789.-")]) {
        return iso_fault_set(fault, -EINVAL,
                             "%.80s: the name of a token has at most %d small letters, digits, "
                             "dots and hyphens",
                             name, HUB_SCIM_NAME_SIZE - 1);
    }
    randombytes_buf(secret, sizeof secret);
    (void)strcpy(text, prefix);
    (void)sodium_bin2base64(text + strlen(prefix), sizeof text - strlen(prefix), secret,
                            sizeof secret, sodium_base64_VARIANT_URLSAFE_NO_PADDING);
    sodium_memzero(secret, sizeof secret);
    hub_scim_token_digest(text, strlen(text), w.digest);
    const int error = hub_db_transaction(store->db, HUB_READ_COMMITTED, make, &w, fault);
    if (!error) {
        (void)strcpy(token, text);
    }
    sodium_memzero(text, sizeof text);
    return error;
}

static int revoke(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    struct hub_values values = {.n = 0};
    PGresult *result = NULL;

    hub_value_text(&values, w->name);
    int error = hub_db_run(w->store->db, "DELETE FROM scim_token WHERE name = $1", &values, &result,
                           fault);
    if (!error && hub_db_changed(result) == 0) {
        error = iso_fault_set(fault, -ENOENT, "%s: there is no such token", w->name);
    }
    PQclear(result);
    return error ? error : hub__act_add(w->store, "scim-token-remove", w->name, NULL, NULL, fault);
}

int hub_scim_token_revoke(struct hub_store *store, const char *name, struct iso_fault *fault)
{
    struct work w = {.store = store, .name = name};

    return hub_db_transaction(store->db, HUB_READ_COMMITTED, revoke, &w, fault);
}

int hub_scim_token_each(struct hub_store *store,
                        int (*each)(void *context, const struct hub_scim_token *token),
                        void *context, struct iso_fault *fault)
{
    PGresult *rows = NULL;
    int error = hub_db_run(store->db, "SELECT name, added_s, used_s FROM scim_token ORDER BY name",
                           NULL, &rows, fault);

    for (int i = 0; !error && i < PQntuples(rows); i++) {
        const struct hub_scim_token token = {.name = hub_row_text(rows, i, 0),
                                             .added_s = hub_row_integer(rows, i, 1),
                                             .used_s = hub_row_integer(rows, i, 2)};
        error = each(context, &token);
    }
    PQclear(rows);
    return error;
}
