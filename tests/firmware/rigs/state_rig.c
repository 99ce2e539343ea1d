#include "tests/firmware/rigs/state_rig.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/visit/lockout_file.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/devices/manual_clock.h"

/* ---- the stores ---- */

int64_t state_rig_now_ns;
int state_rig_faces;
int (*state_rig_counter)(struct iso_counter *out, struct iso_fault *fault);

static int64_t wall_ns;
static struct puppet_pipeline puppet;

struct iso_parts *state_rig_new(const char *directory, struct iso_fault *fault)
{
    struct iso_parts *parts = calloc(1, sizeof *parts);
    assert_non_null(parts);
    parts->config = iso_config_default();
    parts->times = (struct iso_times){.monotonic = manual_clock(&state_rig_now_ns),
                                      .wall_ns = manual_clock_now_ns,
                                      .wall_context = &wall_ns};
    parts->pipeline = puppet_pipeline(&puppet);
    (void)snprintf(parts->config.gallery.path, sizeof parts->config.gallery.path, "%s/gallery.db",
                   directory);
    (void)snprintf(parts->config.log.path, sizeof parts->config.log.path, "%s/audit.log",
                   directory);
    if (state_rig_counter) {
        struct iso_counter device = {0};
        if (state_rig_counter(&device, fault)) {
            free(parts);
            return NULL;
        }
        assert_int_equal(iso_state_counter_new(&device, &parts->times, &parts->counter), 0);
    }
    return parts;
}

void state_rig_close(struct iso_parts *parts)
{
    parts->pipeline = (struct iso_pipeline){0};
    iso_parts_close(parts);
}

int state_rig_try(const char *directory, struct iso_fault *fault)
{
    struct iso_parts *parts = state_rig_new(directory, fault);
    struct iso_lockout_file file;
    if (!parts) {
        return -EIO;
    }
    int error = iso_parts_open_stores(parts, fault);
    if (!error) {
        error = iso_lockout_load(parts->lockout_path, parts->ring, &file, fault);
        error = error == -ENOENT ? 0 : error;
    }
    state_rig_close(parts);
    return error;
}

struct iso_parts *state_rig_open(const char *directory)
{
    struct iso_fault fault = {.text = ""};
    struct iso_parts *parts = state_rig_new(directory, &fault);
    if (!parts || iso_parts_open_stores(parts, &fault) ||
        iso_parts_begin_counter(parts, false, &fault)) {
        fail_msg("%s", fault.text);
    }
    return parts;
}

/* ---- what happens in between ---- */

void state_rig_append(struct iso_parts *parts, const char *event)
{
    const struct iso_gallery_version version = iso_gallery_version(parts->gallery);
    struct iso_audit_record record = iso_audit_record_of(event);
    record.gallery = strcmp(event, "gallery") == 0 ? version.gallery : NULL;
    record.gallery_changes = version.changes;
    assert_int_equal(iso_audit_append(parts->audit, &record, NULL), 0);
}

void state_rig_enrol(struct iso_parts *parts)
{
    struct iso_person person = {.enrolled_s = 1};
    const struct iso_template tmpl = puppet_template(++state_rig_faces, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "person %d", state_rig_faces);
    state_rig_append(parts, "enroll");
    assert_int_equal(iso_gallery_add(parts->gallery, &person, &tmpl, NULL), 0);
    state_rig_append(parts, "gallery");
}

static void lock_out(struct iso_parts *parts)
{
    const struct iso_lockout_record record = {.failures = 2, .locks = 1};
    state_rig_append(parts, "lockout");
    assert_int_equal(iso_lockout_save(parts->lockout_path, parts->ring, &record, NULL), 0);
}

static void rotate(struct iso_parts *parts)
{
    uint32_t anchor = 0;
    state_rig_append(parts, "rotate-keys");
    assert_int_equal(iso_gallery_rotate(parts->gallery, NULL, NULL), 0);
    assert_int_equal(iso_audit_rotate_key(parts->audit, NULL), 0);
    assert_int_equal(iso_key_ring_add(parts->ring, ISO_KEY_ANCHOR, &anchor, NULL), 0);
    assert_int_equal(iso_gallery_renew_anchor(parts->gallery, NULL), 0);
    assert_int_equal(iso_audit_renew_anchor(parts->audit, NULL), 0);
    lock_out(parts);
    assert_int_equal(iso_key_ring_drop(parts->ring, ISO_KEY_ANCHOR, anchor, NULL), 0);
    assert_int_equal(iso_key_ring_change_key(parts->ring, NULL), 0);
    state_rig_append(parts, "rotate-keys");
}

static void enrolments(struct iso_parts *parts)
{
    for (int i = 0; i < 3; i++) {
        state_rig_enrol(parts);
    }
}

static void one_enrolment(struct iso_parts *parts)
{
    state_rig_append(parts, "claim");
    state_rig_enrol(parts);
    state_rig_append(parts, "visit");
}

static void records(struct iso_parts *parts)
{
    for (int i = 0; i < 5; i++) {
        state_rig_append(parts, "visit");
    }
}

static void lock_outs(struct iso_parts *parts)
{
    for (int i = 0; i < 3; i++) {
        lock_out(parts);
    }
    state_rig_append(parts, "visit");
}

static void segments(struct iso_parts *parts)
{
    for (int i = 0; i < 2; i++) {
        assert_int_equal(iso_audit_rotate_key(parts->audit, NULL), 0);
        records(parts);
    }
}

/* The keys in the ring stay, so that the old ring, with its key, opens everything. */
static void new_key(struct iso_parts *parts)
{
    state_rig_append(parts, "rotate-keys");
    assert_int_equal(iso_key_ring_change_key(parts->ring, NULL), 0);
    state_rig_append(parts, "rotate-keys");
}

static void everything(struct iso_parts *parts)
{
    state_rig_enrol(parts);
    lock_out(parts);
    rotate(parts);
    state_rig_enrol(parts);
    lock_outs(parts);
    records(parts);
}

const struct state_history state_histories[] = {
    {"enrolments", enrolments},
    {"one enrolment", one_enrolment},
    {"records", records},
    {"lock-outs", lock_outs},
    {"closed segments", segments},
    {"rotation of keys", rotate},
    {"the appliance's key", new_key},
    {"everything", everything},
};

const size_t state_n_histories = sizeof state_histories / sizeof *state_histories;

static void play(const char *directory, void (*history)(struct iso_parts *parts),
                 struct mix_state *out)
{
    struct iso_parts *parts = state_rig_open(directory);
    history(parts);
    state_rig_close(parts);
    mix_take(directory, out);
}

void state_rig_play(const char *directory, const char *name, struct mix_state *out)
{
    for (size_t i = 0; i < state_n_histories; i++) {
        if (strcmp(state_histories[i].name, name) == 0) {
            play(directory, state_histories[i].play, out);
            return;
        }
    }
    fail_msg("there is no history '%s'", name);
}

static void begin(struct iso_parts *parts)
{
    enrolments(parts);
    lock_outs(parts);
    rotate(parts);
    state_rig_append(parts, "stop");
}

void state_rig_begin(const char *directory, struct mix_state *out)
{
    play(directory, begin, out);
}

void state_rig_everything(struct iso_parts *parts)
{
    everything(parts);
    segments(parts);
}
