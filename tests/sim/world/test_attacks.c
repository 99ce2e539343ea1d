/* The preset `attacks` has every kind of attack, with the right name and the right shape. */
#include <errno.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "sim/world/generate/attacks.h"
#include "tests/sim/world/generated.h"
#include "tests/support/scratch.h"

enum { PEOPLE = 2, PER_KIND = 6, FRAMES = 4, INSTRUMENTS = 8 };

static const struct {
    const char *note;
    size_t frames;
} kinds[INSTRUMENTS] = {
    {"photo-flat", 1}, {"photo-bent", 1},     {"screen", 1},          {"mask-small", 1},
    {"mask-large", 1}, {"print-eyes-cut", 1}, {"mask-still", FRAMES}, {"frozen", FRAMES},
};

/* One corpus for all tests that only read it. */
static struct sim_corpus *shared_corpus;
static char shared_directory[256];

static struct sim_generate_options small(const char *directory)
{
    struct sim_generate_options options = generated_options("attacks", directory);
    options.n_people = PEOPLE;
    options.n_per_kind = PER_KIND;
    options.frames_per_visit = FRAMES;
    return options;
}

static const struct sim_corpus *corpus(void **state)
{
    if (!shared_corpus) {
        (void)snprintf(shared_directory, sizeof shared_directory, "%s",
                       scratch_path(*state, "corpus"));
        struct sim_generate_options options = small(shared_directory);
        shared_corpus = generated_corpus(&options);
    }
    return shared_corpus;
}

static int tear_down(void **state)
{
    sim_corpus_free(shared_corpus);
    return scratch_teardown(state);
}

static void rows_are_as_documented(void **state)
{
    const struct sim_corpus *c = corpus(state);
    const struct sim_attacks_plan plan = {.n_people = PEOPLE, .per_kind = PER_KIND};
    int n[INSTRUMENTS] = {0}, gallery = 0, glances = 0, visits = 0;
    assert_int_equal(c->n_rows, sim_attacks_count(&plan));
    for (size_t i = 0; i < c->n_rows; i++) {
        const struct sim_corpus_row *row = &c->rows[i];
        assert_int_equal(row->first, 0);
        if (strcmp(row->subject, "none") == 0) {
            int k = 0;
            while (k < INSTRUMENTS && strcmp(kinds[k].note, row->note) != 0) {
                k++;
            }
            assert_in_range(k, 0, INSTRUMENTS - 1);
            assert_int_equal(row->role, SIM_ROLE_IMPOSTOR);
            assert_int_equal(row->count, kinds[k].frames);
            assert_true((row->expression[0] == '\0') == (strcmp(row->note, "frozen") == 0));
            n[k]++;
        } else if (row->role == SIM_ROLE_GALLERY) {
            assert_string_equal(row->note, "test-1");
            assert_string_equal(row->expression, "neutral");
            gallery++;
        } else {
            assert_int_equal(row->role, SIM_ROLE_PROBE);
            assert_string_equal(row->note, "test-1 bona-fide");
            assert_int_equal(strlen(row->pose), strlen("y+00p+00r+00"));
            glances += row->count == 1;
            visits += row->count == FRAMES;
        }
    }
    for (int k = 0; k < INSTRUMENTS; k++) {
        assert_int_equal(n[k], PER_KIND);
    }
    assert_int_equal(gallery, PEOPLE);
    assert_int_equal(glances, PER_KIND);
    assert_int_equal(visits, PER_KIND);
}

/* A scene depends only on its number. So a corpus with one scene of each kind is a part of a larger
 * one. */
