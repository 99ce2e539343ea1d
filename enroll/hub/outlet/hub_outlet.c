#include "enroll/hub/outlet/hub_outlet.h"

#include <errno.h>
#include <gnutls/gnutls.h>
#include <gnutls/x509.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/outlet/address.h"
#include "enroll/hub/outlet/batch.h"
#include "enroll/hub/store/hub_act.h"
#include "firmware/contract/log_events.h"

enum { SECRET_LEAST = 16, NEW_SECRET_BYTES = 32 };

struct work {
    struct hub_store *store;
    const struct hub_outlet_options *options;
    struct iso_fleet_id id;
    const char *name, *secret;
};

const char *hub_outlet_kind_word(enum hub_outlet_kind kind)
{
    return kind == HUB_OUTLET_WEBHOOK ? "webhook" : "syslog";
}

/* ---- what is allowed ---- */

static bool is_event(const char *word, size_t length)
{
    static const char *const events[] = {ISO_CONTRACT_EVENTS};
    for (size_t i = 0; i < sizeof events / sizeof *events; i++) {
        if (strlen(events[i]) == length && strncmp(events[i], word, length) == 0) {
            return true;
        }
    }
    return false;
}

static int check_events(const char *list, struct iso_fault *fault)
{
    if (strlen(list) >= HUB_OUTLET_EVENTS_SIZE) {
        return iso_fault_set(fault, -EINVAL, "the list of events is too long");
    }
    for (const char *at = *list ? list : NULL; at;) {
        const size_t length = strcspn(at, ",");
        if (!is_event(at, length)) {
            return iso_fault_set(fault, -EINVAL, "there is no event '%.*s'", (int)length, at);
        }
        at = at[length] ? at + length + 1 : NULL;
    }
    return 0;
}

/* A secret of printable ASCII can be typed wherever the receiver keeps it. */
static int check_secret(const char *secret, struct iso_fault *fault)
{
    const size_t length = strlen(secret);
    bool printable = true;
    for (size_t i = 0; i < length; i++) {
        printable = printable && secret[i] > ' ' && secret[i] < 0x7f;
    }
    return length >= SECRET_LEAST && length < HUB_OUTLET_SECRET_SIZE && printable
               ? 0
               : iso_fault_set(fault, -EINVAL,
                               "a secret has %d to %d letters, digits or signs, without blanks",
                               SECRET_LEAST, HUB_OUTLET_SECRET_SIZE - 1);
}

static int check_ca(const char *pem, struct iso_fault *fault)
{
    const gnutls_datum_t text = {.data = (unsigned char *)(uintptr_t)pem,
                                 .size = (unsigned)strlen(pem)};
    gnutls_x509_trust_list_t list;
    if (gnutls_x509_trust_list_init(&list, 0) < 0) {
        return iso_fault_set(fault, -ENOMEM, "certificates: no memory");
    }
    const int n = gnutls_x509_trust_list_add_trust_mem(list, &text, NULL, GNUTLS_X509_FMT_PEM, 0,
                                                       0);
    gnutls_x509_trust_list_deinit(list, 1);
    return n > 0 ? 0 : iso_fault_set(fault, -EINVAL, "the file contains no certificates in PEM");
}

static int check(const struct hub_outlet_options *options, struct iso_fault *fault)
{
    char name[HUB_NAME_SIZE];
    struct hub__address address;
    int error = hub_name_take("outlet", options->name, name, fault);
    error = error ? error : hub__address_read(options->kind, options->address, &address, fault);
    error = error || !options->events ? error : check_events(options->events, fault);
    error = error || !options->ca ? error : check_ca(options->ca, fault);
    if (!error && options->ca && address.scheme != HUB__HTTPS && address.scheme != HUB__TLS) {
        error = iso_fault_set(fault, -EINVAL, "%s: certificates belong to https:// or tls://",
                              options->address);
    }
    if (error || !options->secret) {
        return error;
    }
    return options->kind == HUB_OUTLET_WEBHOOK
               ? check_secret(options->secret, fault)
               : iso_fault_set(fault, -EINVAL, "syslog has no secret");
}

/* ---- changes ---- */

