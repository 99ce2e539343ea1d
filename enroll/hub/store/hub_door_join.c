/* How an appliance becomes a door of the fleet. */
#include <ctype.h>
#include <errno.h>
#include <sodium.h>
#include <stdio.h>
#include <string.h>

#include "enroll/hub/store/hub_act.h"
#include "enroll/hub/store/hub_code.h"
#include "enroll/hub/store/hub_door.h"

static const char letters[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZ234567";

void hub__code_make(char code[HUB_CODE_SIZE], uint8_t digest[ISO_FLEET_DIGEST_BYTES])
{
    uint8_t random[HUB_CODE_SIZE - 1];
    randombytes_buf(random, sizeof random);
    for (size_t i = 0; i < sizeof random; i++) {
        code[i] = letters[random[i] % 32];
    }
    code[HUB_CODE_SIZE - 1] = '\0';
    sodium_memzero(random, sizeof random);
    iso_fleet_digest(code, HUB_CODE_SIZE - 1, digest);
}

int hub__code_digest(const char *code, uint8_t digest[ISO_FLEET_DIGEST_BYTES])
{
    char capital[HUB_CODE_SIZE] = "";
    if (strlen(code) != HUB_CODE_SIZE - 1) {
        return -EINVAL;
    }
    for (size_t i = 0; i < HUB_CODE_SIZE - 1; i++) {
        capital[i] = (char)toupper((unsigned char)code[i]);
        if (!strchr(letters, capital[i])) {
            return -EINVAL;
        }
    }
    iso_fleet_digest(capital, HUB_CODE_SIZE - 1, digest);
    sodium_memzero(capital, sizeof capital);
    return 0;
}

struct work {
    struct hub_store *store;
    const struct hub_join *join;
    uint8_t code_digest[ISO_FLEET_DIGEST_BYTES];
    uint8_t signs[ISO_FLEET_PUBLIC_BYTES], receives[ISO_FLEET_PUBLIC_BYTES];
    struct iso_fleet_id id;
    char name[HUB_NAME_SIZE];
};

static int bad_code(struct iso_fault *fault)
{
    return iso_fault_set(fault, -EACCES,
                         "the code is unknown, used, or older than %d minutes; make a new one with "
                         "isotherm-hub door code",
                         HUB_CODE_VALID_S / 60);
}

/* Finds the door of the code, and locks it. */
static int find_door(struct work *w, struct iso_fault *fault)
{
    struct hub_values values = {.n = 0};
    PGresult *rows = NULL;
    uint8_t before[ISO_FLEET_PUBLIC_BYTES];
    hub_value_bytes(&values, w->code_digest, sizeof w->code_digest);
    hub_value_integer(&values, w->store->now_s());
    int error = hub_db_run(w->store->db,
                           "SELECT id, name, signs FROM door WHERE code_digest = $1 "
                           "AND code_until_s >= $2 AND expelled_s = 0 FOR NO KEY UPDATE",
                           &values, &rows, fault);
    if (error) {
        return error;
    }
    if (PQntuples(rows) == 0) {
        error = bad_code(fault);
    } else {
        w->id = hub_row_id(rows, 0, 0);
        (void)snprintf(w->name, sizeof w->name, "%s", hub_row_text(rows, 0, 1));
        if (hub_row_copy(rows, 0, 2, before, sizeof before) == 0 &&
            memcmp(before, w->signs, sizeof before) != 0) {
            error = iso_fault_set(fault, -EEXIST,
                                  "%s: another appliance has joined as this door; expel it, and "
                                  "add a new door",
                                  w->name);
        }
    }
    PQclear(rows);
    return error;
}

static int join(void *context, struct iso_fault *fault)
{
    struct work *w = context;
    struct hub_values values = {.n = 0};
    int error = find_door(w, fault);
    if (error) {
        return error;
    }
    hub_value_id(&values, &w->id);
    hub_value_bytes(&values, w->signs, sizeof w->signs);
    hub_value_bytes(&values, w->receives, sizeof w->receives);
    hub_value_integer(&values, w->store->now_s());
    error = hub_db_run(w->store->db,
                       "UPDATE door SET signs = $2, receives = $3, joined_s = $4, "
                       "code_digest = NULL, code_until_s = 0 WHERE id = $1",
                       &values, NULL, fault);
    if (error == -EEXIST) {
        return iso_fault_set(
            fault, error, "%s: this appliance has joined as another door of this fleet", w->name);
    }
    return error ? error
                 : hub__act_add(
                       w->store, "door-join", w->name, NULL,
                       json_pack("{s:s,s:s}", "address", w->join->address, "name", w->join->name),
                       fault);
}

static int take_address(struct work *w, struct iso_fault *fault)
{
    const char *text = w->join->address;
    uint8_t both[2 * ISO_FLEET_PUBLIC_BYTES];
    size_t size = 0;
    if (strlen(text) != HUB_DOOR_ADDRESS_DIGITS ||
        sodium_hex2bin(both, sizeof both, text, HUB_DOOR_ADDRESS_DIGITS, NULL, &size, NULL) ||
        size != sizeof both) {
        return iso_fault_set(fault, -EINVAL,
                             "the address of an appliance has %d hexadecimal digits",
                             HUB_DOOR_ADDRESS_DIGITS);
    }
    memcpy(w->signs, both, sizeof w->signs);
    memcpy(w->receives, both + sizeof w->signs, sizeof w->receives);
    return 0;
}

int hub_door_join(struct hub_store *store, const struct hub_join *request,
                  struct iso_fleet_id *door, struct iso_fleet_bytes *membership,
                  struct iso_fault *fault)
{
    struct work w = {.store = store, .join = request};
    char taken[HUB_NAME_SIZE];
    int error = take_address(&w, fault);
    error = error || !*request->name ? error : hub_name_take("door", request->name, taken, fault);
    if (!error && hub__code_digest(request->code, w.code_digest)) {
        error = bad_code(fault);
    }
    error = error ? error : hub_db_transaction(store->db, HUB_READ_COMMITTED, join, &w, fault);
    if (error) {
        return error;
    }
    struct iso_fleet_membership m = {.door = w.id};
    memcpy(m.hub_signs, store->keys.signs.public, sizeof m.hub_signs);
    memcpy(m.hub_receives, store->keys.receives.public, sizeof m.hub_receives);
    memcpy(m.door_signs, w.signs, sizeof m.door_signs);
    (void)snprintf(m.hub_name, sizeof m.hub_name, "%s", store->hub_name);
    (void)snprintf(m.door_name, sizeof m.door_name, "%s", w.name);
    error = iso_fleet_make_membership(&m, &store->keys.signs, membership);
    if (error) {
        return iso_fault_set(fault, error, "%s: no memory", w.name);
    }
    *door = w.id;
    return 0;
}
