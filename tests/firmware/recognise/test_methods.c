/* The contract of a recognition method (firmware/recognise/method/method.h), for each method of the
 * registry, with the templates of stored recordings. */
#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/recording/recording.h"
#include "firmware/config/config.h"
#include "firmware/recognise/pipeline.h"

#define HEAD ISOTHERM_SOURCE_DIR "/core/data/head.model"

enum { PEOPLE = 3, PROBE = PEOPLE, TEMPLATES = PEOPLE + 1 };

/* Three people at their enrolment, and the second of them on another day. */
static const char *const recordings[TEMPLATES] = {"p01-enrol", "p02-enrol", "p04-enrol", "p02-v1"};

struct faces {
    struct iso_template tmpl[TEMPLATES];
};

static struct iso_pipeline open_pipeline(enum iso_method method)
{
    const struct iso_method_ops *ops = iso_method_at(method);
    const struct iso_pipeline_options options = {
        .head_path = HEAD,
        .method = method,
        .data_path = ops->installed_data ? ops->installed_data() : NULL,
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = iso_times_system().monotonic,
    };
    struct iso_pipeline pipeline = {0};
    struct iso_fault fault = {.text = ""};
    if (iso_pipeline_open(&options, &pipeline, &fault)) {
        fail_msg("%s: %s", ops->name, fault.text);
    }
    return pipeline;
}

/* Reads the template of the first usable frame of a recording. */
static void read_template(const struct iso_pipeline *pipeline, const char *name,
                          struct iso_template *out)
{
    char path[512];
    struct iso_recording *recording = NULL;
    struct iso_frame *frame = NULL;
    struct iso_extraction extraction = {.outcome = ISO_CAPTURE_NOBODY};
    (void)snprintf(path, sizeof path, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, name);
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    assert_int_equal(iso_recording_frame_new(recording, &frame), 0);
    for (size_t i = 0; extraction.outcome != ISO_CAPTURE_OK; i++) {
        assert_int_equal(iso_recording_read(recording, i, frame, NULL), 0);
        assert_int_equal(pipeline->ops->extract(pipeline->self, frame, "", &extraction), 0);
    }
    *out = extraction.tmpl;
    iso_frame_free(frame);
    iso_recording_close(recording);
}

static int set_up(void **state)
{
    struct faces *faces = calloc(1, sizeof *faces);
    struct iso_pipeline pipeline = open_pipeline(ISO_METHOD_metric);
    assert_non_null(faces);
    for (int i = 0; i < TEMPLATES; i++) {
        read_template(&pipeline, recordings[i], &faces->tmpl[i]);
    }
    iso_pipeline_close(&pipeline);
    *state = faces;
    return 0;
}

static int tear_down(void **state)
{
    free(*state);
    return 0;
}

struct search {
    struct iso_pipeline pipeline;
    struct iso_search_entry entries[PEOPLE];
    struct iso_candidate_list among;
    struct iso_search_hit hits[PEOPLE];
    int n;
};

/* Person 1 + i has template i. */
static void open_search(const struct faces *faces, enum iso_method method, struct search *search)
{
    *search = (struct search){.pipeline = open_pipeline(method)};
    for (int i = 0; i < PEOPLE; i++) {
        search->entries[i] = (struct iso_search_entry){.person = 1 + i, .tmpl = &faces->tmpl[i]};
    }
    search->among = (struct iso_candidate_list){.entries = search->entries, .n_entries = PEOPLE};
}

static int run(struct search *search, const struct iso_template *probe, int capacity)
{
    search->n = -1;
    return search->pipeline.ops->search(search->pipeline.self, &search->among, probe, search->hits,
                                        capacity, &search->n);
}

static void the_same_person_has_the_best_score(void **state)
{
    const struct faces *faces = *state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        struct search search;
        open_search(faces, method, &search);
        assert_int_equal(run(&search, &faces->tmpl[PROBE], PEOPLE), 0);
        assert_true(search.n >= 2 && search.n <= PEOPLE);
        assert_int_equal(search.hits[0].person, 2);
        for (int i = 0; i + 1 < search.n; i++) {
            assert_true(search.hits[i].score >= search.hits[i + 1].score);
        }
        print_message("%s: %.2f, a stranger %.2f\n", iso_method_at(method)->name,
                      search.hits[0].score, search.hits[1].score);
        assert_true(search.hits[0].score > search.hits[1].score);
        if (iso_method_at(method)->calibrated) {
            assert_true(search.hits[0].score > 3.0 && search.hits[1].score < 3.0);
        }
        iso_pipeline_close(&search.pipeline);
    }
}

