/* Doors join: what `isotherm-hub door add` and the HTTPS request of a joining door do, without
 * HTTPS, which lets a few doors a second join. */
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "enroll/hub/broker/hub_certificate.h"
#include "enroll/hub/store/hub_door.h"
#include "firmware/fleet/program/tls_key.h"
#include "tests/bench/fleet/fleet_measure.h"

enum { AT_ONCE = 100 /* doors of one transaction */ };

struct batch {
    struct fleet_bench *bench;
    struct hub_ca *ca;
    const char *folder;
    uint32_t first, n;
};

static void write_file(const char *folder, uint32_t door, const char *end, const char *text)
{
    char path[PATH_MAX];
    (void)snprintf(path, sizeof path, "%s/%u%s", folder, door, end);
    FILE *out = fopen(path, "we");
    if (!out || fputs(text, out) < 0 || fclose(out)) {
        fleet_bench_fail(path, "it cannot be written");
    }
}

static int certify(const struct batch *batch, uint32_t number, const struct iso_fleet_id *id,
                   struct iso_fault *fault)
{
    struct hub_store *store = &batch->bench->store;
    struct hub_door_certificate certificate = {.pem = NULL};
    char *key = NULL, *request = NULL;
    int error = link_tls_key_make(&key, fault);
    error = error ? error : link_tls_request(key, "door", &request, fault);
    error = error ? error
                  : hub_ca_sign_door(batch->ca, request, strlen(request), id, store->now_s(),
                                     &certificate, fault);
    error = error ? error : hub_certificate_add(store, id, &certificate, fault);
    if (!error) {
        write_file(batch->folder, number, ".pem", certificate.pem);
        write_file(batch->folder, number, "-key.pem", key);
    }
    free(certificate.pem);
    free(request);
    free(key);
    return error;
}

static int join(const struct batch *batch, uint32_t number, struct iso_fault *fault)
{
    struct hub_store *store = &batch->bench->store;
    struct fleet_table *table = batch->bench->table;
    struct fleet_table_door *row = &table->doors[number];
    struct iso_fleet_bytes membership = {.bytes = NULL};
    uint8_t both[2 * ISO_FLEET_PUBLIC_BYTES];
    char name[32], code[HUB_CODE_SIZE], address[HUB_DOOR_ADDRESS_DIGITS + 1];
    struct iso_fleet_id id;
    (void)crypto_sign_keypair(row->signs.public, row->signs.secret);
    (void)crypto_box_keypair(row->receives.public, row->receives.secret);
    memcpy(both, row->signs.public, ISO_FLEET_PUBLIC_BYTES);
    memcpy(both + ISO_FLEET_PUBLIC_BYTES, row->receives.public, ISO_FLEET_PUBLIC_BYTES);
    (void)sodium_bin2hex(address, sizeof address, both, sizeof both);
    (void)snprintf(name, sizeof name, "door %u", number);
    int error = hub_door_add(store, name, &table->zone, 1, &id, code, fault);
    const struct hub_join wanted = {.code = code, .address = address, .name = ""};
    error = error ? error : hub_door_join(store, &wanted, &id, &membership, fault);
    error = error ? error : certify(batch, number, &id, fault);
    if (!error && membership.size > sizeof row->membership) {
        error = iso_fault_set(fault, -1, "the membership is too long");
    }
    if (!error) {
        memcpy(row->membership, membership.bytes, membership.size);
        row->membership_size = (uint32_t)membership.size;
    }
    iso_fleet_bytes_free(&membership);
    return error;
}

static int join_batch(void *context, struct iso_fault *fault)
{
    const struct batch *batch = context;
    int error = 0;
    for (uint32_t i = 0; !error && i < batch->n; i++) {
        error = join(batch, batch->first + i, fault);
    }
    return error;
}

void fleet_join(struct fleet_bench *bench, uint32_t first, uint32_t n, const char *authority,
                const char *folder)
{
    struct iso_fault fault = {.text = ""};
    struct batch batch = {.bench = bench, .folder = folder};
    const int64_t begun_ns = fleet_table_now_ns();
    if (hub_ca_open(authority, &batch.ca, &fault)) {
        fleet_bench_fail("the authority", fault.text);
    }
    for (uint32_t i = 0; i < n; i += AT_ONCE) {
        batch.first = first + i;
        batch.n = n - i < AT_ONCE ? n - i : AT_ONCE;
        if (hub_db_transaction(bench->store.db, HUB_READ_COMMITTED, join_batch, &batch, &fault)) {
            fleet_bench_fail("joining", fault.text);
        }
    }
    hub_ca_free(batch.ca);
    fleet_bench_print("join_s", 1e-9 * (double)(fleet_table_now_ns() - begun_ns));
}
