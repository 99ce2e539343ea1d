/* How often the image agrees with the landmarks on real frames, if they are present
 * (ISOTHERM_SHARED/data/kinect2-faces). face_check.h quotes this measurement. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "drivers/vision/face_check.h"
#include "drivers/vision/face_detector.h"
#include "isotherm/extract.h"
#include "sim/corpus/corpus.h"
#include "tests/support/devices/painted_face.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

enum { FRAMES = 378, KINDS = 16, EVERY = 3 };

struct tally {
    const char *name;
    int n, confirmed, contradicted;
};

struct bench {
    struct sim_corpus *corpus;
    struct iso_head_model *head;
    struct iso_extractor *extractor;
    struct iso_face_check *check;
    struct tally all, unfitted, blank;
    struct tally kinds[KINDS]; /* poses and expressions */
    struct tally aside[5];     /* by 10, 15, ... 30 mm */
    double offset_mm[FRAMES];
    int n_offsets;
};

static void count(struct tally *tally, enum iso_face_seen seen)
{
    tally->n++;
    tally->confirmed += seen == ISO_FACE_CONFIRMED;
    tally->contradicted += iso_face_seen_disagrees(seen);
}

static void count_kind(struct bench *bench, const char *name, enum iso_face_seen seen)
{
    int k = 0;
    while (bench->kinds[k].name && strcmp(bench->kinds[k].name, name) != 0) {
        k++;
    }
    assert_true(k < KINDS - 1);
    bench->kinds[k].name = name;
    count(&bench->kinds[k], seen);
}

static struct iso_face_checked ask(const struct bench *bench, const struct iso_frame *frame,
                                   struct iso_extraction at, struct iso_vec3 aside_mm)
{
    struct iso_face_checked checked;
    struct iso_vec3 by = iso_mat3_apply(&at.camera_from_face.rotation, aside_mm);
    at.camera_from_face.translation_mm = iso_add(at.camera_from_face.translation_mm, by);
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        at.landmark_mm[l] = iso_add(at.landmark_mm[l], by);
    }
    assert_int_equal(
        iso_face_check_run(bench->check, frame, &at.camera_from_face, at.landmark_mm, &checked), 0);
    return checked;
}

/* Counts the answers for landmarks that are moved aside, in eight directions in turn, and for the
 * same surface with even brightness. */
static void ask_wrongly(struct bench *bench, struct iso_frame *frame,
                        const struct iso_extraction *found, size_t number)
{
    for (int k = 0; k < 5; k++) {
        const double by_mm = 10.0 + 5.0 * k, angle = 0.785398163 * (double)(number / EVERY % 8);
        const struct iso_vec3 aside = {by_mm * cos(angle), by_mm * sin(angle), 0.0};
        count(&bench->aside[k], ask(bench, frame, *found, aside).seen);
    }
    painted_blank(frame, 0.1);
    count(&bench->blank, ask(bench, frame, *found, iso_vec3(0, 0, 0)).seen);
}

static void measure(struct bench *bench, const struct sim_corpus_row *row, struct iso_frame *frame,
                    size_t number)
{
    struct iso_extraction found;
    assert_int_equal(iso_extractor_locate(bench->extractor, frame, &found), 0);
    if (!found.fitted) {
        return;
    }
    const struct iso_face_checked checked = ask(bench, frame, found, iso_vec3(0, 0, 0));
    /* All are living people. Frames that were taken for an attack also have a good fit. */
    if (found.outcome != ISO_CAPTURE_OK && !iso_capture_is_attack(found.outcome)) {
        count(&bench->unfitted, checked.seen);
        return;
    }
    count(&bench->all, checked.seen);
    count_kind(bench, row->pose, checked.seen);
    count_kind(bench, row->expression, checked.seen);
    bench->offset_mm[bench->n_offsets++] = checked.offset_mm;
    if (number % EVERY == 0) {
        ask_wrongly(bench, frame, &found, number);
    }
}

static int by_value(const void *a, const void *b)
{
    const double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static void print_tally(const struct tally *tally)
{
    print_message("%-14s %3d frames, %3d confirmed, %3d contradicted\n", tally->name, tally->n,
                  tally->confirmed, tally->contradicted);
}

static void report(struct bench *bench)
{
    print_tally(&bench->all);
    for (int k = 0; bench->kinds[k].name; k++) {
        print_tally(&bench->kinds[k]);
    }
    print_tally(&bench->unfitted);
    for (int k = 0; k < 5; k++) {
        print_tally(&bench->aside[k]);
    }
    print_tally(&bench->blank);
    const int n = bench->n_offsets;
    qsort(bench->offset_mm, (size_t)n, sizeof *bench->offset_mm, by_value);
    print_message("offset: median %.1f, p99 %.1f, most %.1f mm\n", bench->offset_mm[n / 2],
                  bench->offset_mm[n * 99 / 100], bench->offset_mm[n - 1]);
}

static void set_up(struct bench *bench, const char *directory)
{
    const struct iso_extract_options options = iso_extract_options_default();
    struct iso_fault fault = {.text = ""};
    size_t size = 0;
    void *bytes = scratch_read(ISOTHERM_SOURCE_DIR "/core/data/head.model", &size);
    assert_int_equal(iso_head_model_parse(bytes, size, &bench->head, NULL), 0);
    free(bytes);
    assert_int_equal(iso_extractor_new(bench->head, &options, &bench->extractor), 0);
    if (sim_corpus_read(directory, &bench->corpus, &fault) ||
        iso_face_check_new("", &bench->check, &fault)) {
        fail_msg("%s", fault.text);
    }
    bench->all.name = "fitted";
    bench->unfitted.name = "not usable";
    bench->blank.name = "evenly bright";
    static const char *const aside[] = {"10 mm aside", "15 mm aside", "20 mm aside", "25 mm aside",
                                        "30 mm aside"};
    for (int k = 0; k < 5; k++) {
        bench->aside[k].name = aside[k];
    }
}

static void measure_corpus(struct bench *bench, const char *directory)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    const char *open = "";
    for (size_t i = 0; i < bench->corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &bench->corpus->rows[i];
        if (strcmp(row->recording, open) != 0) {
            iso_frame_free(frame);
            iso_recording_close(recording);
            open = row->recording;
            assert_int_equal(iso_recording_open(scratch_path(directory, open), &recording, NULL),
                             0);
            assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
        }
        assert_int_equal(iso_recording_read(recording, row->first, frame, NULL), 0);
        measure(bench, row, frame, i);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static void real_faces(void **state)
{
    static struct bench bench;
    const char *directory = shared_data("data/kinect2-faces");
    (void)state;
    if (!scratch_exists(directory) || !*iso_face_detector_engine()) {
        skip();
    }
    set_up(&bench, directory);
    assert_int_equal(bench.corpus->n_rows, FRAMES);
    measure_corpus(&bench, directory);
    report(&bench);
    /* A veto must accept 99 % of the good frames, and must find enough of the others. */
    assert_true(bench.all.n >= 340);
    assert_true(100 * bench.all.contradicted <= bench.all.n);
    assert_true(100 * bench.all.confirmed >= 99 * bench.all.n);
    assert_true(100 * bench.aside[4].contradicted >= 99 * bench.aside[4].n);
    assert_true(100 * bench.blank.contradicted >= 99 * bench.blank.n);
    iso_face_check_free(bench.check);
    iso_extractor_free(bench.extractor);
    iso_head_model_free(bench.head);
    sim_corpus_free(bench.corpus);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(real_faces),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
