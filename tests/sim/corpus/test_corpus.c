/* Manifests of corpora. */
#include <errno.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <cmocka.h>

#include "sim/corpus/corpus.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"
#include "tests/support/stored_frames.h"

#define HEADER "recording,first,count,subject,session,role,pose,expression,note\n"

static const char good[] = HEADER "a,0,2,anna,s0,gallery,frontal,neutral,\n"
                                  "a,2,1,anna,s0,probe,yaw_l,smile,glasses on\n"
                                  "b,0,3,none,,impostor,,,nobody\r\n";

static void parses_rows_in_order(void **state)
{
    struct sim_corpus *corpus = NULL;
    (void)state;
    assert_int_equal(sim_corpus_parse("m", good, &corpus, NULL), 0);
    assert_int_equal(corpus->n_rows, 3);
    const struct sim_corpus_row *row = &corpus->rows[1];
    assert_string_equal(row->recording, "a");
    assert_int_equal(row->first, 2);
    assert_int_equal(row->count, 1);
    assert_string_equal(row->subject, "anna");
    assert_string_equal(row->session, "s0");
    assert_int_equal(row->role, SIM_ROLE_PROBE);
    assert_string_equal(row->pose, "yaw_l");
    assert_string_equal(row->expression, "smile");
    assert_string_equal(row->note, "glasses on");
    assert_int_equal(corpus->rows[2].role, SIM_ROLE_IMPOSTOR);
    assert_string_equal(corpus->rows[2].note, "nobody");
    sim_corpus_free(corpus);
    sim_corpus_free(NULL);
}

static void the_first_word_of_a_note_is_the_origin(void **state)
{
    (void)state;
    struct sim_corpus_row row = {.note = "test-7 enrolled-behind"};
    assert_int_equal(sim_corpus_origin_length(row.note), 6);
    assert_int_equal(sim_corpus_origin_length(""), 0);
    assert_true(sim_corpus_row_is_of(&row, "test-7"));
    assert_true(sim_corpus_row_is_of(&row, "test-7 stranger-behind"));
    assert_false(sim_corpus_row_is_of(&row, "test-70"));
    assert_false(sim_corpus_row_is_of(&row, "test-"));
    assert_false(sim_corpus_row_is_of(&row, ""));
    row.note[0] = '\0';
    assert_false(sim_corpus_row_is_of(&row, ""));
    assert_false(sim_corpus_row_is_of(&row, "test-7"));
}

static void assert_refused(const char *text, const char *expected)
{
    struct sim_corpus *corpus = NULL;
    struct iso_fault fault = {.text = ""};
    assert_int_equal(sim_corpus_parse("m.csv", text, &corpus, &fault), -EBADMSG);
    assert_string_equal(fault.text, expected);
    assert_null(corpus);
}

static void refuses_other_tables(void **state)
{
    (void)state;
    assert_refused("", "m.csv:1: header is not `recording,first,count,subject,session,role,pose,"
                       "expression,note`");
    assert_refused("recording,first,count,subject,session,role,pose,expression,note,mood\n",
                   "m.csv:1: header is not `recording,first,count,subject,session,role,pose,"
                   "expression,note`");
    assert_refused(HEADER, "m.csv: no rows");
    assert_refused(HEADER "a,0,1,s,,probe,,\n", "m.csv:2: 8 fields instead of 9");
    assert_refused(HEADER "a,0,1,s,,probe,,,,\n", "m.csv:2: 10 fields instead of 9");
    assert_refused(HEADER "a,0,1,s,,probe,,,\n\n", "m.csv:3: 1 fields instead of 9");
}

static void refuses_bad_fields(void **state)
{
    (void)state;
    assert_refused(HEADER "a,0,1,s,,visitor,,,\n", "m.csv:2: bad role 'visitor'");
    assert_refused(HEADER "a,0,1,s,,,,,\n", "m.csv:2: bad role ''");
    assert_refused(HEADER "a,0,0,s,,probe,,,\n", "m.csv:2: bad count '0'");
    assert_refused(HEADER "a,0,-1,s,,probe,,,\n", "m.csv:2: bad count '-1'");
    assert_refused(HEADER "a,1.5,1,s,,probe,,,\n", "m.csv:2: bad first '1.5'");
    assert_refused(HEADER "a,,1,s,,probe,,,\n", "m.csv:2: bad first ''");
    assert_refused(HEADER ",0,1,s,,probe,,,\n", "m.csv:2: bad recording ''");
    assert_refused(HEADER "../a,0,1,s,,probe,,,\n", "m.csv:2: bad recording '../a'");
    assert_refused(HEADER "a/b,0,1,s,,probe,,,\n", "m.csv:2: bad recording 'a/b'");
    assert_refused(HEADER "a,0,1,,,probe,,,\n", "m.csv:2: bad subject ''");
    assert_refused(HEADER "a,0,1,s,,probe,,,\"x\"\n", "m.csv:2: bad note '\"x\"'");
    assert_refused(HEADER "a,0,1,s,,probe,\t,,\n", "m.csv:2: bad pose '\t'");
    assert_refused(HEADER "a,0,1,s234567890123456789012345678901234567890123456789012345678901234,"
                          ",probe,,,\n",
                   "m.csv:2: bad subject "
                   "'s234567890123456789012345678901234567890123456789012345678901234'");
}

