/* Frames that the memory of frames takes for repeated (core/presentation/frame_memory.h). It takes
 * none of a head that does not move at all before a sensor model, and none of a stored or real
 * recording that is played once. It takes all frames of a recording that is played again. The first
 * test prints the similarities from which ISO_FINGERPRINT_SAME was chosen. The rendered heads need
 * the head model's data (ISOTHERM_SHARED/data/ict-face), the real recordings need
 * ISOTHERM_SHARED/data/kinect2-faces. */
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "core/presentation/frame_memory.h"
#include "drivers/recording/recording.h"
#include "isotherm/extract.h"
#include "sim/corpus/corpus.h"
#include "sim/world/scene/room.h"
#include "sim/world/scene/sitter.h"
#include "sim/world/sensor/sensor.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

static const int64_t period_ns = 33333333;

static struct iso_frame_memory *memory_new(void)
{
    const struct iso_frame_memory_options options = iso_frame_memory_options_default();
    struct iso_frame_memory *memory = NULL;
    assert_int_equal(iso_frame_memory_new(&options, &memory), 0);
    return memory;
}

/* ---- a head before a sensor model ---- */

enum { STILL_FRAMES = 16, STEREO_FRAMES = 2 };

struct studio {
    const struct sim_sensor *sensor;
    struct sim_ict *ict;
    struct sim_view *view;
    struct sim_sensor_workspace *workspace;
    struct iso_frame *frame;
    struct sim_random random;
    struct iso_vec3 nose_mm;
};

static struct studio studio_open(const struct sim_sensor *sensor, struct sim_ict *ict)
{
    struct studio s = {.sensor = sensor, .ict = ict, .random = sim_random_seeded(5, 15, 0)};
    assert_int_equal(sim_view_new(&sensor->camera, sensor->supersample, &s.view), 0);
    assert_int_equal(sim_sensor_workspace_new(sensor, &s.workspace), 0);
    assert_int_equal(iso_frame_new(&sensor->camera, sensor->camera.width_px,
                                   sensor->camera.height_px, false, &s.frame),
                     0);
    return s;
}

static void studio_close(struct studio *s)
{
    iso_frame_free(s->frame);
    sim_sensor_workspace_free(s->workspace);
    sim_view_free(s->view);
}

/* A person stands before the sensor. Only noise changes the frames. */
static void stand(struct studio *s, double distance_mm, double aside_mm)
{
    const bool alone = s->sensor->face_only;
    const struct sim_person person = sim_person_draw(SIM_POPULATION_TEST, 3, 1, 1.0);
    const struct sim_sitter_options wears = {.hair = true, .torso = !alone};
    const struct sim_stance stance = {.nose_mm = {aside_mm, 10.0, distance_mm}};
    struct sim_random day = sim_random_seeded(9, 9, 0);
    struct sim_sitter *sitter = NULL;
    struct sim_room *room = NULL;
    sim_view_clear(s->view);
    sim_sensor_attach(s->workspace, s->view);
    assert_int_equal(sim_sitter_new(s->ict, &person, &wears, &day, &sitter), 0);
    if (!alone) {
        assert_int_equal(sim_room_new(false, &day, &room), 0);
        assert_int_equal(sim_room_draw(room, s->view), 0);
    }
    assert_int_equal(sim_sitter_draw(sitter, &stance, s->view, NULL), 0);
    sim_view_finish(s->view);
    sim_room_free(room);
    sim_sitter_free(sitter);
    s->nose_mm = stance.nose_mm;
}

static struct iso_fingerprint shoot(struct studio *s)
{
    sim_sensor_measure(s->sensor, s->view, 1.0, &s->random, s->workspace, s->frame);
    return iso_fingerprint_of(s->frame, s->nose_mm);
}

static double likest(const struct iso_fingerprint *prints, int n)
{
    double most = 0.0;
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < i; j++) {
            most = fmax(most, iso_fingerprint_likeness(&prints[i], &prints[j]));
        }
    }
    return most;
}

static bool is_slow(const struct sim_sensor *sensor)
{
    return strncmp(sensor->name, "stereo", strlen("stereo")) == 0;
}

/* A head that does not move at all is harder to distinguish from repeated frames than any living
 * head. */
static void expect_live(struct studio *s, double distance_mm)
{
    struct iso_fingerprint prints[STILL_FRAMES];
    struct iso_frame_memory *memory = memory_new();
    const int n = is_slow(s->sensor) ? STEREO_FRAMES : STILL_FRAMES;
    int repeats = 0, filled = ISO_FINGERPRINT_CLASSES;
    stand(s, distance_mm, 20.0);
    for (int i = 0; i < n; i++) {
        prints[i] = shoot(s);
        filled = prints[i].filled < filled ? prints[i].filled : filled;
        repeats += iso_frame_memory_repeats(memory, &prints[i], i * period_ns);
    }
    print_message("%-14s %5.0f mm: %2d classes, likeness at most %.2f, %d of %d refused\n",
                  s->sensor->name, distance_mm, filled, likest(prints, n), repeats, n);
    iso_frame_memory_free(memory);
    assert_int_equal(repeats, 0);
    assert_true(filled >= ISO_FINGERPRINT_MIN);
}

