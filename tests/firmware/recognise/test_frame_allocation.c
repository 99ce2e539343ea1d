/* After its first frames the appliance allocates nothing for a frame, from depths to verdict, with
 * many people enrolled. Neither the product nor a library that it calls allocates. (The test does
 * not cover the check of images, because OpenCV's detector allocates. It does not cover the work
 * after a verdict, which is a record in the log. It does not cover SQLite's work for a person who
 * takes part in the reranking for the first time; later frames do not ask SQLite for this person.)
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"
#include "drivers/recording/recording.h"
#include "firmware/recognise/pipeline.h"
#include "firmware/recognise/track.h"
#include "firmware/visit/decision.h"
#include "tests/support/memory/counted_memory.h"

enum { FRAMES = 8, PEOPLE = 2000, ROUNDS = 3 };

/* Frames that were read before: an enrolled person, another person, nobody, and a photograph. */
static const char *const recordings[] = {"p01-v1", "x01-v1", "none-nobody1", "none-photo1"};
enum { RECORDINGS = sizeof recordings / sizeof *recordings };

/* Opens templates as the gallery does, but from memory. */
struct owner {
    struct iso_template tmpl;
    int opened;
};

struct rig {
    struct owner owner;
    struct iso_pipeline pipeline;
    struct iso_index *index;
    struct iso_track track;
    struct iso_decision decision;
    struct iso_extraction extraction;
    struct iso_frame *frames[RECORDINGS][FRAMES];
    int n_frames[RECORDINGS];
    int faces, verdicts, allowed;
};

static void read_frames(const char *name, struct iso_frame **frames, int *n)
{
    char path[512];
    struct iso_recording *recording = NULL;
    (void)snprintf(path, sizeof path, "%s/sim/stored/%s", ISOTHERM_SOURCE_DIR, name);
    assert_int_equal(iso_recording_open(path, &recording, NULL), 0);
    const size_t there = iso_recording_frames(recording);
    for (*n = 0; *n < FRAMES && (size_t)*n < there; ++*n) {
        assert_int_equal(iso_recording_frame_new(recording, &frames[*n]), 0);
        assert_int_equal(iso_recording_read(recording, (size_t)*n, frames[*n], NULL), 0);
    }
    iso_recording_close(recording);
}

/* All people have the same template. */
static int open_template(void *context, int64_t person, struct iso_template *out, int capacity,
                         int *n, struct iso_fault *fault)
{
    struct owner *owner = context;
    (void)person;
    (void)fault;
    assert_true(capacity >= 1);
    *out = owner->tmpl;
    *n = 1;
    owner->opened++;
    return 0;
}

/* Puts people into the index: number 1, who is on the first frame, and others with invented
 * vectors.
 */
static void enrol(struct rig *rig)
{
    const struct iso_metric *metric = rig->pipeline.ops->metric(rig->pipeline.self);
    struct iso_metric_vector own, other;
    assert_int_equal(iso_index_new(metric, &rig->index), 0);
    assert_int_equal(iso_index_reserve(rig->index, PEOPLE), 0);
    assert_int_equal(
        rig->pipeline.ops->extract(rig->pipeline.self, rig->frames[0][0], "", &rig->extraction), 0);
    assert_int_equal(iso_metric_project(metric, &rig->extraction.tmpl, &own), 0);
    assert_int_equal(iso_index_put(rig->index, 1, &own), 0);
    rig->owner.tmpl = rig->extraction.tmpl;
    for (int i = 1; i < PEOPLE; i++) {
        other = own;
        for (int d = 0; d < metric->n_dimensions; d++) {
            other.mean[d] = 3.0f * sinf((float)(i * (d + 2)));
        }
        assert_int_equal(iso_index_put(rig->index, 1 + i, &other), 0);
    }
}

static void count_verdict(struct rig *rig, bool reached, const struct iso_verdict *verdict)
{
    rig->verdicts += reached;
    rig->allowed += reached && verdict->allow;
}

