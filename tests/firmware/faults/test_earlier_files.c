/* Files of an earlier time. The daemon must refuse every mixture of earlier and present files. It
 * must not take the files of an interrupted write for such a mixture. The tests open the stores as
 * the daemon does. */
#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/visit/lockout_file.h"
#include "tests/firmware/rigs/puppet_counter.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/firmware/rigs/state_rig.h"
#include "tests/support/scratch.h"

/* ---- subsets ---- */

static size_t tried, refused;

static int opens(const char *directory, const struct mix_state *state)
{
    struct iso_fault fault = {.text = ""};
    mix_put_back(directory, state);
    const int error = state_rig_try(directory, &fault);
    if (error) {
        print_message("%s\n", fault.text);
    }
    return error;
}

/* Asserts that these files are refused, in one line that names a file of the directory. */
static void expect_refusal(const char *directory, const struct mix_state *state, const char *what,
                           unsigned mask)
{
    struct iso_fault fault = {.text = ""};
    mix_put_back(directory, state);
    const int error = state_rig_try(directory, &fault);
    tried++;
    refused += error != 0;
    if (!error || !strstr(fault.text, directory) || strchr(fault.text, '\n')) {
        for (size_t i = 0; i < state->n; i++) {
            print_message("  %s\n", state->files[i].name);
        }
        fail_msg("%s: subset %#x: %s", what, mask, error ? fault.text : "accepted");
    }
}

/* Tries all mixtures of two directories except the two directories themselves. */
static void expect_no_mixture(const char *directory, const struct mix_state *a,
                              const struct mix_state *b, const char *what)
{
    char names[MIX_FILES_MAX][MIX_NAME_SIZE];
    struct mix_state mixed;
    const size_t n = mix_differing(a, b, names);
    assert_true(n >= 2);
    for (unsigned mask = 1; mask < (1u << n) - 1; mask++) {
        mix_states(a, b, names, n, mask, &mixed);
        expect_refusal(directory, &mixed, what, mask);
    }
    print_message("%-18s %zu files differ: %u mixtures refused\n", what, n, (1u << n) - 2);
}

struct world {
    char *directory;
    struct mix_state before;
};

static int setup(void **state)
{
    static struct world world;
    void *directory = NULL;
    state_rig_faces = 0;
    if (scratch_setup(&directory)) {
        return -1;
    }
    world.directory = directory;
    state_rig_begin(world.directory, &world.before);
    *state = &world;
    return 0;
}

static int teardown(void **state)
{
    struct world *world = *state;
    void *directory = world->directory;
    mix_let_go(&world->before);
    return scratch_teardown(&directory);
}

static void every_subset_of_earlier_files_is_refused(void **state)
{
    const struct world *world = *state;
    for (size_t i = 0; i < state_n_histories; i++) {
        struct mix_state after;
        mix_put_back(world->directory, &world->before);
        state_rig_play(world->directory, state_histories[i].name, &after);
        expect_no_mixture(world->directory, &world->before, &after, state_histories[i].name);
        assert_int_equal(opens(world->directory, &world->before), 0);
        assert_int_equal(opens(world->directory, &after), 0);
        mix_let_go(&after);
    }
    print_message("%zu subsets of earlier files, %zu refused\n", tried, refused);
}

static void files_of_two_histories_are_refused(void **state)
{
    const struct world *world = *state;
    struct mix_state one, other;
    mix_put_back(world->directory, &world->before);
    state_rig_play(world->directory, "enrolments", &one);
    mix_put_back(world->directory, &world->before);
    state_rig_play(world->directory, "enrolments", &other);
    expect_no_mixture(world->directory, &one, &other, "two histories");
    mix_let_go(&one);
    mix_let_go(&other);
}

/* Whether no file, or only the key, is left. This is a new appliance without any people. */
static bool is_new(const struct mix_state *state)
{
    return state->n == 0 || (state->n == 1 && strcmp(state->files[0].name, "gallery.db.key") == 0);
}

static void every_subset_of_missing_files_is_refused(void **state)
{
    const struct world *world = *state;
    const struct mix_state *whole = &world->before;
    for (unsigned mask = 1; mask < 1u << whole->n; mask++) {
        struct mix_state rest = {.n = 0};
        for (size_t i = 0; i < whole->n; i++) {
            if (!(mask & 1u << i)) {
                rest.files[rest.n++] = whole->files[i];
            }
        }
        if (!is_new(&rest)) {
            expect_refusal(world->directory, &rest, "missing files", mask);
        }
    }
}

