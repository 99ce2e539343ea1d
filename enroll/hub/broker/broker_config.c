#include "enroll/hub/broker/broker_config.h"

#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "drivers/file/file.h"
#include "enroll/hub/broker/ca_inner.h"
#include "enroll/hub/broker/hub_certificate.h"
#include "enroll/hub/broker/hub_pair.h"

/* Lets the broker, whose group the folder has, read the file. */
static int share(const char *folder, const char *path, struct iso_fault *fault)
{
    struct stat s;

    if (stat(folder, &s)) {
        return iso_file_fault(folder, -errno, fault);
    }
    const uid_t owner = geteuid() == 0 ? s.st_uid : (uid_t)-1;
    if (lchown(path, owner, s.st_gid) && errno != EPERM) {
        return iso_file_fault(path, -errno, fault);
    }
    return chmod(path, 0640) ? iso_file_fault(path, -errno, fault) : 0;
}

static int put(const char *folder, const char *name, const char *text, size_t size, bool *changed,
               struct iso_fault *fault)
{
    char path[PATH_MAX];
    int r = hub__path(path, sizeof path, folder, name, fault);

    if (r < 0 || iso_data_file_holds(path, text, size)) {
        return r;
    }
    r = iso_data_file_replace(path, text, size, fault);
    r = r < 0 ? r : share(folder, path, fault);
    *changed = *changed || r == 0;
    return r;
}

/* ---- who may do what ---- */

static int add_door(void *context, const struct hub_door *door)
{
    broker_text_door(context, door);
    return 0;
}

static int put_rights(struct hub_store *store, const char *folder, bool *changed,
                      struct iso_fault *fault)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);

    if (!out) {
        return iso_fault_set(fault, -ENOMEM, "out of memory for the rights of the doors");
    }
    broker_text_hub(out);
    int r = hub_door_each(store, false, add_door, out, fault);
    if (fclose(out) && r == 0) {
        r = iso_fault_set(fault, -ENOMEM, "out of memory for the rights of the doors");
    }
    r = r ? r : put(folder, "acl", text, size, changed, fault);
    free(text);
    return r;
}

/* A list has its time and a new signature each time, so it is made anew only if its contents have
 * changed: the digest of its serial numbers is kept beside it. */
static int put_revoked(struct hub_store *store, const struct hub_ca *ca, const char *folder,
                       bool *changed, struct iso_fault *fault)
{
    uint8_t(*serials)[HUB_CA_SERIAL_BYTES] = NULL, digest[ISO_FLEET_DIGEST_BYTES];
    char path[PATH_MAX], list_path[PATH_MAX], *pem = NULL, *old = NULL;
    size_t n = 0, size = 0;
    crypto_generichash_state state;
    int r = hub__path(path, sizeof path, folder, "crl.of", fault);

    r = r < 0 ? r : hub__path(list_path, sizeof list_path, folder, "crl.pem", fault);
    r = r < 0 ? r : hub_certificate_revoked(store, &serials, &n, fault);
    if (r < 0) {
        return r;
    }
    (void)crypto_generichash_init(&state, NULL, 0, sizeof digest);
    (void)crypto_generichash_update(&state, hub_ca_digest(ca), HUB_CA_DIGEST_BYTES);
    (void)crypto_generichash_update(&state, (const uint8_t *)serials, n * sizeof *serials);
    (void)crypto_generichash_final(&state, digest, sizeof digest);
    if (iso_data_file_holds(path, digest, sizeof digest) &&
        iso_file_read(list_path, INT_MAX, &old, &size, NULL) == 0) {
        free(old);
        free(serials);
        return 0;
    }
    r = hub_ca_revoke(ca, serials, n, store->now_s(), &pem, fault);
    r = r < 0 ? r : put(folder, "crl.pem", pem, strlen(pem), changed, fault);
    r = r < 0 ? r : iso_data_file_replace(path, digest, sizeof digest, fault);
    free(pem);
    free(serials);
    return r;
}

int broker_config_look(struct hub_store *store, int64_t *mark, bool *changed,
                       struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;

    hub_value_integer(&values, *mark);
    const int r = hub_db_run(store->db,
                             "SELECT coalesce(max(number), $1)::bigint, "
                             "coalesce(bool_or(what LIKE 'door-%'), false) "
                             "FROM act WHERE number > $1",
                             &values, &rows, fault);
    if (r == 0) {
        *mark = hub_row_integer(rows, 0, 0);
        *changed = hub_row_switch(rows, 0, 1);
        PQclear(rows);
    }
    return r;
}

int broker_config_follow(struct hub_store *store, const struct hub_ca *ca, const char *folder,
                         bool *changed, struct iso_fault *fault)
{
    bool is_changed = false;
    int r = put_rights(store, folder, &is_changed, fault);

    r = r < 0 ? r : put_revoked(store, ca, folder, &is_changed, fault);
    if (r == 0) {
        *changed = is_changed;
    }
    return r;
}

/* ---- the whole folder ---- */

static int put_config(const struct broker_places *places, bool *changed, struct iso_fault *fault)
{
    char *text = NULL;
    size_t size = 0;
    FILE *out = open_memstream(&text, &size);

    if (!out) {
        return iso_fault_set(fault, -ENOMEM, "out of memory for mosquitto.conf");
    }
    broker_text_config(out, places);
    int r = fclose(out) ? iso_fault_set(fault, -ENOMEM, "out of memory for mosquitto.conf") : 0;
    r = r < 0 ? r : put(places->folder, "mosquitto.conf", text, size, changed, fault);
    free(text);
    return r;
}

static int put_pair(struct hub_store *store, const struct hub_ca *ca, const char *folder,
                    enum hub_pair_use use, const char *const *hosts, size_t n, bool *changed,
                    struct iso_fault *fault)
{
    char key[PATH_MAX], chain[PATH_MAX];
    struct hub_pair pair;
    int r = hub__path(key, sizeof key, folder, hub_pair_key_name(use), fault);

    r = r < 0 ? r : hub__path(chain, sizeof chain, folder, hub_pair_chain_name(use), fault);
    r = r < 0 ? r : hub_pair_open(ca, folder, use, hosts, n, store->now_s(), &pair, fault);
    if (r < 0) {
        return r;
    }
    r = share(folder, key, fault);
    r = r < 0 ? r : share(folder, chain, fault);
    *changed = *changed || pair.is_new;
    hub_pair_free(&pair);
    return r;
}

int broker_config_write(struct hub_store *store, const struct hub_ca *ca,
                        const struct broker_places *places, const char *const *hosts, size_t n,
                        bool *changed, struct iso_fault *fault)
{
    const char *pem = hub_ca_pem(ca);
    bool is_changed = false, follows = false;
    int r = put(places->folder, "ca.pem", pem, strlen(pem), &is_changed, fault);

    r = r < 0 ? r
              : put_pair(store, ca, places->folder, HUB_PAIR_BROKER, hosts, n, &is_changed, fault);
    if (r == 0 && places->home_assistant) {
        r = put_pair(store, ca, places->folder, HUB_PAIR_HOME, NULL, 0, &is_changed, fault);
    }
    r = r < 0 ? r : broker_config_follow(store, ca, places->folder, &follows, fault);
    r = r < 0 ? r : put_config(places, &is_changed, fault);
    if (r == 0) {
        *changed = is_changed || follows;
    }
    return r;
}
