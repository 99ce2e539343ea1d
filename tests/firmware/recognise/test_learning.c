/* When the appliance learns a template at a visit, when it does not, and how learned templates are
 * removed. */
#include <stdio.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "firmware/gallery/gallery.h"
#include "firmware/recognise/learning.h"
#include "tests/firmware/rigs/rig.h"
#include "tests/support/scratch.h"

/* ---- which visits are sure ---- */

static struct iso_decision visit_of(int n, int64_t person, double score)
{
    struct iso_decision decision = {.n_frames = n};
    for (int i = 0; i < n; i++) {
        decision.frames[i].person = person;
        decision.frames[i].score = score;
    }
    return decision;
}

static void a_sure_visit(void **state)
{
    (void)state;
    const struct iso_learning_options options = {2, 6.0};
    const struct iso_verdict allowed = {.allow = true, .person = 7, .frames = 3};
    const struct iso_decision sure = visit_of(3, 7, 6.0);
    assert_true(iso_learning_is_sure(&options, &sure, &allowed));

    const struct iso_learning_options off = {0, 6.0};
    assert_false(iso_learning_is_sure(&off, &sure, &allowed));

    struct iso_verdict verdict = allowed;
    verdict.allow = false;
    assert_false(iso_learning_is_sure(&options, &sure, &verdict));
    verdict = allowed;
    verdict.attack_frames = 1;
    assert_false(iso_learning_is_sure(&options, &sure, &verdict));

    struct iso_decision decision = sure;
    decision.frames[1].score = 5.9;
    assert_false(iso_learning_is_sure(&options, &decision, &allowed));
    decision = sure;
    decision.frames[0].person = 8;
    assert_false(iso_learning_is_sure(&options, &decision, &allowed));
    decision = sure;
    decision.frames[2].score = NAN;
    assert_false(iso_learning_is_sure(&options, &decision, &allowed));
    decision.n_frames = 0;
    assert_false(iso_learning_is_sure(&options, &decision, &allowed));
}

/* ---- at the door; a score is 10 - |difference of faces|, the threshold 6 ---- */

static unsigned templates_of(const struct rig *rig, const char *name)
{
    return iso_gallery_find(rig->gallery, name)->templates;
}

/* Returns the templates of a person, who has at most two. */
static const struct iso_template *kept_of(struct rig *rig, const char *name, int *n)
{
    static struct iso_template own[2];
    struct iso_fault fault = {.text = ""};
    assert_int_equal(iso_gallery_templates(rig->gallery, iso_gallery_find(rig->gallery, name)->id,
                                           own, 2, n, &fault),
                     0);
    return own;
}

static void come(struct rig *rig, int face)
{
    rig_show(rig, face, 3);
    rig_run(rig, 20000); /* and leaves */
}

static void setup_learning(struct rig *rig, int templates)
{
    rig->config.update.templates = templates;
    rig->config.update.score = 8.0;
    rig_enrol(rig, "anna", 50);
    rig_enrol(rig, "bert", 80);
    rig_start(rig);
}

static void learns_nothing_by_default(void **state)
{
    struct rig *rig = *state;
    assert_int_equal(rig->config.update.templates, 0);
    rig->config.update.score = 8.0;
    rig_enrol(rig, "anna", 50);
    rig_start(rig);
    come(rig, 50);
    assert_int_equal(templates_of(rig, "anna"), 1);
    assert_string_equal(rig_record(rig, "learn"), "");
}

static void learns_from_a_sure_visit_and_records_it(void **state)
{
    struct rig *rig = *state;
    setup_learning(rig, 2);
    come(rig, 52);
    assert_int_equal(templates_of(rig, "anna"), 2);
    assert_int_equal(templates_of(rig, "bert"), 1);
    assert_non_null(strstr(rig_record(rig, "learn"), "\"person\":\"anna\",\"score\":8"));
    char changes[64];
    (void)snprintf(changes, sizeof changes, ":%llu\"}",
                   (unsigned long long)iso_gallery_version(rig->gallery).changes);
    assert_non_null(strstr(rig_record(rig, "gallery"), changes));
    int n = 0;
    const struct iso_template *own = kept_of(rig, "anna", &n);
    assert_int_equal(n, 2);
    assert_false(own[0].learned);
    assert_true(own[1].learned);
    assert_int_equal(puppet_face_of(&own[1]), 52);
}

/* Visits that are allowed, but with a low score, an attack frame, an expression, or a turned head.
 */
static void does_not_learn_from_other_visits(void **state)
{
    struct rig *rig = *state;
    setup_learning(rig, 2);
    come(rig, 53); /* score 7 */
    rig_show_unusable(rig, ISO_CAPTURE_FLAT, 1);
    come(rig, 50);
    rig->puppet.expression = 9.0;
    come(rig, 50);
    rig->puppet.expression = 0.0;
    rig->puppet.yaw_rad = 0.6;
    come(rig, 50);
    assert_int_equal(iso_appliance_status(rig->appliance).counts.allowed, 4);
    assert_int_equal(templates_of(rig, "anna"), 1);
    assert_string_equal(rig_record(rig, "learn"), "");
}