/* ---- the previous version ---- */

static void expect_people_of_before(struct iso_components *components)
{
    static const char *const names[] = {"Anna Ek", "Bert"};
    for (int i = 0; i < 2; i++) {
        const struct iso_person *person = iso_gallery_find(components->gallery, names[i]);
        assert_non_null(person);
        assert_int_equal(person->enrolled_s, 1000 + i);
        const struct iso_candidate_list own = iso_gallery_only(components->gallery, person->id);
        assert_int_equal(own.n_entries, 1);
        assert_int_equal(puppet_face_of(own.entries[0].tmpl), 50 + 30 * i);
    }
}

/* The directory state_1 was written by the last version in which a store did not record the counts
 * of the other stores. */
static void a_directory_of_the_version_before_is_upgraded(void **state)
{
    const struct world *world = *state;
    struct mix_state before, after;
    struct iso_lockout_file file;
    struct iso_audit_report report;
    mix_take(ISOTHERM_SOURCE_DIR "/tests/firmware/state_1", &before);
    assert_int_equal(before.n, 8);
    mix_put_back(world->directory, &before);
    struct iso_components *components = state_rig_open(world->directory);
    expect_people_of_before(components);
    assert_int_equal(iso_audit_verify(components->audit, 0, NULL, NULL, &report, NULL), 0);
    assert_true(report.sound);
    assert_int_equal(report.first, 1);
    assert_int_equal(report.last, 5);
    assert_int_equal(iso_lockout_load(components->lockout_path, components->ring, &file, NULL), 0);
    assert_int_equal(file.number, 0);
    assert_int_equal(file.record.failures, 5);
    assert_int_equal(file.record.remaining_ns, 119500 * ISO_NS_PER_MS);
    state_rig_close(components);
    state_rig_play(world->directory, "everything", &after);
    components = state_rig_open(world->directory);
    expect_people_of_before(components);
    assert_int_equal(iso_audit_verify(components->audit, 0, NULL, NULL, &report, NULL), 0);
    assert_true(report.sound);
    state_rig_close(components);
    expect_no_mixture(world->directory, &before, &after, "version before");
    mix_let_go(&before);
    mix_let_go(&after);
}

/* ---- an administrator ---- */

static void accept(const char *directory, const char *expected)
{
    struct iso_fault why, fault = {.text = ""};
    struct iso_components *components = state_rig_new(directory, &fault);
    if (iso_components_accept_stores(components, &why, &fault)) {
        fail_msg("%s", fault.text);
    }
    assert_non_null(strstr(why.text, expected));
    state_rig_close(components);
}

static int find_accepted(void *context, const char *line)
{
    int *n = context;
    *n += strstr(line, "\"event\":\"state-accepted\"") && strstr(line, "earlier time");
    return 0;
}

/* Replaces the files of these names by their earlier versions (by_older), or removes them. */
static void replace(const struct world *world, const char *const *names, bool by_older)
{
    char path[MIX_PATH_SIZE];
    for (; *names; names++) {
        const struct mix_file *file = mix_find(&world->before, *names);
        assert_non_null(file);
        if (by_older) {
            mix_put(world->directory, file);
        } else {
            mix_path_of(path, world->directory, *names);
            assert_int_equal(unlink(path), 0);
        }
    }
}

static void an_administrator_accepts_an_older_gallery(void **state)
{
    static const char *const older[] = {"gallery.db", "gallery.db.anchor", NULL};
    const struct world *world = *state;
    struct mix_state after;
    struct iso_fault fault = {.text = ""};
    int n = 0;
    mix_put_back(world->directory, &world->before);
    state_rig_play(world->directory, "enrolments", &after);
    replace(world, older, true);
    assert_int_equal(state_rig_try(world->directory, &fault), -ESTALE);
    assert_non_null(strstr(fault.text, "/gallery.db: from an earlier time"));
    accept(world->directory, "/gallery.db: from an earlier time");
    accept(world->directory, ""); /* no difference is left to accept */
    struct iso_components *components = state_rig_open(world->directory);
    assert_int_equal(iso_audit_read(components->audit, 1, UINT32_MAX, find_accepted, &n), 0);
    assert_int_equal(n, 2);
    state_rig_close(components);
    mix_let_go(&after);
}

