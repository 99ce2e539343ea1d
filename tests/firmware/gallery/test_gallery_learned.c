/* Learned templates of a gallery whose start reads stored vectors instead of templates. */
#include "tests/firmware/rigs/cmocka_headers.h"

#include "tests/firmware/gallery/vectors_rig.h"
#include "tests/firmware/rigs/gallery_rig.h"
#include "tests/firmware/rigs/puppets.h"

/* Deletes the learned templates; returns how many. *checked: how many were read for it. */
static size_t forget(struct iso_gallery *gallery, int *checked)
{
    size_t n = 77;
    vectors_rig_n_checked = 0;
    assert_int_equal(iso_gallery_forget_learned(gallery, &n, NULL), 0);
    *checked = vectors_rig_n_checked;
    return n;
}

/* A stored vector says whether its template was learned. A new key lets the next start store all
 * vectors again, with that of the learned template. */
static void a_start_by_vectors_finds_learned_templates(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    const struct iso_person person = {.name = "person 7"};
    struct iso_template tmpl = puppet_template(300, PUPPET_ALGORITHM);
    int checked;
    tmpl.learned = true;
    vectors_rig_store(&world);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(forget(gallery, &checked), 0);
    assert_int_equal(checked, 0); /* nothing is read */
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, NULL), 0);
    assert_int_equal(iso_gallery_rotate(gallery, NULL, NULL), 0);
    iso_gallery_close(gallery);
    iso_gallery_close(vectors_rig_open(&world));

    gallery = vectors_rig_open(&world);
    assert_int_equal(vectors_rig_n_parsed, 0);
    vectors_rig_expect_vector(gallery, &world, 7, 300);
    assert_int_equal(forget(gallery, &checked), 1);
    assert_true(checked > VECTORS_RIG_PEOPLE);
    vectors_rig_expect_vector(gallery, &world, 7, -1);
    iso_gallery_close(gallery);
    gallery = vectors_rig_open(&world);
    assert_int_equal(forget(gallery, &checked), 0);
    assert_int_equal(checked, 0);
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

/* Also a template that was added since the start. */
static void a_template_learned_since_the_start_is_found(void **state)
{
    const struct vectors_rig world = vectors_rig_new(state);
    const struct iso_person person = {.name = "person 7"};
    struct iso_template tmpl = puppet_template(300, PUPPET_ALGORITHM);
    int checked;
    tmpl.learned = true;
    vectors_rig_store(&world);
    struct iso_gallery *gallery = vectors_rig_open(&world);
    assert_int_equal(iso_gallery_add(gallery, &person, &tmpl, NULL), 0);
    assert_int_equal(forget(gallery, &checked), 1);
    vectors_rig_expect_vector(gallery, &world, 7, -1);
    iso_gallery_close(gallery);
    iso_metric_free(world.metric);
}

int main(void)
{
#define TEST(f) cmocka_unit_test_setup_teardown(f, stores_setup, stores_teardown)
    const struct CMUnitTest tests[] = {
        TEST(a_start_by_vectors_finds_learned_templates),
        TEST(a_template_learned_since_the_start_is_found),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