static void the_same_options_make_the_same_bytes(void **state)
{
    const struct sim_corpus *c = corpus(state);
    char again[256], other[256], file[128];
    (void)strcpy(again, scratch_path(*state, "again"));
    (void)strcpy(other, scratch_path(*state, "other"));
    struct sim_generate_options options = small(again);
    options.n_per_kind = 1;
    struct sim_corpus *part = generated_corpus(&options);
    options.directory = other;
    options.seed = 2;
    sim_corpus_free(generated_corpus(&options));
    for (int k = 0; k < INSTRUMENTS; k++) {
        (void)snprintf(file, sizeof file, "none-%s-0000/depth/000000.png", kinds[k].note);
        assert_true(generated_same(shared_directory, again, file));
        assert_false(generated_same(shared_directory, other, file));
    }
    assert_true(generated_same(shared_directory, again, "p0000-v1/depth/000003.png"));
    assert_true(generated_same(shared_directory, again, "p0000-v1/landmarks.csv"));
    for (size_t i = 0, n = 0; i < c->n_rows && n < part->n_rows; i++) {
        if (strcmp(c->rows[i].recording, part->rows[n].recording) == 0) {
            assert_memory_equal(&c->rows[i], &part->rows[n], sizeof c->rows[i]);
            n++;
        }
        assert_true(i + 1 < c->n_rows || n == part->n_rows);
    }
    sim_corpus_free(part);
}

/* ---- motion ----------------------------------------------------------------- */

/* Returns the share of measured pixels that differ by more than `limit_mm` between two frames. */
static double changed(const struct iso_frame *a, const struct iso_frame *b, double limit_mm)
{
    size_t n = (size_t)a->width_px * (size_t)a->height_px, both = 0, differ = 0;
    for (size_t i = 0; i < n; i++) {
        if (a->depth_mm[i] > 0.0f && b->depth_mm[i] > 0.0f && a->depth_mm[i] < 1200.0f) {
            both++;
            differ += fabs((double)(a->depth_mm[i] - b->depth_mm[i])) > limit_mm;
        }
    }
    assert_true(both > 1000);
    return (double)differ / (double)both;
}

static double mean_change(const char *recording, double limit_mm)
{
    struct iso_frame *first = generated_frame(shared_directory, recording, 0);
    struct iso_frame *last = generated_frame(shared_directory, recording, FRAMES - 1);
    double share = changed(first, last, limit_mm);
    iso_frame_free(first);
    iso_frame_free(last);
    return share;
}

static void a_frozen_frame_does_not_change_by_a_bit(void **state)
{
    (void)corpus(state);
    for (int i = 0; i < PER_KIND; i++) {
        char directory[256], name[64];
        (void)snprintf(name, sizeof name, "none-frozen-%04d", i);
        (void)strcpy(directory, scratch_path(shared_directory, name));
        for (int f = 1; f < FRAMES; f++) {
            char first[300], later[300];
            size_t n_first, n_later;
            (void)snprintf(first, sizeof first, "%s/depth/000000.png", directory);
            (void)snprintf(later, sizeof later, "%s/depth/%06d.png", directory, f);
            void *a = scratch_read(first, &n_first), *b = scratch_read(later, &n_later);
            assert_true(n_first == n_later && memcmp(a, b, n_first) == 0);
            free(a);
            free(b);
        }
    }
}

/* A mask on a stand. Away from edges, a depth changes by no more than the noise. */
static void a_still_mask_changes_by_noise_alone(void **state)
{
    (void)corpus(state);
    char name[64];
    for (int i = 0; i < PER_KIND; i++) {
        (void)snprintf(name, sizeof name, "none-mask-still-%04d", i);
        double any = mean_change(name, 0.1), far = mean_change(name, 12.0);
        print_message("%s: %.3f changed, %.4f by more than 12 mm\n", name, any, far);
        assert_true(any > 0.2);
        assert_true(far < 0.03);
    }
}

static void people_sway(void **state)
{
    const struct sim_corpus *c = corpus(state);
    double least = 1e9, most = 0.0;
    for (size_t i = 0; i < c->n_rows; i++) {
        if (strcmp(c->rows[i].note, "test-1 bona-fide") == 0 && c->rows[i].count == FRAMES) {
            struct iso_recording *recording = NULL;
            struct iso_recording_landmark *rows = NULL;
            size_t n;
            const char *path = scratch_path(shared_directory, c->rows[i].recording);
            assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
            assert_int_equal(iso_recording_landmarks(recording, &rows, &n, NULL), 0);
            assert_int_equal(n % FRAMES, 0);
            struct iso_vec3 way = iso_sub(rows[n - n / FRAMES].point_mm, rows[0].point_mm);
            least = fmin(least, iso_norm(way) / (FRAMES - 1));
            most = fmax(most, iso_norm(way) / (FRAMES - 1));
            free(rows);
            iso_recording_close(recording);
        }
    }
    print_message("a landmark moves %.2f to %.2f mm a frame\n", least, most);
    assert_true(least > 0.02);
    assert_true(most > 2.0 * least && most < 10.0);
}

