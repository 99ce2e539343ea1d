#include "tests/firmware/faults/storage_acts.h"
#include "tests/firmware/faults/storage_fleet.h"

#include <errno.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/appliance/administration/administration.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/scratch.h"

enum { ANNA = 50, BOB = 80, CARL = 110, DORA = 140, STRANGER = 65, SEGMENT_BYTES = 2500 };

static const struct iso_transfer_lock lock = {.key = {{7}}};

/* ---- the world ---- */

void storage_world_start(struct storage_world *w)
{
    void *state = NULL;
    rig_capacity = 10;
    rig_log = (struct rig_log){.sync = true, .segment_bytes = SEGMENT_BYTES, .segments = 50};
    assert_int_equal(rig_setup_in(&state, strdup(w->directory)), 0);
    w->rig = state;
    (void)snprintf(w->lockout_path, sizeof w->lockout_path, "%s/lockout", w->directory);
    w->rig->borrowed.lockout_path = w->lockout_path;
    w->rig->config.lockout.failures = 1;
    iso_appliance_free(w->rig->appliance);
    assert_int_equal(iso_appliance_new(&w->rig->borrowed, &w->rig->appliance), 0);
    rig_start(w->rig);
}

/* Appends the size and the last byte of the access record of a person, or of the site (0). */
static size_t add_access(const struct iso_gallery *gallery, int64_t id, char *text, size_t size)
{
    size_t n = 0;
    const uint8_t *bytes = iso_gallery_access(gallery, id, &n);
    unsigned sum = 0;
    for (size_t i = 0; i < n; i++) {
        sum = 31 * sum + bytes[i];
    }
    return n > 0 ? (size_t)snprintf(text, size, " access %zu %x", n, sum) : 0;
}

void storage_people(struct iso_gallery *gallery, char *text, size_t size)
{
    size_t n = 0, used = 0;
    const struct iso_person *people = iso_gallery_people(gallery, &n);
    text[0] = '\0';
    for (size_t i = 0; i < n; i++) {
        const struct iso_candidate_list own = iso_gallery_only(gallery, people[i].id);
        if (strcmp(people[i].name, "zoe") == 0) {
            continue;
        }
        used += (size_t)snprintf(text + used, size - used, "%s", people[i].name);
        for (int t = 0; t < own.n_entries; t++) {
            used += (size_t)snprintf(text + used, size - used, " %d",
                                     puppet_face_of(own.entries[t].tmpl));
        }
        used += (size_t)snprintf(text + used, size - used, " %d:%d", (int)people[i].valid_from_s,
                                 (int)people[i].valid_until_s);
        used += add_access(gallery, people[i].id, text + used, size - used);
        used += (size_t)snprintf(text + used, size - used, ", ");
        assert_true(used < size);
    }
    used += add_access(gallery, 0, text + used, size - used);
    used += storage_place(gallery, text + used, size - used);
    assert_true(used < size);
}

void storage_prepare_two(struct storage_world *w)
{
    storage_world_start(w);
    rig_enrol(w->rig, "anna", ANNA);
    rig_enrol(w->rig, "bob", BOB);
    rig_enrol(w->rig, "bob", BOB + 1);
}

/* ---- people ---- */

static int enrol_as(struct storage_world *w, const char *name, int face, struct iso_fault *fault)
{
    const struct iso_enroll_request request = {.person = name};
    struct rig *rig = w->rig;
    int error = iso_appliance_claim(rig->appliance);
    if (!error) {
        error = iso_appliance_enroll(rig->appliance, &request, fault);
    }
    if (error) {
        return error;
    }
    rig_show(rig, face, 3);
    rig_run(rig, 200);
    const char *news = rig_news(rig);
    if (strstr(news, "enroll completed 3/3 done")) {
        return 0;
    }
    return iso_fault_set(fault, strstr(news, "enroll not-stored") ? -EIO : -EPROTO, "%.200s", news);
}