static void refuses_contradictions(void **state)
{
    (void)state;
    assert_refused(HEADER "a,0,1,s,,probe,,,\nb,0,1,s,,probe,,,\na,0,1,s,,probe,x,y,z\n",
                   "m.csv:4: repeated row");
    assert_refused(HEADER "a,0,1,s,,impostor,,,\nb,0,1,s,,probe,,,\nc,0,1,s,,gallery,,,\n",
                   "m.csv:2: impostor 's' is in the gallery");
}

static void the_same_frames_may_serve_twice(void **state)
{
    static const char text[] = HEADER "a,0,1,s,,gallery,,,\na,0,1,s,,probe,,,\na,0,2,s,,probe,,,\n";
    struct sim_corpus *corpus = NULL;
    (void)state;
    assert_int_equal(sim_corpus_parse("m", text, &corpus, NULL), 0);
    sim_corpus_free(corpus);
}

/* ---- on disk ---------------------------------------------------------------- */

/* Makes the scratch directory a corpus of the recordings `a` and `b`, with three frames each. */
static int setup(void **state)
{
    int error = scratch_setup(state);
    if (!error) {
        stored_frames_write(scratch_path(*state, "a"), 3);
        stored_frames_write(scratch_path(*state, "b"), 3);
        scratch_write_text(scratch_path(*state, "manifest.csv"), good);
    }
    return error;
}

static void assert_read_refused(void **state, const char *manifest, int error, const char *expected)
{
    struct sim_corpus *corpus = NULL;
    struct iso_fault fault = {.text = ""};
    if (manifest) {
        scratch_write_text(scratch_path(*state, "manifest.csv"), manifest);
    }
    assert_int_equal(sim_corpus_read(*state, &corpus, &fault), error);
    assert_non_null(strstr(fault.text, expected));
    assert_null(corpus);
}

static void reads_a_corpus(void **state)
{
    struct sim_corpus *corpus = NULL;
    assert_int_equal(sim_corpus_read(*state, &corpus, NULL), 0);
    assert_int_equal(corpus->n_rows, 3);
    sim_corpus_free(corpus);
}

static void frames_must_be_there(void **state)
{
    assert_read_refused(state, HEADER "a,0,3,s,,probe,,,\na,2,2,s,,probe,,,\n", -EBADMSG,
                        "manifest.csv:3: recording a has 3 frames");
    assert_read_refused(state, HEADER "a,3,1,s,,probe,,,\n", -EBADMSG,
                        "manifest.csv:2: recording a has 3 frames");
    assert_read_refused(state, HEADER "a,999999999999999999,999999999999999999,s,,probe,,,\n",
                        -EBADMSG, "manifest.csv:2: recording a has 3 frames");
    assert_read_refused(state, HEADER "a,0,1,s,,probe,,,\nc,0,1,s,,probe,,,\n", -EBADMSG,
                        "manifest.csv:3: ");
    assert_read_refused(state, NULL, -EBADMSG, "c/recording.ini: No such file or directory");
}

static void names_a_broken_recording_by_its_row(void **state)
{
    scratch_write_text(scratch_path(*state, "b/recording.ini"), "[depth]\nfoo = 1\n");
    assert_read_refused(state, NULL, -EBADMSG, "manifest.csv:4: ");
    assert_read_refused(state, NULL, -EBADMSG, "b/recording.ini:2: unknown key 'foo' in [depth]");
}

static void names_a_missing_manifest(void **state)
{
    assert_int_equal(unlink(scratch_path(*state, "manifest.csv")), 0);
    assert_read_refused(state, NULL, -ENOENT, "manifest.csv: No such file or directory");
}