static void a_search_has_the_same_result_again(void **state)
{
    const struct faces *faces = *state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        struct search search;
        open_search(faces, method, &search);
        assert_int_equal(run(&search, &faces->tmpl[PROBE], PEOPLE), 0);
        const struct search first = search;
        assert_int_equal(run(&search, &faces->tmpl[0], PEOPLE), 0);
        assert_int_equal(search.hits[0].person, 1);
        if (search.pipeline.ops->forget) {
            search.pipeline.ops->forget(search.pipeline.self);
        }
        assert_int_equal(run(&search, &faces->tmpl[PROBE], PEOPLE), 0);
        assert_int_equal(search.n, first.n);
        for (int i = 0; i < first.n; i++) {
            assert_int_equal(search.hits[i].person, first.hits[i].person);
            assert_memory_equal(&search.hits[i].score, &first.hits[i].score, sizeof(double));
        }
        iso_pipeline_close(&search.pipeline);
    }
}

static void a_search_writes_no_more_hits_than_it_has_room_for(void **state)
{
    const struct faces *faces = *state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        struct search search;
        open_search(faces, method, &search);
        search.hits[1] = (struct iso_search_hit){.person = 77};
        assert_int_equal(run(&search, &faces->tmpl[PROBE], 1), 0);
        assert_int_equal(search.n, 1);
        assert_int_equal(search.hits[0].person, 2);
        assert_int_equal(search.hits[1].person, 77);
        search.among = (struct iso_candidate_list){0};
        assert_int_equal(run(&search, &faces->tmpl[PROBE], 1), 0);
        assert_int_equal(search.n, 0);
        iso_pipeline_close(&search.pipeline);
    }
}

static void a_person_of_several_templates_is_one_hit(void **state)
{
    const struct faces *faces = *state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        struct search search;
        open_search(faces, method, &search);
        search.entries[2].person = 2; /* a stranger's face beside the person's own */
        assert_int_equal(run(&search, &faces->tmpl[1], PEOPLE), 0);
        assert_int_equal(search.n, 2);
        assert_true(search.hits[0].person != search.hits[1].person);
        iso_pipeline_close(&search.pipeline);
    }
}

static void a_probe_that_cannot_be_compared_is_refused(void **state)
{
    const struct faces *faces = *state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        struct search search;
        struct iso_template probe = faces->tmpl[PROBE];
        open_search(faces, method, &search);
        memset(probe.weight, 0, sizeof probe.weight);
        assert_int_equal(run(&search, &probe, PEOPLE), -ENODATA);
        probe = faces->tmpl[PROBE];
        probe.algorithm++;
        assert_int_equal(run(&search, &probe, PEOPLE), -EINVAL);
        iso_pipeline_close(&search.pipeline);
    }
}

static void a_data_file_of_other_templates_is_refused(void **state)
{
    (void)state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        const struct iso_method_ops *ops = iso_method_at(method);
        void *self = NULL;
        struct iso_fault fault = {.text = ""};
        struct iso_method_setup setup = {.match = iso_match_options_default(), .algorithm = 1};
        if (!ops->data_key) {
            continue;
        }
        setup.data_path = ops->installed_data();
        assert_int_equal(ops->open(&setup, &self, &fault), -EINVAL);
        assert_int_equal(fault.code, ISO_FAULT_MODEL_MISFIT);
        setup.data_path = HEAD;
        assert_int_equal(ops->open(&setup, &self, &fault), -EBADMSG);
        assert_int_equal(fault.code, ISO_FAULT_MODEL_DAMAGED);
        setup.data_path = "/nonexistent/data";
        assert_int_equal(ops->open(&setup, &self, &fault), -ENOENT);
        assert_non_null(strstr(fault.text, "/nonexistent/data"));
        assert_null(self);
    }
}

static const struct iso_config_key *find_key(const char *section, const char *name)
{
    for (size_t i = 0; i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        if (strcmp(key->section, section) == 0 && strcmp(key->name, name) == 0) {
            return key;
        }
    }
    fail_msg("[%s] has no key '%s'", section, name);
    return NULL;
}

static void the_configuration_knows_every_method(void **state)
{
    char names[256] = "";
    (void)state;
    for (enum iso_method method = 0; method < ISO_METHODS; method++) {
        const struct iso_method_ops *ops = iso_method_at(method);
        const size_t used = strlen(names);
        (void)snprintf(names + used, sizeof names - used, "%s%s", used ? "|" : "", ops->name);
        assert_int_equal(ops->data_key == NULL, ops->installed_data == NULL);
        if (ops->data_key) {
            (void)find_key("model", ops->data_key);
        }
    }
    assert_string_equal(find_key("match", "method")->choices, names);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_same_person_has_the_best_score),
        cmocka_unit_test(a_search_has_the_same_result_again),
        cmocka_unit_test(a_search_writes_no_more_hits_than_it_has_room_for),
        cmocka_unit_test(a_person_of_several_templates_is_one_hit),
        cmocka_unit_test(a_probe_that_cannot_be_compared_is_refused),
        cmocka_unit_test(a_data_file_of_other_templates_is_refused),
        cmocka_unit_test(the_configuration_knows_every_method),
    };
    return cmocka_run_group_tests(tests, set_up, tear_down);
}
