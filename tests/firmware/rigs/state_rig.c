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

struct iso_components *state_rig_new(const char *directory, struct iso_fault *fault)
{
    struct iso_components *components = calloc(1, sizeof *components);
    assert_non_null(components);
    components->config = iso_config_default();
    components->times = (struct iso_times){.monotonic = manual_clock(&state_rig_now_ns),
                                           .wall_ns = manual_clock_now_ns,
                                           .wall_context = &wall_ns};
    components->pipeline = puppet_pipeline(&puppet);
    (void)snprintf(components->config.gallery.path, sizeof components->config.gallery.path,
                   "%s/gallery.db", directory);
    (void)snprintf(components->config.log.path, sizeof components->config.log.path, "%s/audit.log",
                   directory);
    if (state_rig_counter) {
        struct iso_counter device = {0};
        if (state_rig_counter(&device, fault)) {
            free(components);
            return NULL;
        }
        components->config.seal.counter = ISO_COUNTER_TPM2;
        assert_int_equal(iso_state_counter_new(&device, &components->times, &components->counter),
                         0);
    }
    return components;
}

void state_rig_close(struct iso_components *components)
{
    components->pipeline = (struct iso_pipeline){0};
    iso_components_close(components);
}

int state_rig_try(const char *directory, struct iso_fault *fault)
{
    struct iso_components *components = state_rig_new(directory, fault);
    struct iso_lockout_file file;
    if (!components) {
        return -EIO;
    }
    int error = iso_components_open_stores(components, fault);
    if (!error) {
        error = iso_lockout_load(components->lockout_path, components->ring, &file, fault);
        error = error == -ENOENT ? 0 : error;
    }
    state_rig_close(components);
    return error;
}

struct iso_components *state_rig_open(const char *directory)
{
    struct iso_fault fault = {.text = ""};
    struct iso_components *components = state_rig_new(directory, &fault);
    if (!components || iso_components_open_stores(components, &fault) ||
        iso_components_begin_counter(components, false, &fault)) {
        fail_msg("%s", fault.text);
    }
    return components;
}

/* ---- histories ---- */

void state_rig_append(struct iso_components *components, const char *event)
{
    const struct iso_gallery_version version = iso_gallery_version(components->gallery);
    struct iso_audit_record record = iso_audit_record_of(event);
    record.gallery = strcmp(event, "gallery") == 0 ? version.gallery : NULL;
    record.gallery_changes = version.changes;
    assert_int_equal(iso_audit_append(components->audit, &record, NULL), 0);
}

void state_rig_enrol(struct iso_components *components)
{
    struct iso_person person = {.enrolled_s = 1};
    const struct iso_template tmpl = puppet_template(++state_rig_faces, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "person %d", state_rig_faces);
    state_rig_append(components, "enroll");
    assert_int_equal(iso_gallery_add(components->gallery, &person, &tmpl, NULL), 0);
    state_rig_append(components, "gallery");
}

static void lock_out(struct iso_components *components)
{
    const struct iso_lockout_record record = {.failures = 2, .locks = 1};
    state_rig_append(components, "lockout");
    assert_int_equal(iso_lockout_save(components->lockout_path, components->ring, &record, NULL),
                     0);
}

static void rotate(struct iso_components *components)
{
    uint32_t anchor = 0;
    state_rig_append(components, "rotate-keys");
    assert_int_equal(iso_gallery_rotate(components->gallery, NULL, NULL), 0);
    assert_int_equal(iso_audit_rotate_key(components->audit, NULL), 0);
    assert_int_equal(iso_key_ring_add(components->ring, ISO_KEY_ANCHOR, &anchor, NULL), 0);
    assert_int_equal(iso_gallery_renew_anchor(components->gallery, NULL), 0);
    assert_int_equal(iso_audit_renew_anchor(components->audit, NULL), 0);
    lock_out(components);
    assert_int_equal(iso_key_ring_drop(components->ring, ISO_KEY_ANCHOR, anchor, NULL), 0);
    assert_int_equal(iso_key_ring_change_key(components->ring, NULL), 0);
    state_rig_append(components, "rotate-keys");
}

static void enrolments(struct iso_components *components)
{
    for (int i = 0; i < 3; i++) {
        state_rig_enrol(components);
    }
}

static void one_enrolment(struct iso_components *components)
{
    state_rig_append(components, "claim");
    state_rig_enrol(components);
    state_rig_append(components, "visit");
}

static void records(struct iso_components *components)
{
    for (int i = 0; i < 5; i++) {
        state_rig_append(components, "visit");
    }
}

static void lock_outs(struct iso_components *components)
{
    for (int i = 0; i < 3; i++) {
        lock_out(components);
    }
    state_rig_append(components, "visit");
}

static void segments(struct iso_components *components)
{
    for (int i = 0; i < 2; i++) {
        assert_int_equal(iso_audit_rotate_key(components->audit, NULL), 0);
        records(components);
    }
}

/* Changes only the key that seals the ring. The keys in the ring stay, so that the earlier ring
 * with its earlier key opens every store. */
static void new_key(struct iso_components *components)
{
    state_rig_append(components, "rotate-keys");
    assert_int_equal(iso_key_ring_change_key(components->ring, NULL), 0);
    state_rig_append(components, "rotate-keys");
}

static void everything(struct iso_components *components)
{
    state_rig_enrol(components);
    lock_out(components);
    rotate(components);
    state_rig_enrol(components);
    lock_outs(components);
    records(components);
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

static void play(const char *directory, void (*history)(struct iso_components *components),
                 struct mix_state *out)
{
    struct iso_components *components = state_rig_open(directory);
    history(components);
    state_rig_close(components);
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

static void begin(struct iso_components *components)
{
    enrolments(components);
    lock_outs(components);
    rotate(components);
    state_rig_append(components, "stop");
}

void state_rig_begin(const char *directory, struct mix_state *out)
{
    play(directory, begin, out);
}

void state_rig_everything(struct iso_components *components)
{
    everything(components);
    segments(components);
}