static void stores_accepted_without_a_lock_out_file_begin_a_lockdown(void **state)
{
    static const char *const lost[] = {"audit.log", "audit.log.anchor", "lockout",
                                       "audit.log.00000000000000000001", NULL};
    const struct world *world = *state;
    struct iso_lockout_file file;
    struct iso_fault fault = {.text = ""};
    mix_put_back(world->directory, &world->before);
    replace(world, lost, false);
    assert_int_equal(state_rig_try(world->directory, &fault), -ESTALE);
    accept(world->directory, "/audit.log: from an earlier time");
    struct iso_components *components = state_rig_open(world->directory);
    assert_int_equal(iso_lockout_load(components->lockout_path, components->ring, &file, &fault),
                     0);
    assert_true(file.record.lockdown);
    state_rig_close(components);
}

/* ---- interruptions ---- */

static const char *watched; /* the directory whose state is kept after every call; or NULL */
static struct mix_state *moments;
enum { MOMENTS_MAX = 600 };
static struct puppet_counter counts[MOMENTS_MAX]; /* the counter at each of these moments */
static struct puppet_counter counter;
static size_t n_moments;

static void moment(void)
{
    if (watched) {
        const char *directory = watched;
        watched = NULL;
        assert_true(n_moments < MOMENTS_MAX);
        counts[n_moments] = counter;
        mix_take(directory, &moments[n_moments++]);
        watched = directory;
    }
}

#define WRAP(type, name, parameters, arguments)      \
    type __real_##name parameters;                   \
    type __wrap_##name parameters;                   \
    type __wrap_##name parameters                    \
    {                                                \
        const type result = __real_##name arguments; \
        const int number = errno;                    \
        moment();                                    \
        errno = number;                              \
        return result;                               \
    }

WRAP(ssize_t, write, (int fd, const void *bytes, size_t size), (fd, bytes, size))
WRAP(ssize_t, pwrite, (int fd, const void *bytes, size_t size, off_t at), (fd, bytes, size, at))
WRAP(int, rename, (const char *from, const char *to), (from, to))
WRAP(int, renameat2, (int fd, const char *from, int to_fd, const char *to, unsigned flags),
     (fd, from, to_fd, to, flags))
WRAP(int, fsync, (int fd), (fd))
WRAP(int, fdatasync, (int fd), (fd))
WRAP(int, unlink, (const char *path), (path))

static int open_counter(struct iso_counter *out, struct iso_fault *fault)
{
    (void)fault;
    *out = puppet_counter(&counter);
    return 0;
}

/* Keeps the files after every call that changes one, from a start of the daemon to its end. Then
 * checks that the stores open with each of these states. */
static void try_interruptions(const struct world *world)
{
    struct mix_state after;
    moments = calloc(MOMENTS_MAX, sizeof *moments);
    assert_non_null(moments);
    n_moments = 0;
    mix_put_back(world->directory, &world->before);
    watched = world->directory;
    struct iso_components *components = state_rig_open(world->directory);
    state_rig_everything(components);
    state_rig_close(components);
    watched = NULL;
    mix_take(world->directory, &after);
    for (size_t i = 0; i < n_moments; i++) {
        counter = counts[i];
        assert_int_equal(opens(world->directory, &moments[i]), 0);
        mix_let_go(&moments[i]);
    }
    assert_true(n_moments > 100);
    print_message("%zu interruptions, all of them open\n", n_moments);
    free(moments);
    mix_let_go(&after);
}

static void no_interruption_is_taken_for_an_attack(void **state)
{
    try_interruptions(*state);
}

/* These states include the moments between the write of the anchor and the increment of the
 * counter. */
static void no_interruption_with_a_counter_is_taken_for_an_attack(void **state)
{
    const struct world *world = *state;
    counter = (struct puppet_counter){.incremented = moment};
    state_rig_counter = open_counter;
    mix_put_back(world->directory, &world->before);
    state_rig_close(state_rig_open(world->directory)); /* begins to use the counter */
    struct world counted = *world;
    mix_take(world->directory, &counted.before);
    try_interruptions(&counted);
    mix_let_go(&counted.before);
    state_rig_counter = NULL;
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)
    const struct CMUnitTest tests[] = {
        TEST(every_subset_of_earlier_files_is_refused),
        TEST(files_of_two_histories_are_refused),
        TEST(every_subset_of_missing_files_is_refused),
        TEST(a_directory_of_the_version_before_is_upgraded),
        TEST(an_administrator_accepts_an_older_gallery),
        TEST(stores_accepted_without_a_lock_out_file_begin_a_lockdown),
        TEST(no_interruption_is_taken_for_an_attack),
        TEST(no_interruption_with_a_counter_is_taken_for_an_attack),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