static void a_head_that_does_not_move_is_never_refused(void **state)
{
    struct sim_ict *ict = NULL;
    (void)state;
    assert_int_equal(sim_ict_load(shared_data_or_skip("data/ict-face"), &ict, NULL), 0);
    for (size_t i = 0; sim_sensors[i]; i++) {
        if (sim_sensor_load(sim_sensors[i], NULL)) {
            print_message("skipped: %s has no module\n", sim_sensors[i]->name);
            continue;
        }
        struct studio s = studio_open(sim_sensors[i], ict);
        expect_live(&s, s.sensor->distance_min_mm);
        if (!is_slow(s.sensor) && !s.sensor->face_only) {
            expect_live(&s, s.sensor->distance_max_mm);
        }
        if (s.sensor == &sim_sensor_astra || s.sensor == &sim_sensor_kinect2) {
            expect_live(&s, 1500.0); /* the Astra has steps of 6.5 mm there */
        }
        studio_close(&s);
    }
    sim_ict_free(ict);
}

/* ---- recordings ---- */

struct viewing {
    struct iso_head_model *model;
    struct iso_extractor *extractor;
    struct iso_frame_memory *memory;
    int faces, repeats, filled_min;
    int64_t t_ns;
};

static struct viewing viewing_begin(void)
{
    const struct iso_extract_options options = iso_extract_options_default();
    struct viewing v = {.memory = memory_new(), .filled_min = ISO_FINGERPRINT_CLASSES};
    size_t size = 0;
    void *bytes = scratch_read(ISOTHERM_SOURCE_DIR "/core/data/head.model", &size);
    assert_int_equal(iso_head_model_parse(bytes, size, &v.model, NULL), 0);
    free(bytes);
    assert_int_equal(iso_extractor_new(v.model, &options, &v.extractor), 0);
    return v;
}

static void viewing_end(struct viewing *v)
{
    iso_frame_memory_free(v->memory);
    iso_extractor_free(v->extractor);
    iso_head_model_free(v->model);
}

static void view_recording(struct viewing *v, const char *path)
{
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    for (size_t i = 0; i < iso_recording_frames(recording); i++) {
        struct iso_extraction found;
        assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
        assert_int_equal(iso_extractor_locate(v->extractor, frame, &found), 0);
        if (found.outcome != ISO_CAPTURE_OK) {
            continue;
        }
        const struct iso_fingerprint print = iso_fingerprint_of(
            frame, found.camera_from_face.translation_mm);
        v->filled_min = print.filled < v->filled_min ? print.filled : v->filled_min;
        v->faces++;
        v->repeats += iso_frame_memory_repeats(v->memory, &print, v->t_ns += period_ns);
    }
    iso_frame_free(frame);
    iso_recording_close(recording);
}

/* Plays every recording of a corpus once, and then the first one again. */
static void view_corpus(const char *directory, int faces_min)
{
    struct viewing v = viewing_begin();
    struct sim_corpus *corpus = NULL;
    struct iso_fault fault = {.text = ""};
    const char *last = "";
    assert_int_equal(sim_corpus_read(directory, &corpus, &fault), 0);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        if (strcmp(corpus->rows[i].recording, last) != 0) {
            last = corpus->rows[i].recording;
            view_recording(&v, scratch_path(directory, last));
        }
    }
    print_message("%s: %d usable frames of at least %d classes, %d refused\n", directory, v.faces,
                  v.filled_min, v.repeats);
    assert_true(v.faces >= faces_min);
    assert_true(v.filled_min >= ISO_FINGERPRINT_MIN);
    assert_int_equal(v.repeats, 0);
    v.faces = 0;
    view_recording(&v, scratch_path(directory, corpus->rows[0].recording));
    print_message("%s again: %d usable frames, %d refused\n", corpus->rows[0].recording, v.faces,
                  v.repeats);
    assert_true(v.faces >= 2);
    assert_int_equal(v.repeats, v.faces);
    sim_corpus_free(corpus);
    viewing_end(&v);
}

static void stored_recordings_are_known_when_they_come_again(void **state)
{
    (void)state;
    view_corpus(ISOTHERM_SOURCE_DIR "/sim/stored", 200);
}

static void real_recordings_are_known_when_they_come_again(void **state)
{
    (void)state;
    view_corpus(shared_data_or_skip("data/kinect2-faces"), 300);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_head_that_does_not_move_is_never_refused),
        cmocka_unit_test(stored_recordings_are_known_when_they_come_again),
        cmocka_unit_test(real_recordings_are_known_when_they_come_again),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