static int insert(const struct work *w, struct iso_fault *fault)
{
    const struct hub_outlet_options *o = w->options;
    struct iso_fleet_bytes sealed = {.bytes = NULL};
    struct hub_values values = {.n = 0};
    int error = *w->secret ? hub_keys_seal(&w->store->keys, "outlet-secret", &w->id, w->secret,
                                           strlen(w->secret), &sealed)
                           : 0;
    if (error) {
        return iso_fault_set(fault, error, "%s: no memory", o->name);
    }
    hub_value_id(&values, &w->id);
    hub_value_text(&values, o->name);
    hub_value_text(&values, hub_outlet_kind_word(o->kind));
    hub_value_text(&values, o->address);
    hub_value_bytes(&values, sealed.bytes, sealed.size);
    hub_value_text(&values, o->ca);
    hub_value_text(&values, o->events ? o->events : "");
    hub_value_integer(&values, w->store->now_s());
    error = hub_db_run(w->store->db,
                       "INSERT INTO outlet (id, name, kind, address, secret, ca, events, added_s) "
                       "VALUES ($1, $2, $3, $4, $5, $6, $7, $8)",
                       &values, NULL, fault);
    iso_fleet_bytes_free(&sealed);
    return error == -EEXIST
               ? iso_fault_set(fault, error, "%s: there is an outlet of this name", o->name)
               : error;
}

/* An outlet begins with the next events, unless it is to begin with the first. */
static int begin_now(const struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    hub_value_id(&values, &w->id);
    return hub_db_run(w->store->db,
                      "INSERT INTO outlet_cursor (outlet, door, number, batch_number) "
                      "SELECT $1, id, acked, acked FROM door WHERE acked > 0",
                      &values, NULL, fault);
}

static int add(void *context, struct iso_fault *fault)
{
    const struct work *w = context;
    int error = insert(w, fault);
    error = error || w->options->from_beginning ? error : begin_now(w, fault);
    return error ? error
                 : hub__act_add(w->store, "outlet-add", w->options->name, NULL,
                                json_pack("{s:s,s:s,s:s}", "kind",
                                          hub_outlet_kind_word(w->options->kind), "address",
                                          w->options->address, "events",
                                          w->options->events ? w->options->events : ""),
                                fault);
}

static void make_secret(char out[HUB_OUTLET_SECRET_SIZE])
{
    uint8_t bytes[NEW_SECRET_BYTES];
    randombytes_buf(bytes, sizeof bytes);
    (void)sodium_bin2hex(out, HUB_OUTLET_SECRET_SIZE, bytes, sizeof bytes);
    sodium_memzero(bytes, sizeof bytes);
}

int hub_outlet_add(struct hub_store *store, const struct hub_outlet_options *options,
                   char secret[HUB_OUTLET_SECRET_SIZE], struct iso_fault *fault)
{
    char taken[HUB_OUTLET_SECRET_SIZE] = "";
    struct work w = {
        .store = store, .options = options, .id = iso_fleet_id_random(), .secret = taken};
    int error = check(options, fault);
    if (error) {
        return error;
    }
    if (options->secret) {
        (void)snprintf(taken, sizeof taken, "%s", options->secret);
    } else if (options->kind == HUB_OUTLET_WEBHOOK) {
        make_secret(taken);
    }
    error = hub_db_transaction(store->db, HUB_READ_COMMITTED, add, &w, fault);
    if (!error) {
        memcpy(secret, taken, sizeof taken);
    }
    sodium_memzero(taken, sizeof taken);
    return error;
}

/* Runs a statement whose $1 is the name, and records the act. */
static int change(const struct work *w, const char *sql, const char *what, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *result = NULL;
    hub_value_text(&values, w->name);
    const int error = hub_db_run(w->store->db, sql, &values, &result, fault);
    if (error) {
        return error;
    }
    const bool found = hub_db_changed(result) == 1;
    PQclear(result);
    return found ? hub__act_add(w->store, what, w->name, NULL, NULL, fault)
                 : iso_fault_set(fault, -ENOENT, "%s: there is no such outlet", w->name);
}

static int remove_it(void *context, struct iso_fault *fault)
{
    return change(context, "DELETE FROM outlet WHERE name = $1", "outlet-remove", fault);
}

int hub_outlet_remove(struct hub_store *store, const char *name, struct iso_fault *fault)
{
    struct work w = {.store = store, .name = name};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, remove_it, &w, fault);
}

static int resume(void *context, struct iso_fault *fault)
{
    return change(context,
                  "UPDATE outlet SET stopped = false, failures = 0, next_attempt_ms = 0 "
                  "WHERE name = $1",
                  "outlet-resume", fault);
}

int hub_outlet_resume(struct hub_store *store, const char *name, struct iso_fault *fault)
{
    struct work w = {.store = store, .name = name};
    return hub_db_transaction(store->db, HUB_READ_COMMITTED, resume, &w, fault);
}
