/* The reranker. Its scores are those of core/match/rerank. It asks the gallery for each person only
 * once, unless the gallery has changed. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "core/match/search.h"
#include "firmware/recognise/method/reranker.h"

enum { PEOPLE = 30 };

/* Working memory of iso_rerank(), which computes the expected scores. */
static struct iso_rerank_workspace work;

/* A slope with a wave that depends on the person. */
static struct iso_upper_face face_of(int who)
{
    struct iso_upper_face face = {0};
    for (int v = 0; v < ISO_UPPER_ROWS; v++) {
        for (int u = 0; u < ISO_UPPER_COLUMNS; u++) {
            const double x = iso_upper_x_mm(u), y = iso_upper_y_mm(v);
            face.z_mm[v][u] = (float)(-0.006 * x * x - 0.004 * (y - 30.0) * (y - 30.0) +
                                      3.0 * sin(0.02 * (who + 2) * x) * cos(0.03 * who * y));
            face.kind[v][u] = ISO_UPPER_MEASURED;
        }
    }
    return face;
}

/* Person p has p % 3 + 1 templates. They are equal, or all different if `varied` is set. */
struct owner {
    int opened, error;
    bool varied;
};

/* Returns the upper face of template i of a person. */
static struct iso_upper_face template_face(const struct owner *owner, int64_t person, int i)
{
    return face_of((int)person + (owner->varied ? 3 * i : 0));
}

static int open_person(void *context, int64_t person, struct iso_template *out, int capacity,
                       int *n, struct iso_fault *fault)
{
    struct owner *owner = context;
    (void)fault;
    if (owner->error) {
        return owner->error;
    }
    owner->opened++;
    *n = (int)(person % 3) + 1;
    assert_true(*n <= capacity);
    for (int i = 0; i < *n; i++) {
        out[i] = (struct iso_template){.upper = template_face(owner, person, i)};
    }
    return 0;
}

static const struct iso_metric metric = {.rerank = {0.5f, 2.0f, 0.25f}};

struct rig {
    struct owner owner;
    struct iso_candidate_list among;
    struct iso_reranker *look;
    struct iso_template probe; /* of person 4 */
    struct iso_search_hit hits[ISO_RERANK_CANDIDATES + 1];
};

static int set_up(void **state)
{
    static struct rig rig;
    rig = (struct rig){.probe = {.upper = face_of(4)}};
    rig.among = (struct iso_candidate_list){
        .templates = open_person, .owner = &rig.owner, .version = 1};
    *state = &rig;
    return iso_reranker_new(&rig.look);
}

static int tear_down(void **state)
{
    iso_reranker_free(((struct rig *)*state)->look);
    return 0;
}

/* Reranks n hits, from the person `first` on, with falling scores. Returns the reranker's error. */
static int look_at(struct rig *rig, int first, int n)
{
    for (int i = 0; i < n; i++) {
        rig->hits[i] = (struct iso_search_hit){
            .person = first + i, .distance_mm = NAN, .score = 3.0 - 0.1 * i};
    }
    return iso_reranker_take(rig->look, &metric, &rig->among, &rig->probe, rig->hits, n);
}

static void scores_are_fused_and_fall(void **state)
{
    struct rig *rig = *state;
    assert_int_equal(look_at(rig, 1, ISO_RERANK_CANDIDATES), 0);
    assert_int_equal(rig->hits[0].person, 4);
    bool seen[ISO_RERANK_CANDIDATES + 1] = {false};
    for (int i = 0; i < ISO_RERANK_CANDIDATES; i++) {
        const int64_t person = rig->hits[i].person;
        const struct iso_upper_face face = face_of((int)person);
        const struct iso_upper_face *own = &face;
        assert_float_equal(rig->hits[i].score,
                           iso_rerank(&work, &metric, &rig->probe.upper, &own, 1, 0,
                                      3.0 - 0.1 * (double)(person - 1)),
                           0.0);
        assert_true(i == 0 || rig->hits[i].score <= rig->hits[i - 1].score);
        assert_false(seen[person]);
        seen[person] = true;
    }
    assert_int_equal(look_at(rig, 1, 0), 0);
}