static int enrol(struct storage_world *w, struct iso_fault *fault)
{
    return enrol_as(w, "carl", CARL, fault);
}

static int enrol_again(struct storage_world *w, struct iso_fault *fault)
{
    return enrol_as(w, "anna", ANNA + 1, fault);
}

static int remove_person(struct storage_world *w, struct iso_fault *fault)
{
    return iso_appliance_remove(w->rig->appliance, "bob", fault);
}

static int rename_person(struct storage_world *w, struct iso_fault *fault)
{
    const char *remark = NULL;
    return iso_appliance_rename(w->rig->appliance, "bob", "robert", &remark, fault);
}

static int change_validity(struct storage_world *w, struct iso_fault *fault)
{
    const struct iso_validity_change change = {
        .limits = {5, 2000000000}, .names_from = true, .names_until = true};
    return iso_appliance_set_validity(w->rig->appliance, "bob", &change, fault);
}

static int change_credential(struct storage_world *w, struct iso_fault *fault)
{
    return iso_appliance_set_credential(
        w->rig->appliance, "bob", "{\"cards\": [\"17/4711\"], \"pin\": \"2580\"}", "me", fault);
}

/* Stores a policy, or removes the one that is there. */
static int store_policy(struct storage_world *w, struct iso_fault *fault)
{
    const uint64_t based_on = iso_site_access_revision(iso_appliance_access(w->rig->appliance));
    uint64_t revision = 0;
    return iso_appliance_set_policy(w->rig->appliance,
                                    based_on ? "" : "{\"access_points\": [{\"token\": \"front\"}]}",
                                    based_on, "me", &revision, fault);
}

static void prepare_policy(struct storage_world *w)
{
    storage_prepare_two(w);
    assert_int_equal(store_policy(w, NULL), 0);
    assert_int_equal(change_credential(w, NULL), 0);
}

static int change_credential_again(struct storage_world *w, struct iso_fault *fault)
{
    return iso_appliance_set_credential(w->rig->appliance, "bob", "{\"cards\": [\"17/4712\"]}",
                                        "me", fault);
}

static void prepare_import(struct storage_world *w)
{
    static const char *const people[] = {"carl", "dora", NULL};
    size_t n = 0;
    storage_prepare_two(w);
    rig_enrol(w->rig, "carl", CARL);
    rig_enrol(w->rig, "dora", DORA);
    w->file = memfd_create("people", MFD_CLOEXEC);
    assert_int_equal(
        iso_appliance_export(w->rig->appliance, w->file, people, &lock, NULL, &n, NULL), 0);
    assert_int_equal(iso_appliance_remove(w->rig->appliance, "carl", NULL), 0);
    assert_int_equal(iso_appliance_remove(w->rig->appliance, "dora", NULL), 0);
}

static int import_people(struct storage_world *w, struct iso_fault *fault)
{
    const struct iso_import_request request = {.fd = w->file, .key = &lock.key};
    size_t added = 0, known = 0;
    return iso_appliance_import(w->rig->appliance, &request, &added, &known, fault);
}

/* ---- keys, log, lock-out ---- */

static int rotate_keys(struct storage_world *w, struct iso_fault *fault)
{
    const char *remark = NULL;
    return iso_appliance_rotate_keys(w->rig->appliance, NULL, &remark, fault);
}

/* Appends so many records that the segment ends between two of them. */
static int append(struct storage_world *w, struct iso_fault *fault)
{
    const struct iso_audit_record record = iso_audit_record_of("x");
    int error = 0;
    for (int i = 0; i < 10; i++) {
        const int own = iso_audit_append(w->rig->audit, &record, fault);
        w->records_told += !own;
        error = own ? own : error;
    }
    return error;
}