static void a_written_manifest_is_read_back(void **state)
{
    struct sim_corpus *first = NULL, *second = NULL;
    assert_int_equal(sim_corpus_read(*state, &first, NULL), 0);
    assert_int_equal(sim_corpus_write(*state, first->rows, first->n_rows, NULL), 0);
    assert_false(scratch_exists(scratch_path(*state, "manifest.csv.new")));
    assert_int_equal(sim_corpus_read(*state, &second, NULL), 0);
    assert_int_equal(second->n_rows, first->n_rows);
    assert_memory_equal(second->rows, first->rows, first->n_rows * sizeof *first->rows);
    sim_corpus_free(first);
    sim_corpus_free(second);
}

static void assert_write_refused(void **state, const struct sim_corpus_row *rows, size_t n,
                                 const char *expected)
{
    struct iso_fault fault = {.text = ""};
    size_t size;
    assert_int_equal(sim_corpus_write(*state, rows, n, &fault), -EINVAL);
    assert_non_null(strstr(fault.text, expected));
    char *kept = scratch_read(scratch_path(*state, "manifest.csv"), &size);
    assert_int_equal(size, strlen(good));
    free(kept);
}

static void refuses_to_write_what_cannot_be_read(void **state)
{
    struct sim_corpus_row rows[2] = {
        {.recording = "a", .count = 1, .subject = "s"},
        {.recording = "a", .count = 1, .subject = "s"},
    };
    assert_write_refused(state, rows, 0, "manifest.csv: no rows");
    assert_write_refused(state, rows, 2, "manifest.csv:3: repeated row");
    rows[1].count = 0;
    assert_write_refused(state, rows, 2, "manifest.csv:3: bad count");
    rows[1].count = 2;
    rows[1].role = SIM_ROLES;
    assert_write_refused(state, rows, 2, "manifest.csv:3: bad role");
    rows[1].role = SIM_ROLE_IMPOSTOR;
    assert_write_refused(state, rows, 2, "manifest.csv:3: impostor 's' is in the gallery");
    rows[1].role = SIM_ROLE_PROBE;
    (void)strcpy(rows[1].note, "a,b");
    assert_write_refused(state, rows, 2, "manifest.csv:3: bad note");
    memset(rows[1].note, 'x', sizeof rows[1].note); /* the text has no end */
    assert_write_refused(state, rows, 2, "manifest.csv:3: bad note");
    rows[1].note[0] = '\0';
    (void)strcpy(rows[1].recording, ".hidden");
    assert_write_refused(state, rows, 2, "manifest.csv:3: bad recording");
}

static void reports_where_it_cannot_write(void **state)
{
    const struct sim_corpus_row row = {.recording = "a", .count = 1, .subject = "s"};
    struct iso_fault fault;
    assert_int_equal(sim_corpus_write(scratch_path(*state, "none"), &row, 1, &fault), -ENOENT);
    assert_non_null(strstr(fault.text, "none/manifest.csv.new: No such file or directory"));
}

static void reads_the_real_corpus(void **state)
{
    const char *corpus_path = shared_data_or_skip("data/kinect2-faces");
    struct sim_corpus *corpus = NULL;
    size_t of_role[SIM_ROLES] = {0};
    (void)state;
    assert_int_equal(sim_corpus_read(corpus_path, &corpus, NULL), 0);
    for (size_t i = 0; i < corpus->n_rows; i++) {
        of_role[corpus->rows[i].role]++;
    }
    assert_int_equal(of_role[SIM_ROLE_GALLERY], 14);
    assert_int_equal(of_role[SIM_ROLE_PROBE], 364);
    sim_corpus_free(corpus);
}

#define IN_CORPUS(test) cmocka_unit_test_setup_teardown(test, setup, scratch_teardown)

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(parses_rows_in_order),
        cmocka_unit_test(the_first_word_of_a_note_is_the_origin),
        cmocka_unit_test(refuses_other_tables),
        cmocka_unit_test(refuses_bad_fields),
        cmocka_unit_test(refuses_contradictions),
        cmocka_unit_test(the_same_frames_may_serve_twice),
        IN_CORPUS(reads_a_corpus),
        IN_CORPUS(frames_must_be_there),
        IN_CORPUS(names_a_broken_recording_by_its_row),
        IN_CORPUS(names_a_missing_manifest),
        IN_CORPUS(a_written_manifest_is_read_back),
        IN_CORPUS(refuses_to_write_what_cannot_be_read),
        IN_CORPUS(reports_where_it_cannot_write),
        cmocka_unit_test(reads_the_real_corpus),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
