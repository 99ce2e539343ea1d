/* The vectors that a gallery stores beside its templates, so that the next start need not make
 * them. Each test compares what a start finds with the vectors of the templates themselves. */
#include <errno.h>
#include <signal.h>
#include <sqlite3.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/base/crc32.h"
#include "firmware/gallery/gallery.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

enum { PEOPLE = 120, DIMENSIONS = 5 }; /* a start stores the vectors of so many people */

/* Counts the templates that are read (the linker puts this function in place of the real one). */
static int n_parsed;

int __real_iso_template_parse(const void *bytes, size_t size, struct iso_template *out);
int __wrap_iso_template_parse(const void *bytes, size_t size, struct iso_template *out);
int __wrap_iso_template_parse(const void *bytes, size_t size, struct iso_template *out)
{
    n_parsed++;
    return __real_iso_template_parse(bytes, size, out);
}

struct world {
    char *directory;
    struct iso_metric *metric; /* the caller frees it */
    struct iso_gallery_options options;
};

static struct world new_world(void **state)
{
    struct world world = {
        .directory = *state, .metric = gallery_rig_new_metric(), .options = stores_gallery(*state)};
    world.options.capacity = PEOPLE + 2;
    world.options.metric = world.metric;
    return world;
}

static struct iso_gallery *open_gallery(const struct world *world)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    n_parsed = 0;
    if (iso_gallery_open(&world->options, &gallery, &fault)) {
        fail_msg("%s", fault.text);
    }
    return gallery;
}

/* Imports "person 0" and so on; the template of each has the person's number as its face. */
static void make_people(const struct world *world)
{
    static struct iso_gallery_item items[PEOPLE];
    static uint8_t bytes[PEOPLE][ISO_TEMPLATE_BYTES_MAX];
    size_t added = 0;
    for (int i = 0; i < PEOPLE; i++) {
        const struct iso_template tmpl = puppet_template(i, PUPPET_ALGORITHM);
        const int size = iso_template_serialise(&tmpl, bytes[i], sizeof bytes[i]);
        assert_true(size > 0);
        (void)snprintf(items[i].person.name, sizeof items[i].person.name, "person %d", i);
        items[i].n = 1;
        items[i].templates[0].algorithm = PUPPET_ALGORITHM;
        items[i].templates[0].bytes = bytes[i];
        items[i].templates[0].size = (size_t)size;
    }
    struct iso_gallery *gallery = open_gallery(world);
    assert_int_equal(iso_gallery_import(gallery, items, PEOPLE, false, NULL, &added, NULL), 0);
    iso_gallery_close(gallery);
}

/* The same, and a start that stores their vectors. */
static void make_stored(const struct world *world)
{
    make_people(world);
    iso_gallery_close(open_gallery(world));
}

static void add_face(struct iso_metric_vector *all, const struct iso_metric *metric, int face)
{
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    struct iso_metric_vector one;
    assert_int_equal(iso_metric_project(metric, &tmpl, &one), 0);
    iso_metric_vector_add(metric, &one, all);
}

/* Expects the vector of person `number`, to the bit: of the own face, and of `second` if it is not
 * negative. */
static void expect_vector(struct iso_gallery *gallery, const struct world *world, int number,
                          int second)
{
    char name[32];
    struct iso_metric_vector wanted = {.n = 0}, found;
    (void)snprintf(name, sizeof name, "person %d", number);
    const struct iso_person *person = iso_gallery_find(gallery, name);
    assert_non_null(person);
    add_face(&wanted, world->metric, number);
    if (second >= 0) {
        add_face(&wanted, world->metric, second);
    }
    assert_int_equal(iso_index_find(iso_gallery_everybody(gallery).index, person->id, &found), 0);
    assert_int_equal(found.n, wanted.n);
    assert_memory_equal(&found.weight, &wanted.weight, sizeof found.weight);
    assert_memory_equal(&found.scale, &wanted.scale, sizeof found.scale);
    assert_memory_equal(found.mean, wanted.mean, DIMENSIONS * sizeof(float));
    assert_true((int)person->templates == wanted.n && (int)person->usable == wanted.n);
}

