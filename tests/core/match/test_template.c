/* Template bytes, fusion, cohort and search on artificial templates. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/base/bytes.h"
#include "core/base/crc32.h"
#include "core/match/search.h"
#include "core/match/template_fuse.h"

/* The working memory of registrations. */
static struct iso_icp_workspace registration;

enum { COHORT = 12 };

/* The "face" of an artificial person. The shape of its curves depends on the number; `shift_mm`
 * moves it as a whole, and `noise_mm` disturbs it with a fixed pattern. */
static struct iso_template person(int number, float shift_mm, float noise_mm)
{
    struct iso_template t;
    memset(&t, 0, sizeof t);
    t.algorithm = 77;
    strcpy(t.sensor, "astra");
    t.n_radii = 2;
    t.n_points = 24;
    t.n_frames = 1;
    t.quality = 0.75f;
    t.radius_mm[0] = 12.5f;
    t.radius_mm[1] = 20.0f;
    for (int r = 0; r < t.n_radii; r++) {
        for (int l = 0; l < ISO_LANDMARKS; l++) {
            for (int i = 0; i < t.n_points; i++) {
                double a = 2.0 * M_PI * i / t.n_points;
                double wave = 3.0 * sin(2.0 * a + 1.3 * number + l) * cos(0.7 * number * l + r);
                float noise = noise_mm * (float)sin(12.9898 * (i + 31 * l + 7 * r) + number);
                t.points_mm[r][l][i][0] = 10.0f * (float)(l % 4) + 15.0f * (float)cos(a) + shift_mm;
                t.points_mm[r][l][i][1] = 12.0f * (float)(l / 4) + 15.0f * (float)sin(a) - shift_mm;
                t.points_mm[r][l][i][2] = (float)wave + noise;
                t.weight[r][l][i] = 1.0f;
            }
        }
    }
    return t;
}

static void a_template_survives_its_bytes(void **state)
{
    (void)state;
    struct iso_template t = person(3, 0.3f, 0.2f), back;
    t.weight[1][4][7] = 0.0f;
    t.n_frames = 5;
    t.learned = true;
    t.upper.kind[3][7] = ISO_UPPER_MEASURED;
    t.upper.z_mm[3][7] = -21.5f;
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    int size = iso_template_serialise(&t, bytes, sizeof bytes);
    assert_true(size > 0);
    assert_int_equal(iso_template_parse(bytes, (size_t)size, &back), 0);
    assert_int_equal(back.algorithm, 77);
    assert_string_equal(back.sensor, "astra");
    assert_int_equal(back.n_frames, 5);
    assert_true(back.learned);
    assert_true(back.weight[1][4][7] == 0.0f && back.weight[0][0][0] == 1.0f);
    assert_memory_equal(&back.upper, &t.upper, sizeof t.upper);
    /* Without an upper face, its block has only two bytes. */
    memset(&t.upper, 0, sizeof t.upper);
    const int plain = iso_template_serialise(&t, bytes, sizeof bytes);
    assert_int_equal(size - plain, ISO_UPPER_KIND_BYTES + 2);
    assert_int_equal(iso_template_parse(bytes, (size_t)plain, &back), 0);
    assert_memory_equal(&back.upper, &t.upper, sizeof t.upper);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int k = 0; k < 3; k++) {
            float d = back.points_mm[1][l][5][k] - t.points_mm[1][l][5][k];
            assert_true(fabsf(d) <= 0.5f / 64.0f + 1e-5f);
        }
    }
}

static void damaged_template_bytes_are_refused(void **state)
{
    (void)state;
    struct iso_template t = person(3, 0.0f, 0.0f), back;
    t.upper.kind[3][7] = ISO_UPPER_MEASURED;
    t.upper.z_mm[3][7] = -21.5f;
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    int size = iso_template_serialise(&t, bytes, sizeof bytes);
    memset(&back, 0x5a, sizeof back);
    struct iso_template untouched = back;
    for (int cut = 0; cut < size; cut++) {
        assert_int_equal(iso_template_parse(bytes, (size_t)cut, &back), -EBADMSG);
    }
    for (int at = 0; at < size; at++) {
        bytes[at] ^= 0x10;
        int error = iso_template_parse(bytes, (size_t)size, &back);
        bool in_version = at == 4 || at == 5;
        assert_int_equal(error, in_version ? -EPROTONOSUPPORT : -EBADMSG);
        bytes[at] ^= 0x10;
    }
    assert_memory_equal(&back, &untouched, sizeof back);
    /* Version 1 had no upper face. */
    bytes[4] = 1;
    assert_int_equal(iso_template_parse(bytes, (size_t)size, &back), -EPROTONOSUPPORT);
    /* An upper face with an invalid kind, under a correct checksum. */
    bytes[4] = ISO_TEMPLATE_VERSION;
    const size_t block = (size_t)size - 4 - (ISO_UPPER_KIND_BYTES + 2);
    bytes[block] = 3; /* not a valid kind of a node */
    (void)iso_put_u32(bytes + size - 4, iso_crc32(0, bytes, (size_t)size - 4));
    assert_int_equal(iso_template_parse(bytes, (size_t)size, &back), -EBADMSG);
    assert_memory_equal(&back, &untouched, sizeof back);
}