/* Appends the same records in two groups. The first group reaches the end of the segment. */
static int append_groups(struct storage_world *w, struct iso_fault *fault)
{
    enum { GROUP = 5 };
    const struct iso_audit_record record = iso_audit_record_of("x");
    int error = 0;
    for (int i = 0; i < 2; i++) {
        struct iso_audit_entry entries[GROUP];
        for (int k = 0; k < GROUP; k++) {
            entries[k] = (struct iso_audit_entry){.record = &record};
        }
        iso_audit_append_group(w->rig->audit, entries, GROUP);
        for (int k = 0; k < GROUP; k++) {
            w->records_told += !entries[k].error;
            if (entries[k].error) {
                error = iso_fault_set(fault, entries[k].error, "%s", entries[k].fault.text);
            }
        }
    }
    return error;
}

static int visit(struct storage_world *w, struct iso_fault *fault)
{
    (void)fault;
    rig_show(w->rig, ANNA, 2);
    rig_run(w->rig, 200);
    w->grants_told = strstr(rig_news(w->rig), "visit allow anna") != NULL;
    return 0;
}

static int fail_at_the_door(struct storage_world *w, struct iso_fault *fault)
{
    (void)fault;
    rig_show(w->rig, STRANGER, 20);
    rig_run(w->rig, 1500);
    assert_true(iso_appliance_status(w->rig->appliance).lockout_ns > 0);
    return 0;
}

static int begin_lockdown(struct storage_world *w, struct iso_fault *fault)
{
    return iso_appliance_lockdown(w->rig->appliance, true, fault);
}

static void prepare_lockdown(struct storage_world *w)
{
    storage_prepare_two(w);
    assert_int_equal(iso_appliance_lockdown(w->rig->appliance, true, NULL), 0);
}

static int end_lockdown(struct storage_world *w, struct iso_fault *fault)
{
    return iso_appliance_lockdown(w->rig->appliance, false, fault);
}

/* ---- opening ---- */

static int64_t stand(void *context)
{
    (void)context;
    return INT64_C(1795250000) * ISO_NS_PER_S;
}

static const struct iso_times standing = {.monotonic = {stand, NULL}, .wall_ns = stand};

static int open_stores(struct storage_world *w, struct iso_fault *fault)
{
    struct iso_key_ring *ring = NULL;
    struct iso_gallery *gallery = NULL;
    struct iso_audit *audit = NULL;
    const struct iso_key_place place = {.ring = scratch_path(w->directory, "g.db.keys"),
                                        .file = scratch_path(w->directory, "g.db.key")};
    int error = iso_key_ring_open(&place, &ring, fault);
    const struct iso_gallery_options of_gallery = {.path = scratch_path(w->directory, "g.db"),
                                                   .capacity = 10,
                                                   .algorithm = PUPPET_ALGORITHM,
                                                   .ring = ring,
                                                   .migrate = true};
    const struct iso_audit_options of_audit = {.path = scratch_path(w->directory, "a.log"),
                                               .sync = true,
                                               .segment_bytes = SEGMENT_BYTES,
                                               .segments = 50,
                                               .ring = ring,
                                               .migrate = true};
    if (!error) {
        error = iso_gallery_open(&of_gallery, &gallery, fault);
    }
    if (!error) {
        error = iso_audit_open(&of_audit, &standing, &audit, fault);
    }
    iso_audit_close(audit);
    iso_gallery_close(gallery);
    iso_key_ring_close(ring);
    return error;
}

static void prepare_nothing(struct storage_world *w)
{
    (void)w;
}

static void prepare_stopped(struct storage_world *w)
{
    storage_prepare_two(w);
    iso_appliance_free(w->rig->appliance);
    iso_audit_close(w->rig->audit);
    iso_gallery_close(w->rig->gallery);
    stores_forget();
    w->rig = NULL;
}