static void expect_everybody(struct iso_gallery *gallery, const struct world *world)
{
    assert_int_equal(iso_index_size(iso_gallery_everybody(gallery).index), PEOPLE);
    for (int i = 0; i < PEOPLE; i++) {
        expect_vector(gallery, world, i, -1);
    }
}

/* Opens and closes the gallery, and expects that it reads this number of templates. */
static void expect_start(const struct world *world, int parsed)
{
    struct iso_gallery *gallery = open_gallery(world);
    assert_int_equal(n_parsed, parsed);
    expect_everybody(gallery, world);
    iso_gallery_close(gallery);
}

/* A number that a query of g.db gives. */
static int ask(const struct world *world, const char *sql)
{
    sqlite3 *db = NULL;
    sqlite3_stmt *query = NULL;
    assert_int_equal(sqlite3_open(scratch_path(world->directory, "g.db"), &db), SQLITE_OK);
    assert_int_equal(sqlite3_prepare_v2(db, sql, -1, &query, NULL), SQLITE_OK);
    assert_int_equal(sqlite3_step(query), SQLITE_ROW);
    const int answer = sqlite3_column_int(query, 0);
    (void)sqlite3_finalize(query);
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
    return answer;
}

/* ---- what they are for ---- */

static void the_second_start_reads_no_template(void **state)
{
    const struct world world = new_world(state);
    make_people(&world);
    struct iso_gallery *gallery = open_gallery(&world);
    const struct iso_gallery_version before = iso_gallery_version(gallery);
    assert_int_equal(n_parsed, PEOPLE);
    expect_everybody(gallery, &world);
    iso_gallery_close(gallery);
    assert_int_equal(ask(&world, "SELECT count(*) FROM vector"), PEOPLE);

    expect_start(&world, 0);
    gallery = open_gallery(&world);
    assert_int_equal(iso_gallery_version(gallery).changes, before.changes);
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

static void few_vectors_are_not_stored(void **state)
{
    const struct world world = new_world(state);
    struct iso_gallery *gallery = open_gallery(&world);
    assert_int_equal(gallery_rig_add_number(gallery, 1, NULL), 0);
    iso_gallery_close(gallery);
    iso_gallery_close(open_gallery(&world));
    assert_int_equal(ask(&world, "SELECT count(*) FROM sqlite_schema WHERE name = 'vector'"), 0);
    iso_metric_free(world.metric);
}

/* Only new templates are read. */
static void people_who_came_later_are_made_at_the_start(void **state)
{
    const struct world world = new_world(state);
    make_stored(&world);
    struct iso_gallery *gallery = open_gallery(&world);
    struct iso_person person = {.name = "person 7"};
    const struct iso_template tmpl = puppet_template(300, PUPPET_ALGORITHM);
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, NULL), 0);
    assert_int_equal(gallery_rig_add_number(gallery, PEOPLE, NULL), 0);
    iso_gallery_close(gallery);
    gallery = open_gallery(&world);
    assert_int_equal(n_parsed, 2);
    for (int i = 0; i <= PEOPLE; i++) {
        expect_vector(gallery, &world, i, i == 7 ? 300 : -1);
    }
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