static void a_template_out_of_range_is_not_written(void **state)
{
    (void)state;
    uint8_t bytes[ISO_TEMPLATE_BYTES_MAX];
    struct iso_template t = person(1, 0.0f, 0.0f);
    assert_int_equal(iso_template_serialise(&t, bytes, 100), -ENOSPC);
    t.points_mm[0][3][2][1] = NAN;
    assert_int_equal(iso_template_serialise(&t, bytes, sizeof bytes), -EINVAL);
    t = person(1, 0.0f, 0.0f);
    t.points_mm[1][3][2][1] = 600.0f;
    assert_int_equal(iso_template_serialise(&t, bytes, sizeof bytes), -EINVAL);
    t = person(1, 0.0f, 0.0f);
    t.upper.z_mm[9][9] = 1.0f; /* its kind is none */
    assert_int_equal(iso_template_serialise(&t, bytes, sizeof bytes), -EINVAL);
    t = person(1, 0.0f, 0.0f);
    t.n_points = ISO_TEMPLATE_POINTS_MAX + 1;
    assert_int_equal(iso_template_serialise(&t, bytes, sizeof bytes), -EINVAL);
}

static void the_distance_does_not_depend_on_the_pose(void **state)
{
    (void)state;
    struct iso_match_options options = iso_match_options_default();
    struct iso_template a = person(1, 0.0f, 0.0f), moved = person(1, 4.0f, 0.0f);
    struct iso_template other = person(2, 0.0f, 0.0f);
    double same, different;
    assert_int_equal(iso_match_distance(&registration, &a, &moved, &options, &same), 0);
    assert_int_equal(iso_match_distance(&registration, &a, &other, &options, &different), 0);
    assert_true(same < 1e-3);
    assert_true(different > 0.3);
}

static void distance_refuses_what_cannot_be_compared(void **state)
{
    (void)state;
    struct iso_match_options options = iso_match_options_default();
    struct iso_template a = person(1, 0.0f, 0.0f), b = a;
    double distance;
    b.algorithm++;
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), -EINVAL);
    b = a;
    b.n_points--;
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), -EINVAL);
    b = a;
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int i = 0; i < b.n_points; i++) {
            b.weight[0][l][i] = 0.0f;
            b.weight[1][l][i] = i < 12 ? 0.0f : 1.0f; /* a quarter is left */
        }
    }
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), -ENODATA);
    options.trim = 0.3;
    assert_int_equal(iso_match_distance(&registration, &a, &a, &options, &distance), -EINVAL);
}

/* A landmark that is left out is used neither for registration nor for the distance. Its points may
 * be missing. */
static void distance_leaves_landmarks_out(void **state)
{
    (void)state;
    struct iso_match_options options = iso_match_options_default();
    struct iso_template a = person(1, 0.0f, 0.0f), b = a;
    double distance = -1.0;
    for (int r = 0; r < b.n_radii; r++) {
        for (int i = 0; i < b.n_points; i++) {
            for (int l = ISO_LM_SUBNASALE; l < ISO_LANDMARKS; l++) { /* ten of twelve */
                b.weight[r][l][i] = 0.0f;
            }
            b.points_mm[r][ISO_LM_NASION][i][2] += 5.0f;
        }
    }
    for (int l = ISO_LM_SUBNASALE; l < ISO_LANDMARKS; l++) {
        options.left_out[l] = true;
    }
    options.trim = 1.0;
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), 0);
    assert_true(distance > 0.1);
    options.left_out[ISO_LM_NASION] = true;
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), 0);
    assert_true(distance < 1e-3);
    options.left_out[ISO_LM_NOSE_TIP] = true;
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), -EINVAL);
    options = iso_match_options_default();
    assert_int_equal(iso_match_distance(&registration, &a, &b, &options, &distance), -ENODATA);
}

