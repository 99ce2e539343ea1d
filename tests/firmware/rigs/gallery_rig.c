#include "tests/firmware/rigs/gallery_rig.h"

#include <sqlite3.h>
#include <stdio.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/rigs/puppets.h"
#include "tests/support/scratch.h"

int gallery_rig_capacity = 3;

int gallery_rig_try_open(const char *directory, struct iso_gallery **out, struct iso_fault *fault)
{
    struct iso_gallery_options options = stores_gallery(directory);
    options.capacity = gallery_rig_capacity;
    return iso_gallery_open(&options, out, fault);
}

struct iso_gallery *gallery_rig_open(const char *directory)
{
    struct iso_gallery *gallery = NULL;
    struct iso_fault fault = {.text = ""};
    if (gallery_rig_try_open(directory, &gallery, &fault)) {
        fail_msg("%s", fault.text);
    }
    return gallery;
}

static int add_person(struct iso_gallery *gallery, const struct iso_person *person, int face,
                      struct iso_fault *fault)
{
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    return iso_gallery_add(gallery, person, &tmpl, fault);
}

int gallery_rig_add_until(struct iso_gallery *gallery, const char *name, int face,
                          int64_t valid_until_s, struct iso_fault *fault)
{
    struct iso_person person = {.enrolled_s = 1000 + face, .valid_until_s = valid_until_s};
    (void)snprintf(person.name, sizeof person.name, "%s", name);
    return add_person(gallery, &person, face, fault);
}

int gallery_rig_add(struct iso_gallery *gallery, const char *name, int face,
                    struct iso_fault *fault)
{
    return gallery_rig_add_until(gallery, name, face, 0, fault);
}

int gallery_rig_add_number(struct iso_gallery *gallery, int number, struct iso_fault *fault)
{
    struct iso_person person = {.enrolled_s = 1};
    (void)snprintf(person.name, sizeof person.name, "person %d", number);
    return add_person(gallery, &person, number, fault);
}

void gallery_rig_make(const char *directory, int people)
{
    struct iso_gallery *gallery = gallery_rig_open(directory);
    for (int i = 0; i < people; i++) {
        assert_int_equal(gallery_rig_add_number(gallery, i, NULL), 0);
    }
    iso_gallery_close(gallery);
}

void gallery_rig_execute(const char *directory, const char *sql)
{
    sqlite3 *db = NULL;
    char *message = NULL;
    assert_int_equal(sqlite3_open(scratch_path(directory, "g.db"), &db), SQLITE_OK);
    if (sqlite3_exec(db, sql, NULL, NULL, &message) != SQLITE_OK) {
        fail_msg("%s", message);
    }
    assert_int_equal(sqlite3_close(db), SQLITE_OK);
}

void gallery_rig_expect(struct iso_gallery *gallery, const char *name, unsigned templates)
{
    const struct iso_person *person = iso_gallery_find(gallery, name);
    assert_non_null(person);
    assert_int_equal(person->templates, templates);
    assert_int_equal(person->usable, templates);
    assert_ptr_equal(iso_gallery_find_id(gallery, person->id), person);
    assert_int_equal(iso_gallery_only(gallery, person->id).n_entries, templates);
}

struct iso_metric *gallery_rig_new_metric(void)
{
    const struct iso_template any = puppet_template(20, PUPPET_ALGORITHM);
    const struct iso_metric shape = {
        .algorithm = PUPPET_ALGORITHM,
        .landmarks = 3,
        .n_radii = any.n_radii,
        .n_points = any.n_points,
        .n_dimensions = 5,
        .weight_min = 0.25f,
        .gain = 1.0f,
    };
    struct iso_metric *metric = NULL;
    assert_int_equal(iso_metric_new(&shape, &metric), 0);
    for (int v = 0; v < metric->n_values; v++) {
        metric->curve_mm[v] = (float)((v * 37) % 11);
        metric->axis[v * 5 + v % 5] = 1.0f;
    }
    for (int d = 0; d < 5; d++) {
        metric->between[d] = 2.0f;
    }
    return metric;
}