static void a_vector_goes_with_its_template(void **state)
{
    const struct world world = new_world(state);
    make_stored(&world);
    struct iso_gallery *gallery = open_gallery(&world);
    assert_int_equal(iso_gallery_remove(gallery, "person 5", NULL), 0);
    iso_gallery_close(gallery);
    assert_int_equal(ask(&world, "SELECT count(*) FROM vector"), PEOPLE - 1);
    gallery = open_gallery(&world);
    assert_int_equal(n_parsed, 0);
    assert_null(iso_gallery_find(gallery, "person 5"));
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

static void a_new_key_deletes_them(void **state)
{
    const struct world world = new_world(state);
    make_stored(&world);
    struct iso_gallery *gallery = open_gallery(&world);
    assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
    iso_gallery_close(gallery);
    assert_int_equal(ask(&world, "SELECT count(*) FROM vector"), 0);
    expect_start(&world, PEOPLE);
    expect_start(&world, 0);
    iso_metric_free(world.metric);
}

static void another_metric_makes_its_own(void **state)
{
    struct world world = new_world(state);
    make_stored(&world);
    world.metric->axis[3] = 0.5f;
    expect_start(&world, PEOPLE);
    expect_start(&world, 0);
    world.metric->weight_min = 0.125f;
    expect_start(&world, PEOPLE);
    iso_metric_free(world.metric);
}

/* Vectors that an earlier program has stored are taken as they are. If this test fails because
 * vectors are computed in another way, the label of stored vectors (gallery_seal.c) needs the next
 * number, and the test the new checksum. */
static void a_new_way_of_making_vectors_needs_a_new_label(void **state)
{
#ifdef __FP_FAST_FMA
    (void)state;
    skip(); /* the compiler may join products and sums, which changes the last bits */
#else
    const struct world world = new_world(state);
    uint32_t sum = 0;
    for (int face = 0; face < PEOPLE; face++) {
        const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
        struct iso_metric_vector one;
        assert_int_equal(iso_metric_project(world.metric, &tmpl, &one), 0);
        sum = iso_crc32(sum, one.mean, DIMENSIONS * sizeof(float));
        sum = iso_crc32(sum, &one.scale, sizeof one.scale);
        sum = iso_crc32(sum, &one.step, sizeof one.step);
    }
    assert_int_equal(sum, 0x5cc8e469u);
    iso_metric_free(world.metric);
#endif
}

/* Without a metric templates are in memory, and vectors are left as they are. */
static void without_a_metric_they_are_not_used(void **state)
{
    struct world world = new_world(state);
    make_stored(&world);
    world.options.metric = NULL;
    struct iso_gallery *gallery = open_gallery(&world);
    assert_int_equal(n_parsed, PEOPLE);
    assert_int_equal(iso_gallery_everybody(gallery).n_entries, PEOPLE);
    iso_gallery_close(gallery);
    world.options.metric = world.metric;
    expect_start(&world, 0);
    iso_metric_free(world.metric);
}

/* ---- what is damaged ---- */

/* Rows of templates that are not what was stored, although their vectors are sound. */
static void a_changed_template_is_found_in_spite_of_its_vector(void **state)
{
    static const char *const changes[] = {
        "UPDATE template SET record = CAST(substr(record, 1, length(record) - 16) || zeroblob(16) "
        "AS BLOB) WHERE id = 20",
        "UPDATE template SET record = (SELECT record FROM template WHERE id = 22) WHERE id = 20",
        "UPDATE template SET person_id = 3 WHERE id = 20",
        "UPDATE template SET algorithm = algorithm + 1 WHERE id = 20",
        "UPDATE template SET record = zeroblob(0) WHERE id = 20",
        "DELETE FROM vector WHERE id = 20; DELETE FROM template WHERE id = 20",
    };
    const struct world world = new_world(state);
    make_stored(&world);
    stores_copy_file(*state, "g.db", "sound");
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        struct iso_gallery *gallery = NULL;
        struct iso_fault fault = {.text = ""};
        gallery_rig_execute(*state, changes[i]);
        const int error = iso_gallery_open(&world.options, &gallery, &fault);
        const char *text = i + 1 < sizeof changes / sizeof *changes ? "the record of template 20"
                                                                    : "records are missing";
        if (error != -EBADMSG || !strstr(fault.text, text)) {
            fail_msg("%d, '%s' after %s", error, fault.text, changes[i]);
        }
        stores_copy_file(*state, "sound", "g.db");
    }
    expect_start(&world, 0);
    iso_metric_free(world.metric);
}