/* ---- shape ------------------------------------------------------------------ */

/* Fits z = k0 + k1 x + k2 y + k3 x^2 + k4 xy + k5 y^2 by least squares over a square about the
 * centre of the image, in mm from there. The last three terms are used only if `curved`. */
struct surface {
    double k[6], middle_z_mm, rms_mm;
    int n;
};

static struct surface fit_middle(const struct iso_frame *frame, int half_px, bool curved)
{
    int n = curved ? 6 : 3, u0 = frame->width_px / 2, v0 = frame->height_px / 2;
    struct surface s = {.middle_z_mm = (double)iso_frame_depth_at(frame, u0, v0)};
    double a[6][7] = {{0}};
    assert_true(s.middle_z_mm > 0.0);
    for (int pass = 0; pass < 2; pass++) {
        for (int i = 0; i < (2 * half_px + 1) * (2 * half_px + 1); i++) {
            struct iso_vec3 p = generated_point(frame, u0 - half_px + i % (2 * half_px + 1),
                                                v0 - half_px + i / (2 * half_px + 1));
            double z = p.z - s.middle_z_mm,
                   terms[6] = {1, p.x, p.y, p.x * p.x, p.x * p.y, p.y * p.y};
            for (int r = 0; pass == 0 && p.z > 0.0 && r < n; r++) {
                for (int c = 0; c < n; c++) {
                    a[r][c] += terms[r] * terms[c];
                }
                a[r][6] += terms[r] * z;
            }
            if (pass == 1 && p.z > 0.0) {
                for (int r = 0; r < n; r++) {
                    z -= s.k[r] * terms[r];
                }
                s.rms_mm += z * z;
                s.n++;
            }
        }
        if (pass == 0) {
            generated_solve(a, n);
            for (int r = 0; r < n; r++) {
                s.k[r] = a[r][6];
            }
        }
    }
    s.rms_mm = sqrt(s.rms_mm / s.n);
    return s;
}

/* Returns the principal curvature of larger size with its sign (> 0: the sides are behind), in
 * 1/mm, at the centre. */
static double curvature(const struct surface *s)
{
    double p = s->k[1], q = s->k[2], w = sqrt(1.0 + p * p + q * q);
    double e = 1.0 + p * p, f = p * q, g = 1.0 + q * q;
    double l = 2.0 * s->k[3] / w, m = s->k[4] / w, n = 2.0 * s->k[5] / w;
    double mean = (e * n - 2.0 * f * m + g * l) / (2.0 * (e * g - f * f));
    double gauss = (l * n - m * m) / (e * g - f * f);
    double root = sqrt(fmax(mean * mean - gauss, 0.0));
    return mean >= 0.0 ? mean + root : mean - root;
}

/* A flat print is a plane except for errors of the sensor: 0.8 mm of noise and 1.4 mm steps at 0.7
 * m, and 0.6 mm of waves. Wherever the sheet is held, the centre of the image is on it. */
static void flat_is_flat(void **state)
{
    (void)corpus(state);
    double worst = 0.0;
    char name[64];
    for (int i = 0; i < PER_KIND; i++) {
        (void)snprintf(name, sizeof name, "none-photo-flat-%04d", i);
        struct iso_frame *frame = generated_frame(shared_directory, name, 0);
        struct surface s = fit_middle(frame, 18, false);
        assert_true(s.n > 1200);
        worst = fmax(worst, s.rms_mm);
        iso_frame_free(frame);
    }
    print_message("photo-flat: at most %.2f mm rms from a plane\n", worst);
    assert_true(worst < 1.6);
}