/* Writes a gallery in the format of version 1. */
static void make_old_gallery(const char *path)
{
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    sqlite3 *db = NULL;
    sqlite3_stmt *insert = NULL;
    const struct iso_template tmpl = puppet_template(ANNA, PUPPET_ALGORITHM);
    const int size = iso_template_serialise(&tmpl, bytes, sizeof bytes);
    assert_int_equal(sqlite3_open(path, &db), SQLITE_OK);
    assert_int_equal(
        sqlite3_exec(
            db,
            "PRAGMA application_id = 0x49534f54; PRAGMA user_version = 1;"
            "CREATE TABLE person (id INTEGER PRIMARY KEY AUTOINCREMENT, name TEXT NOT NULL UNIQUE,"
            "  enrolled_s INTEGER NOT NULL, valid_from_s INTEGER NOT NULL,"
            "  valid_until_s INTEGER NOT NULL) STRICT;"
            "CREATE TABLE template (id INTEGER PRIMARY KEY AUTOINCREMENT, person_id INTEGER NOT "
            "NULL REFERENCES person (id) ON DELETE CASCADE, algorithm INTEGER NOT NULL, bytes BLOB "
            "NOT NULL) STRICT; CREATE INDEX template_of_person ON template (person_id);"
            "INSERT INTO person VALUES (7, 'Wilhelmina', 1000, 5, 2000)",
            NULL, NULL, NULL),
        SQLITE_OK);
    assert_int_equal(
        sqlite3_prepare_v2(db, "INSERT INTO template VALUES (3, 7, ?1, ?2)", -1, &insert, NULL),
        SQLITE_OK);
    assert_int_equal(sqlite3_bind_int(insert, 1, PUPPET_ALGORITHM), SQLITE_OK);
    assert_int_equal(sqlite3_bind_blob(insert, 2, bytes, size, SQLITE_STATIC), SQLITE_OK);
    assert_int_equal(sqlite3_step(insert), SQLITE_DONE);
    assert_int_equal(sqlite3_finalize(insert), SQLITE_OK);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

static void prepare_old(struct storage_world *w)
{
    make_old_gallery(scratch_path(w->directory, "g.db"));
    scratch_write_text(scratch_path(w->directory, "a.log"),
                       "{\"sequence\":1,\"event\":\"start\"}\n{\"sequence\":2,\"event\":\"x\"}\n");
    w->records_told = 1;
}

const struct storage_act storage_acts[] = {
    {"enrol", storage_prepare_two, enrol, false, false, 1},
    {"enrol again", storage_prepare_two, enrol_again, false, false, 1},
    {"remove", storage_prepare_two, remove_person, false, false, 1},
    {"rename", storage_prepare_two, rename_person, false, false, 1},
    {"validity", storage_prepare_two, change_validity, false, false, 1},
    {"import", prepare_import, import_people, false, false, 1},
    {"credential", storage_prepare_two, change_credential, false, false, 1},
    {"credential again", prepare_policy, change_credential_again, false, false, 1},
    {"policy", storage_prepare_two, store_policy, false, false, 2},
    {"policy removed", prepare_policy, store_policy, false, false, 2},
    {"remove with policy", prepare_policy, remove_person, false, false, 1},
    {"hub put", storage_prepare_put, storage_hear, false, false, 1},
    {"hub remove", storage_prepare_remove, storage_hear, false, false, 1},
    {"hub policy", storage_prepare_hub_policy, storage_hear, false, false, 2},
    {"rotate keys with policy", prepare_policy, rotate_keys, false, false, 1},
    {"rotate keys", storage_prepare_two, rotate_keys, false, false, 1},
    {"log append", storage_prepare_two, append, false, false, 1},
    {"log groups", storage_prepare_two, append_groups, false, false, 5},
    {"visit", storage_prepare_two, visit, false, false, 1},
    {"lock-out", storage_prepare_two, fail_at_the_door, false, true, 1},
    {"lockdown on", storage_prepare_two, begin_lockdown, false, true, 1},
    {"lockdown off", prepare_lockdown, end_lockdown, false, false, 1},
    {"first start", prepare_nothing, open_stores, true, false, 1},
    {"start", prepare_stopped, open_stores, true, false, 1},
    {"upgrade", prepare_old, open_stores, true, false, 1},
};
const size_t storage_acts_n = sizeof storage_acts / sizeof *storage_acts;