/* Computes the score of a person whose templates are different, in a place of the candidates. */
static double score_in_place(const struct rig *rig, int64_t person, int place, double score)
{
    struct iso_upper_face face[3];
    const struct iso_upper_face *own[] = {&face[0], &face[1], &face[2]};
    const int n = (int)(person % 3) + 1;
    for (int i = 0; i < n; i++) {
        face[i] = template_face(&rig->owner, person, i);
    }
    return iso_rerank(&work, &metric, &rig->probe.upper, own, n, place, score);
}

/* The reranking depends on the place of a person among the hits. */
static void a_person_is_compared_as_its_place_demands(void **state)
{
    struct rig *rig = *state;
    int changed = 0;
    rig->owner.varied = true;
    assert_int_equal(look_at(rig, 1, ISO_RERANK_CANDIDATES), 0);
    for (int i = 0; i < ISO_RERANK_CANDIDATES; i++) {
        const int place = (int)rig->hits[i].person - 1;
        const double metric_score = 3.0 - 0.1 * place;
        const double score = score_in_place(rig, rig->hits[i].person, place, metric_score);
        assert_float_equal(rig->hits[i].score, score, 0.0);
        changed += score_in_place(rig, rig->hits[i].person, 0, metric_score) != score;
    }
    assert_true(changed > 0);
}

static void asks_for_nobody_twice(void **state)
{
    struct rig *rig = *state;
    assert_int_equal(look_at(rig, 1, 10), 0);
    assert_int_equal(rig->owner.opened, 10);
    assert_int_equal(look_at(rig, 1, 10), 0);
    assert_int_equal(look_at(rig, 6, 10), 0);
    assert_int_equal(look_at(rig, 1, 10), 0);
    assert_int_equal(rig->owner.opened, 15);
    /* There is space for twenty people. Those who were not used for the longest time are replaced,
     * but nobody of the same frame. */
    for (int first = 1; first + 9 <= PEOPLE; first++) {
        assert_int_equal(look_at(rig, first, 10), 0);
        assert_int_equal(look_at(rig, first, 10), 0);
    }
    assert_int_equal(rig->owner.opened, PEOPLE);
}

static void a_gallery_that_changed_is_asked_again(void **state)
{
    struct rig *rig = *state;
    assert_int_equal(look_at(rig, 1, 3), 0);
    rig->among.version++;
    assert_int_equal(look_at(rig, 1, 3), 0);
    assert_int_equal(rig->owner.opened, 6);
    struct owner other = {0};
    rig->among.owner = &other;
    assert_int_equal(look_at(rig, 1, 3), 0);
    assert_int_equal(other.opened, 3);
}

static void a_template_that_cannot_be_opened_is_an_error(void **state)
{
    struct rig *rig = *state;
    rig->owner.error = -EBADMSG;
    assert_int_equal(look_at(rig, 1, 2), -EBADMSG);
    rig->owner.error = 0;
    assert_int_equal(look_at(rig, 1, 2), 0);
    assert_int_equal(rig->owner.opened, 2);
    assert_int_equal(look_at(rig, 1, ISO_RERANK_CANDIDATES + 1), -EINVAL);
    assert_int_equal(look_at(rig, 1, -1), -EINVAL);
}

static void hits_are_sorted_by_score_and_then_by_number(void **state)
{
    struct iso_search_hit hits[] = {{.person = 7, .score = 1.0},
                                    {.person = 9, .score = 2.0},
                                    {.person = 3, .score = 1.0},
                                    {.person = 1, .score = -INFINITY}};
    (void)state;
    iso_search_sort(hits, 4);
    assert_int_equal(hits[0].person, 9);
    assert_int_equal(hits[1].person, 3);
    assert_int_equal(hits[2].person, 7);
    assert_int_equal(hits[3].person, 1);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup_teardown(scores_are_fused_and_fall, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_person_is_compared_as_its_place_demands, set_up,
                                        tear_down),
        cmocka_unit_test_setup_teardown(asks_for_nobody_twice, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_gallery_that_changed_is_asked_again, set_up, tear_down),
        cmocka_unit_test_setup_teardown(a_template_that_cannot_be_opened_is_an_error, set_up,
                                        tear_down),
        cmocka_unit_test(hits_are_sorted_by_score_and_then_by_number),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