/* Vectors that are damaged, exchanged or missing are made again; nothing else changes. */
static void a_changed_vector_is_not_used(void **state)
{
    static const struct {
        const char *sql;
        int made;
    } changes[] = {
        {"UPDATE vector SET record = CAST(substr(record, 1, length(record) - 16) || zeroblob(16) "
         "AS BLOB) WHERE id = 20",
         1},
        {"UPDATE vector SET record = (SELECT record FROM vector WHERE id = 22) WHERE id = 20", 1},
        {"UPDATE vector SET record = zeroblob(length(record)) WHERE id = 20", 1},
        {"UPDATE vector SET record = zeroblob(0) WHERE id = 20", 1},
        {"UPDATE vector SET record = zeroblob(100000) WHERE id = 20", 1},
        {"DELETE FROM vector WHERE id <= 20", 10},
    };
    const struct world world = new_world(state);
    make_stored(&world);
    stores_copy_file(*state, "g.db", "sound");
    for (size_t i = 0; i < sizeof changes / sizeof *changes; i++) {
        gallery_rig_execute(*state, changes[i].sql);
        expect_start(&world, changes[i].made);
        stores_copy_file(*state, "sound", "g.db");
    }
    gallery_rig_execute(*state, "DROP TABLE vector");
    expect_start(&world, PEOPLE);
    iso_metric_free(world.metric);
}

static void a_full_disk_stores_none(void **state)
{
    const struct world world = new_world(state);
    struct stat status;
    struct rlimit unlimited;
    make_people(&world);
    assert_int_equal(stat(scratch_path(*state, "g.db"), &status), 0);
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &unlimited), 0);
    const struct rlimit limit = {.rlim_cur = (rlim_t)status.st_size,
                                 .rlim_max = unlimited.rlim_max};
    assert_true(signal(SIGXFSZ, SIG_IGN) != SIG_ERR);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
    struct iso_gallery *gallery = open_gallery(&world);
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &unlimited), 0);
    assert_int_equal(iso_gallery_state(gallery, NULL), 0);
    expect_everybody(gallery, &world);
    assert_int_equal(gallery_rig_add_number(gallery, PEOPLE, NULL), 0);
    assert_int_equal(iso_gallery_remove(gallery, "person 120", NULL), 0);
    iso_gallery_close(gallery);
    expect_start(&world, PEOPLE);
    expect_start(&world, 0);
    iso_metric_free(world.metric);
}

/* ---- a thief ---- */

static void a_stolen_file_shows_no_vector(void **state)
{
    const struct world world = new_world(state);
    size_t size = 0;
    make_stored(&world);
    char *file = scratch_read(scratch_path(*state, "g.db"), &size);
    for (int i = 0; i < PEOPLE; i++) {
        const struct iso_template tmpl = puppet_template(i, PUPPET_ALGORITHM);
        struct iso_metric_vector one;
        assert_int_equal(iso_metric_project(world.metric, &tmpl, &one), 0);
        assert_null(memmem(file, size, one.mean, DIMENSIONS * sizeof(float)));
    }
    free(file);
    iso_metric_free(world.metric);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(the_second_start_reads_no_template),
        TEST(few_vectors_are_not_stored),
        TEST(people_who_came_later_are_made_at_the_start),
        TEST(a_vector_goes_with_its_template),
        TEST(a_new_key_deletes_them),
        TEST(another_metric_makes_its_own),
        TEST(a_new_way_of_making_vectors_needs_a_new_label),
        TEST(without_a_metric_they_are_not_used),
        TEST(a_changed_template_is_found_in_spite_of_its_vector),
        TEST(a_changed_vector_is_not_used),
        TEST(a_full_disk_stores_none),
        TEST(a_stolen_file_shows_no_vector),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
