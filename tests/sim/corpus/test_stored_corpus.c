/* The corpus that is committed with the project has everything that the demo and other tests need.
 */
#include <ftw.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "sim/corpus/corpus.h"
#include "sim/world/generate/stored.h"
#include "tests/support/scratch.h"

static const char stored[] = ISOTHERM_SOURCE_DIR "/sim/stored";

static off_t total_bytes;

static int add_size(const char *path, const struct stat *status, int type)
{
    (void)path;
    total_bytes += type == FTW_F ? status->st_size : 0;
    return 0;
}

static struct sim_corpus *open_corpus(void)
{
    struct sim_corpus *corpus = NULL;
    struct iso_fault fault = {.text = ""};
    int error = sim_corpus_read(stored, &corpus, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return corpus;
}

static int rows_of(const struct sim_corpus *corpus, const char *subject, enum sim_role role,
                   const char *note, size_t least_frames)
{
    int n = 0;
    for (size_t i = 0; i < corpus->n_rows; i++) {
        const struct sim_corpus_row *row = &corpus->rows[i];
        n += strcmp(row->subject, subject) == 0 && row->role == role &&
             strcmp(row->note, note) == 0 && row->count >= least_frames;
    }
    return n;
}

static void every_person_has_recordings(void **state)
{
    (void)state;
    struct sim_corpus *corpus = open_corpus();
    char subject[8];
    for (int i = 1; i <= 24; i++) {
        (void)snprintf(subject, sizeof subject, "p%02d", i);
        assert_int_equal(rows_of(corpus, subject, SIM_ROLE_GALLERY, "", 4), 1);
        assert_int_equal(rows_of(corpus, subject, SIM_ROLE_PROBE, "", 3), 2);
    }
    for (int i = 1; i <= 12; i++) {
        (void)snprintf(subject, sizeof subject, "x%02d", i);
        assert_int_equal(rows_of(corpus, subject, SIM_ROLE_IMPOSTOR, "", 3), 2);
    }
    assert_int_equal(rows_of(corpus, "none", SIM_ROLE_IMPOSTOR, "nobody", 3), 2);
    assert_int_equal(rows_of(corpus, "none", SIM_ROLE_IMPOSTOR, "back", 3), 3);
    assert_int_equal(rows_of(corpus, "none", SIM_ROLE_IMPOSTOR, "cut", 3), 2);
    assert_int_equal(rows_of(corpus, "none", SIM_ROLE_IMPOSTOR, "photo", 3), 3);
    assert_int_equal(corpus->n_rows, sim_stored_count());
    assert_int_equal(corpus->n_rows, 24 * 3 + 12 * 2 + 10);
    sim_corpus_free(corpus);
}

static void every_frame_is_read(void **state)
{
    (void)state;
    struct sim_corpus *corpus = open_corpus();
    for (size_t i = 0; i < corpus->n_rows; i++) {
        struct iso_recording *recording = NULL;
        struct iso_frame *frame = NULL;
        const char *path = scratch_path(stored, corpus->rows[i].recording);
        assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
        assert_string_equal(iso_recording_meta(recording)->sensor, "astra");
        assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
        for (size_t k = 0; k < corpus->rows[i].count; k++) {
            assert_int_equal(iso_recording_read(recording, k, frame, NULL), 0);
            assert_int_equal(iso_frame_check(frame, NULL), 0);
        }
        iso_frame_free(frame);
        iso_recording_close(recording);
    }
    sim_corpus_free(corpus);
}

/* sim/stored/poses: a person who turns as an enrolment asks. */
static void a_person_turns_for_an_enrolment(void **state)
{
    static const struct {
        const char *recording;
        int yaw, pitch;
    } poses[] = {{"p0000-s0", 0, 0},
                 {"p0000-s0-left", 18, 0},
                 {"p0000-s0-right", -18, 0},
                 {"p0000-s0-down", 0, -15},
                 {"p0000-s0-up", 0, 15}};
    struct sim_corpus *corpus = NULL;
    (void)state;
    assert_int_equal(sim_corpus_read(ISOTHERM_SOURCE_DIR "/sim/stored/poses", &corpus, NULL), 0);
    assert_int_equal(corpus->n_rows, sizeof poses / sizeof *poses);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        int yaw, pitch;
        assert_string_equal(corpus->rows[i].recording, poses[i].recording);
        assert_int_equal(sscanf(corpus->rows[i].pose, "y%dp%d", &yaw, &pitch), 2);
        assert_in_range(yaw - poses[i].yaw + 3, 0, 6);
        assert_in_range(pitch - poses[i].pitch + 3, 0, 6);
    }
    sim_corpus_free(corpus);
}

static void it_is_small_enough_to_commit(void **state)
{
    (void)state;
    total_bytes = 0;
    assert_int_equal(ftw(stored, add_size, 16), 0);
    assert_true(total_bytes > 1000000 && total_bytes <= 20 * 1024 * 1024);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_person_has_recordings),
        cmocka_unit_test(every_frame_is_read),
        cmocka_unit_test(a_person_turns_for_an_enrolment),
        cmocka_unit_test(it_is_small_enough_to_commit),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