/* 54 is as similar to the learned 52 as 52 was to the enrolled 50. A learned template does not
 * count. */
static void does_not_drift(void **state)
{
    struct rig *rig = *state;
    setup_learning(rig, 8);
    come(rig, 52);
    assert_int_equal(templates_of(rig, "anna"), 2);
    come(rig, 54);
    assert_int_equal(iso_appliance_status(rig->appliance).counts.allowed, 2);
    assert_int_equal(templates_of(rig, "anna"), 2);
}

static void learns_at_most_the_configured_number(void **state)
{
    struct rig *rig = *state;
    setup_learning(rig, 2);
    for (int i = 0; i < 4; i++) {
        come(rig, 50 + i % 2);
    }
    assert_int_equal(templates_of(rig, "anna"), 3);
}

static void a_template_that_cannot_be_logged_is_not_learned(void **state)
{
    struct rig *rig = *state;
    setup_learning(rig, 2);
    rig_fill_disk();
    come(rig, 50);
    rig_free_disk();
    assert_int_equal(templates_of(rig, "anna"), 1);
}

/* ---- removal of learned templates ---- */

static void forgets_when_it_is_switched_off(void **state)
{
    struct rig *rig = *state;
    setup_learning(rig, 2);
    come(rig, 51);
    come(rig, 82);
    assert_int_equal(templates_of(rig, "anna") + templates_of(rig, "bert"), 4);
    const struct iso_person before = *iso_gallery_find(rig->gallery, "bert");
    iso_appliance_stop(rig->appliance);
    rig->config.update.templates = 0;
    rig_start(rig);
    assert_non_null(strstr(rig_record(rig, "forget"), "\"note\":\"2 learned templates\""));
    const struct iso_person *bert = iso_gallery_find(rig->gallery, "bert");
    assert_int_equal(templates_of(rig, "anna"), 1);
    assert_int_equal(bert->templates, 1);
    assert_int_equal(bert->enrolled_s, before.enrolled_s);
    int n = 0;
    const struct iso_template *own = kept_of(rig, "bert", &n);
    assert_int_equal(n, 1);
    assert_int_equal(puppet_face_of(&own[0]), 80);
    assert_false(own[0].learned);
}

/* There is no learned template, so nothing is written. */
static void nothing_to_forget(void **state)
{
    struct rig *rig = *state;
    size_t n = 99;
    struct iso_fault fault = {.text = ""};
    rig_enrol(rig, "anna", 50);
    const uint64_t changes = iso_gallery_version(rig->gallery).changes;
    assert_int_equal(iso_gallery_forget_learned(rig->gallery, &n, &fault), 0);
    assert_int_equal(n, 0);
    assert_int_equal(iso_gallery_version(rig->gallery).changes, changes);
}

/* Several people: the copies move in memory as their number grows. */
static void forgets_the_templates_of_all_people(void **state)
{
    enum { MANY = 3 };
    struct rig *rig = *state;
    struct iso_fault fault = {.text = ""};
    size_t n = 0;
    for (int i = 0; i < MANY; i++) {
        struct iso_person person = {.enrolled_s = 1000 + i};
        struct iso_template learned = puppet_template(100 + i, PUPPET_ALGORITHM);
        (void)snprintf(person.name, sizeof person.name, "p%d", i);
        rig_enrol(rig, person.name, 100 + i);
        learned.learned = true;
        assert_int_equal(iso_gallery_add(rig->gallery, &person, &learned, &fault), 0);
    }
    assert_int_equal(iso_gallery_forget_learned(rig->gallery, &n, &fault), 0);
    assert_int_equal(n, MANY);
    for (int i = 0; i < MANY; i++) {
        char name[16];
        (void)snprintf(name, sizeof name, "p%d", i);
        int own = 0;
        const struct iso_template *kept = kept_of(rig, name, &own);
        assert_int_equal(own, 1);
        assert_int_equal(puppet_face_of(kept), 100 + i);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_sure_visit),
        cmocka_unit_test_setup_teardown(learns_nothing_by_default, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(learns_from_a_sure_visit_and_records_it, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(does_not_learn_from_other_visits, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(does_not_drift, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(learns_at_most_the_configured_number, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(a_template_that_cannot_be_logged_is_not_learned, rig_setup,
                                        rig_teardown),
        cmocka_unit_test_setup_teardown(forgets_when_it_is_switched_off, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(nothing_to_forget, rig_setup, rig_teardown),
        cmocka_unit_test_setup_teardown(forgets_the_templates_of_all_people, rig_setup,
                                        rig_teardown),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