static void fusing_averages_noise_away(void **state)
{
    (void)state;
    struct iso_template one = person(1, 0.0f, 0.8f), two = person(1, 2.0f, -0.8f), fused;
    struct iso_template truth = person(1, 0.0f, 0.0f);
    const struct iso_template *both[2] = {&one, &two};
    one.learned = true;
    assert_int_equal(iso_template_fuse(&registration, both, 2, &fused), 0);
    assert_int_equal(fused.n_frames, 2);
    assert_false(fused.learned);
    struct iso_match_options options = iso_match_options_default();
    double noisy, clean;
    assert_int_equal(iso_match_distance(&registration, &one, &truth, &options, &noisy), 0);
    assert_int_equal(iso_match_distance(&registration, &fused, &truth, &options, &clean), 0);
    assert_true(clean < 0.3 * noisy);
    two.algorithm++;
    assert_int_equal(iso_template_fuse(&registration, both, 2, &fused), -EINVAL);
    assert_int_equal(iso_template_fuse(&registration, both, 0, &fused), -EINVAL);
}

static struct iso_cohort *make_cohort(void)
{
    struct iso_template templates[COHORT];
    const struct iso_template *list[COHORT];
    for (int i = 0; i < COHORT; i++) {
        templates[i] = person(100 + i, 0.0f, 0.0f);
        list[i] = &templates[i];
    }
    void *bytes;
    size_t size;
    struct iso_cohort *cohort = NULL;
    assert_int_equal(iso_cohort_serialise(list, COHORT, &bytes, &size), 0);
    assert_int_equal(iso_cohort_parse(bytes, size, &cohort, NULL), 0);
    struct iso_fault fault = {.text = ""};
    struct iso_cohort *none = NULL;
    for (size_t at = 0; at < size; at += 97) {
        ((uint8_t *)bytes)[at] ^= 1;
        assert_int_equal(iso_cohort_parse(bytes, size, &none, &fault), -EBADMSG);
        assert_true(fault.text[0] != '\0');
        ((uint8_t *)bytes)[at] ^= 1;
        assert_int_equal(iso_cohort_parse(bytes, at, &none, &fault), -EBADMSG);
    }
    assert_null(none);
    free(bytes);
    return cohort;
}

static void search_finds_the_person_and_only_the_person(void **state)
{
    (void)state;
    struct iso_cohort *cohort = make_cohort();
    assert_int_equal(iso_cohort_size(cohort), COHORT);
    assert_int_equal(iso_cohort_algorithm(cohort), 77);
    struct iso_template gallery[6];
    struct iso_search_entry entries[6];
    for (int i = 0; i < 6; i++) {
        gallery[i] = person(1 + i / 2, 0.0f,
                            i % 2 ? 0.3f : 0.0f); /* two templates for each person */
        entries[i] = (struct iso_search_entry){1 + i / 2, &gallery[i]};
    }
    struct iso_template probe = person(2, 3.0f, 0.2f);
    struct iso_match_options options = iso_match_options_default();
    struct iso_search_hit hits[2];
    int n = -1;
    assert_int_equal(iso_search(&registration, entries, 6, &probe, cohort, &options, hits, 2, &n),
                     0);
    assert_int_equal(n, 2);
    assert_int_equal(hits[0].person, 2);
    assert_true(hits[1].person != 2);
    assert_true(hits[0].score > 0.8 && hits[1].score < 0.5);
    assert_int_equal(iso_search(&registration, entries, 0, &probe, cohort, &options, hits, 2, &n),
                     0);
    assert_int_equal(n, 0);
    gallery[3].algorithm++;
    assert_int_equal(iso_search(&registration, entries, 6, &probe, cohort, &options, hits, 2, &n),
                     -EINVAL);
    iso_cohort_free(cohort);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_template_survives_its_bytes),
        cmocka_unit_test(damaged_template_bytes_are_refused),
        cmocka_unit_test(a_template_out_of_range_is_not_written),
        cmocka_unit_test(the_distance_does_not_depend_on_the_pose),
        cmocka_unit_test(distance_refuses_what_cannot_be_compared),
        cmocka_unit_test(distance_leaves_landmarks_out),
        cmocka_unit_test(fusing_averages_noise_away),
        cmocka_unit_test(search_finds_the_person_and_only_the_person),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