/* Does the same as the appliance (appliance_frame.c), without the stores and the bus. */
static void run_frame(struct rig *rig, const struct iso_frame *frame, int64_t t_ns)
{
    const struct iso_pipeline *pipeline = &rig->pipeline;
    struct iso_track_motion motion = {0};
    struct iso_verdict verdict;
    struct iso_search_hit hits[2];
    int n = 0;
    count_verdict(rig, iso_decision_time(&rig->decision, t_ns, &verdict), &verdict);
    assert_int_equal(pipeline->ops->extract(pipeline->self, frame, "", &rig->extraction), 0);
    if (rig->extraction.fitted) {
        motion = iso_track_pose(&rig->track, t_ns, &rig->extraction.camera_from_face);
    }
    if (rig->extraction.outcome != ISO_CAPTURE_OK) {
        return;
    }
    const struct iso_candidate_list among = {
        .index = rig->index, .templates = open_template, .owner = &rig->owner};
    assert_int_equal(
        pipeline->ops->search(pipeline->self, &among, &rig->extraction.tmpl, hits, 2, &n), 0);
    const struct iso_decision_frame face = {t_ns,          hits[0].person, hits[0].score,
                                            hits[1].score, true,           motion.track};
    rig->faces++;
    count_verdict(rig, iso_decision_track(&rig->decision, motion.track, &verdict), &verdict);
    count_verdict(rig, iso_decision_face(&rig->decision, &face, &verdict), &verdict);
}

/* Shows each frame in turn, with two seconds between people. */
static void run_all(struct rig *rig, int64_t *t_ns)
{
    for (int r = 0; r < RECORDINGS; r++) {
        for (int i = 0; i < rig->n_frames[r]; i++) {
            *t_ns += 33 * ISO_NS_PER_MS;
            run_frame(rig, rig->frames[r][i], *t_ns);
        }
        *t_ns += 2 * ISO_NS_PER_S;
    }
}

static void a_warm_frame_allocates_nothing(void **state)
{
    (void)state;
    static struct rig rig;
    struct iso_pipeline_options options = {
        .head_path = ISOTHERM_SOURCE_DIR "/core/data/head.model",
        .data_path = ISOTHERM_SOURCE_DIR "/core/data/face.metric",
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = iso_times_system().monotonic,
        .image = ISO_IMAGE_OFF,
    };
    const struct iso_decision_options decision = {
        .threshold = 3.0,
        .margin = 0.5,
        .agree = 2,
        .max_frames = 10,
        .attack_frames = 3,
        .gap_ns = ISO_NS_PER_S,
        .refractory_ns = ISO_NS_PER_S,
        .stale_ns = ISO_NS_PER_S,
    };
    const struct iso_track_options track = {ISO_NS_PER_S, 1e9, 1e9, 1, 1};
    int64_t t_ns = ISO_NS_PER_S;
    options.extract.track = true;
    assert_int_equal(iso_pipeline_open(&options, &rig.pipeline, NULL), 0);
    iso_decision_init(&rig.decision, &decision);
    iso_track_init(&rig.track, &track);
    for (int r = 0; r < RECORDINGS; r++) {
        read_frames(recordings[r], rig.frames[r], &rig.n_frames[r]);
    }
    enrol(&rig);
    run_all(&rig, &t_ns);
    rig.faces = rig.verdicts = rig.allowed = rig.owner.opened = 0;
    const unsigned long before = counted_memory();
    for (int round = 0; round < ROUNDS; round++) {
        run_all(&rig, &t_ns);
    }
    const unsigned long after = counted_memory();
    print_message("%d faces, %d verdicts (%d allowed), %d people opened, %lu allocations\n",
                  rig.faces, rig.verdicts, rig.allowed, rig.owner.opened, after - before);
    assert_int_equal(after, before);
    assert_true(rig.faces >= 4 * ROUNDS && rig.allowed >= ROUNDS && rig.verdicts > rig.allowed);
    for (int r = 0; r < RECORDINGS; r++) {
        for (int i = 0; i < rig.n_frames[r]; i++) {
            iso_frame_free(rig.frames[r][i]);
        }
    }
    iso_index_free(rig.index);
    iso_pipeline_close(&rig.pipeline);
}

/* If the counter did not count, the test of the frames would show nothing. */
static void the_counter_counts(void **state)
{
    (void)state;
    const unsigned long before = counted_memory();
    void *volatile some[] = {malloc(3), calloc(3, 5), aligned_alloc(64, 64), NULL, strdup("x")};
    some[3] = realloc(NULL, 7);
    assert_int_equal(counted_memory() - before, 5);
    for (size_t i = 0; i < sizeof some / sizeof *some; i++) {
        free(some[i]);
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_counter_counts),
        cmocka_unit_test(a_warm_frame_allocates_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
