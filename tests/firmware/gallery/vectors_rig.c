#include "tests/firmware/gallery/vectors_rig.h"

#include <sqlite3.h>
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

int vectors_rig_n_parsed, vectors_rig_n_checked;

int __real_iso_template_parse(const void *bytes, size_t size, struct iso_template *out);
int __wrap_iso_template_parse(const void *bytes, size_t size, struct iso_template *out);
int __wrap_iso_template_parse(const void *bytes, size_t size, struct iso_template *out)
{
    vectors_rig_n_parsed++;
    return __real_iso_template_parse(bytes, size, out);
}

int __real_iso_template_check(const void *bytes, size_t size, struct iso_template_facts *out);
int __wrap_iso_template_check(const void *bytes, size_t size, struct iso_template_facts *out);
int __wrap_iso_template_check(const void *bytes, size_t size, struct iso_template_facts *out)
{
    vectors_rig_n_checked++;
    return __real_iso_template_check(bytes, size, out);
}

struct vectors_rig vectors_rig_new(void **state)
{
    struct vectors_rig world = {
        .directory = *state, .metric = gallery_rig_new_metric(), .options = stores_gallery(*state)};
    world.options.capacity = VECTORS_RIG_PEOPLE + 2;
    world.options.metric = world.metric;
    return world;
}

struct iso_gallery *vectors_rig_open(const struct vectors_rig *world)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    vectors_rig_n_parsed = 0;
    if (iso_gallery_open(&world->options, &gallery, &fault)) {
        fail_msg("%s", fault.text);
    }
    return gallery;
}

void vectors_rig_enroll(const struct vectors_rig *world)
{
    static struct iso_gallery_item items[VECTORS_RIG_PEOPLE];
    static uint8_t bytes[VECTORS_RIG_PEOPLE][ISO_TEMPLATE_BYTES_MAX];
    size_t added = 0;
    for (int i = 0; i < VECTORS_RIG_PEOPLE; i++) {
        const struct iso_template tmpl = puppet_template(i, PUPPET_ALGORITHM);
        const int size = iso_template_serialise(&tmpl, bytes[i], sizeof bytes[i]);
        assert_true(size > 0);
        (void)snprintf(items[i].person.name, sizeof items[i].person.name, "person %d", i);
        items[i].n = 1;
        items[i].templates[0].algorithm = PUPPET_ALGORITHM;
        items[i].templates[0].bytes = bytes[i];
        items[i].templates[0].size = (size_t)size;
    }
    struct iso_gallery *gallery = vectors_rig_open(world);
    assert_int_equal(
        iso_gallery_import(gallery, items, VECTORS_RIG_PEOPLE, false, NULL, &added, NULL), 0);
    iso_gallery_close(gallery);
}

void vectors_rig_store(const struct vectors_rig *world)
{
    vectors_rig_enroll(world);
    iso_gallery_close(vectors_rig_open(world));
}

static void add_face(struct iso_metric_vector *all, const struct iso_metric *metric, int face)
{
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    struct iso_metric_vector one;
    assert_int_equal(iso_metric_project(metric, &tmpl, &one), 0);
    iso_metric_vector_add(metric, &one, all);
}

void vectors_rig_expect_vector(struct iso_gallery *gallery, const struct vectors_rig *world,
                               int number, int second)
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
    assert_memory_equal(found.mean, wanted.mean, VECTORS_RIG_DIMENSIONS * sizeof(float));
    assert_true((int)person->templates == wanted.n && (int)person->usable == wanted.n);
}

void vectors_rig_expect_everybody(struct iso_gallery *gallery, const struct vectors_rig *world)
{
    assert_int_equal(iso_index_size(iso_gallery_everybody(gallery).index), VECTORS_RIG_PEOPLE);
    for (int i = 0; i < VECTORS_RIG_PEOPLE; i++) {
        vectors_rig_expect_vector(gallery, world, i, -1);
    }
}

void vectors_rig_expect_start(const struct vectors_rig *world, int parsed)
{
    struct iso_gallery *gallery = vectors_rig_open(world);
    assert_int_equal(vectors_rig_n_parsed, parsed);
    vectors_rig_expect_everybody(gallery, world);
    iso_gallery_close(gallery);
}

int vectors_rig_ask(const struct vectors_rig *world, const char *sql)
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