/* The measured radius is that of the manifest. The sensor has a high resolution and no noise. */
static void bent_has_its_radius(void **state)
{
    char directory[256];
    (void)strcpy(directory, scratch_path(*state, "bent"));
    struct sim_generate_options options = small(directory);
    options.sensor = &sim_sensor_truedepth;
    options.noise_scale = 0.0;
    options.n_per_kind = 14;
    options.frames_per_visit = 2;
    struct sim_corpus *c = generated_corpus(&options);
    int compared = 0;
    for (size_t i = 0; i < c->n_rows; i++) {
        double radius, sign = strstr(c->rows[i].expression, "hollow") ? -1.0 : 1.0;
        const char *figure = strstr(c->rows[i].expression, "-r");
        if (strncmp(c->rows[i].expression, "rolled", 6) != 0 || !figure ||
            sscanf(figure, "-r%lf", &radius) != 1) {
            continue;
        }
        struct iso_frame *frame = generated_frame(directory, c->rows[i].recording, 0);
        struct surface s = fit_middle(frame, 26, true);
        print_message("%-20s measured %+.0f mm, rms %.2f\n", c->rows[i].expression,
                      1.0 / curvature(&s), s.rms_mm);
        if (s.rms_mm < 0.25) { /* otherwise a thumb is in the way */
            assert_true(fabs(curvature(&s) - sign / radius) < 0.0016 + 0.1 / radius);
            compared++;
        }
        iso_frame_free(frame);
    }
    assert_true(compared >= 6);
    sim_corpus_free(c);
}

/* Returns the width of the object before the wall in mm, in its widest row above the face centre.
 */
static double breadth_mm(const struct iso_frame *frame)
{
    double widest = 0.0;
    for (int row = 0; row < frame->height_px / 2; row++) {
        double least = 1e9, most = -1e9;
        for (int column = 0; column < frame->width_px; column++) {
            struct iso_vec3 p = generated_point(frame, column, row);
            if (p.z > 0.0 && p.z < 1150.0) {
                least = fmin(least, p.x);
                most = fmax(most, p.x);
            }
        }
        widest = fmax(widest, most - least);
    }
    return widest;
}

/* Heads and faces are 110 to 190 mm wide. Prints of another scale are wider or narrower by that
 * scale. */
static void masks_have_the_wrong_size(void **state)
{
    const struct sim_corpus *c = corpus(state);
    int n = 0;
    for (size_t i = 0; i < c->n_rows; i++) {
        double scale;
        const char *figure = strstr(c->rows[i].expression, "-x");
        if (strncmp(c->rows[i].note, "mask-", 5) != 0 || !figure ||
            sscanf(figure, "-x%lf", &scale) != 1) {
            continue;
        }
        bool small_one = strcmp(c->rows[i].note, "mask-small") == 0;
        struct iso_frame *frame = generated_frame(shared_directory, c->rows[i].recording, 0);
        double natural = breadth_mm(frame) / scale;
        print_message("%s %s: %.0f mm at scale 1\n", c->rows[i].recording, c->rows[i].expression,
                      natural);
        assert_true(small_one ? scale >= 0.45 && scale <= 0.8 : scale >= 1.25 && scale <= 1.6);
        assert_true(natural > 105.0 && natural < 215.0);
        n++;
        iso_frame_free(frame);
    }
    assert_int_equal(n, 2 * PER_KIND);
}

static void impossible_options_are_refused(void **state)
{
    struct sim_generate_options options = small(scratch_path(*state, "bad"));
    struct iso_fault fault = {.text = ""};
    options.sensor = &sim_sensor_texas;
    assert_int_equal(sim_generate(&options, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, "texas"));
    options.sensor = NULL;
    options.n_per_kind = 0;
    assert_int_equal(sim_generate(&options, &fault), -EINVAL);
    options.n_per_kind = 1;
    options.n_people = 0;
    assert_int_equal(sim_generate(&options, &fault), -EINVAL);
    assert_false(scratch_exists(scratch_path(*state, "bad")));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rows_are_as_documented),
        cmocka_unit_test(the_same_options_make_the_same_bytes),
        cmocka_unit_test(a_frozen_frame_does_not_change_by_a_bit),
        cmocka_unit_test(a_still_mask_changes_by_noise_alone),
        cmocka_unit_test(people_sway),
        cmocka_unit_test(flat_is_flat),
        cmocka_unit_test(bent_has_its_radius),
        cmocka_unit_test(masks_have_the_wrong_size),
        cmocka_unit_test(impossible_options_are_refused),
    };
    return cmocka_run_group_tests(tests, scratch_setup, tear_down);
}
