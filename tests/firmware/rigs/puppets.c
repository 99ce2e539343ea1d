#include "tests/firmware/rigs/puppets.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/base/times.h"

/* ---- templates ---- */

struct iso_template puppet_template(int face, uint32_t algorithm)
{
    struct iso_template t = {
        .algorithm = algorithm,
        .sensor = "puppet",
        .n_radii = 1,
        .n_points = 4,
        .n_frames = 1,
        .quality = 0.75f,
        .radius_mm = {(float)face},
    };
    for (int l = 0; l < ISO_LANDMARKS; l++) {
        for (int i = 0; i < t.n_points; i++) {
            t.points_mm[0][l][i][0] = (float)(5 * l - 3 * i);
            t.points_mm[0][l][i][1] = (float)(l * l - 2 * i);
            t.points_mm[0][l][i][2] = (float)(7 * i - l);
            t.weight[0][l][i] = 1;
        }
    }
    return t;
}

int puppet_face_of(const struct iso_template *tmpl)
{
    return (int)tmpl->radius_mm[0];
}

/* ---- sensor ---- */

/* The first pixel of a frame is the face, the second the outcome, the third the position. Each
 * value is at least 100, so that it is a valid depth. The other pixels are the scene, which may
 * move. */
enum { CODE_PX = 3, WIDTH_PX = 8, ROOM_WIDTH_PX = 40, ROOM_HEIGHT_PX = 30 };

struct stream {
    struct puppet_sensor *sensor;
    float depth_mm[ROOM_WIDTH_PX * ROOM_HEIGHT_PX];
    struct iso_frame frame;
};

static struct puppet_sensor *being_opened; /* the options of a sensor cannot hold a pointer */

static int refuse(const struct puppet_sensor *sensor, int error, const char *text,
                  struct iso_fault *fault)
{
    return iso_fault_set(fault, error, "%s", sensor->text ? sensor->text : text);
}

static int stream_open(const struct iso_option *options, size_t n_options,
                       const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    struct stream *stream;
    (void)options;
    (void)n_options;
    (void)clock;
    if (being_opened->open_error) {
        return refuse(being_opened, being_opened->open_error, "puppet: will not open", fault);
    }
    stream = calloc(1, sizeof *stream);
    if (!stream) {
        return refuse(being_opened, -ENOMEM, "puppet: out of memory", fault);
    }
    stream->sensor = being_opened;
    const int width_px = being_opened->has_room ? ROOM_WIDTH_PX : WIDTH_PX;
    const int height_px = being_opened->has_room ? ROOM_HEIGHT_PX : 1;
    stream->frame = (struct iso_frame){
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = width_px,
                   .height_px = height_px,
                   .fx_px = 500,
                   .fy_px = 500,
                   .cx_px = 1},
        .width_px = width_px,
        .height_px = height_px,
        .depth_mm = stream->depth_mm,
    };
    being_opened->opened++;
    *self = stream;
    return 0;
}

static int stream_start(void *self, struct iso_fault *fault)
{
    const struct stream *stream = self;
    stream->sensor->interval_ns = 0;
    return stream->sensor->start_error
               ? iso_fault_set(fault, stream->sensor->start_error, "puppet: will not start")
               : 0;
}

static bool has_due(const struct puppet_sensor *sensor)
{
    return sensor->next < sensor->n_frames &&
           sensor->frames[sensor->next].t_ns <= iso_clock_now_ns(&sensor->clock);
}

/* Passes over the frames that are not wanted. They leave no gap in the sequence. */
static void pass_over(struct puppet_sensor *sensor)
{
    while (sensor->interval_ns > 0 && has_due(sensor) &&
           sensor->frames[sensor->next].t_ns - sensor->handed_ns < sensor->interval_ns) {
        sensor->next++;
        sensor->forgotten--;
    }
}

static int stream_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                       struct iso_fault *fault)
{
    struct stream *stream = self;
    struct puppet_sensor *sensor = stream->sensor;
    (void)deadline_ns;
    if (sensor->wait_error) {
        return refuse(sensor, sensor->wait_error, "puppet: will not wait", fault);
    }
    pass_over(sensor);
    if (!has_due(sensor)) {
        return -ETIMEDOUT;
    }
    sensor->handed_ns = sensor->frames[sensor->next].t_ns;
    stream->depth_mm[0] = (float)(100 + sensor->frames[sensor->next].face);
    stream->depth_mm[1] = (float)(100 + (int)sensor->frames[sensor->next].capture);
    stream->depth_mm[2] = (float)(1100 + sensor->frames[sensor->next].right_mm);
    stream->frame.t_ns = sensor->frames[sensor->next].t_ns;
    const bool elsewhere = sensor->scene_moves && stream->frame.t_ns / ISO_NS_PER_S % 2;
    const int n = stream->frame.width_px * stream->frame.height_px;
    for (int i = CODE_PX; i < n; i++) {
        const bool covered = sensor->has_room && sensor->frames[sensor->next].face && i < n / 2;
        stream->depth_mm[i] = covered ? 700.0F : elsewhere ? 1200.0F : 900.0F;
    }
    stream->frame.sequence = sensor->forgotten + (uint64_t)sensor->next++;
    *frame = &stream->frame;
    return 0;
}

static void stream_set_interval(void *self, int64_t interval_ns)
{
    const struct stream *stream = self;
    stream->sensor->interval_ns = interval_ns;
}

static int stream_next_due_ns(void *self, int64_t *due_ns)
{
    const struct puppet_sensor *sensor = ((const struct stream *)self)->sensor;
    *due_ns = sensor->next < sensor->n_frames
                  ? sensor->frames[sensor->next].t_ns
                  : iso_clock_now_ns(&sensor->clock) + 50 * ISO_NS_PER_MS;
    return 0;
}

static int stream_describe(void *self, struct iso_sensor_description *out)
{
    const struct puppet_sensor *sensor = ((const struct stream *)self)->sensor;
    *out = (struct iso_sensor_description){
        .model = "puppet9", .width_px = WIDTH_PX, .height_px = 1, .rate_hz = sensor->rate_hz};
    return 0;
}

static int stream_stop(void *self)
{
    (void)self;
    return 0;
}

static void stream_close(void *self)
{
    ((struct stream *)self)->sensor->closed++;
    free(self);
}

static int stream_check(const struct iso_option *options, size_t n_options, struct iso_fault *fault)
{
    (void)options;
    (void)n_options;
    (void)fault;
    return 0;
}

static int stream_poll_fd(void *self)
{
    const struct puppet_sensor *sensor = ((const struct stream *)self)->sensor;
    return sensor->descriptor ? sensor->descriptor : -ENOSYS;
}

static const struct iso_sensor_ops idle_ops = {
    .name = "puppet",
    .check = stream_check,
    .open = stream_open,
    .start = stream_start,
    .wait = stream_wait,
    .next_due_ns = stream_next_due_ns,
    .set_interval = stream_set_interval,
    .describe = stream_describe,
    .stop = stream_stop,
    .close = stream_close,
};

static const struct iso_sensor_ops streaming_ops = {
    .name = "puppet",
    .check = stream_check,
    .open = stream_open,
    .start = stream_start,
    .wait = stream_wait,
    .poll_fd = stream_poll_fd,
    .set_interval = stream_set_interval,
    .stop = stream_stop,
    .close = stream_close,
};

static int open_puppet(void *context, struct iso_sensor **out, struct iso_fault *fault)
{
    being_opened = context;
    return iso_sensor_open_ops(being_opened->streams ? &streaming_ops : &idle_ops, NULL, 0,
                               &being_opened->clock, out, fault);
}

struct iso_sensor_source puppet_sensor_source(struct puppet_sensor *sensor)
{
    return (struct iso_sensor_source){open_puppet, sensor};
}

void puppet_sensor_add(struct puppet_sensor *sensor, int64_t t_ns, int face,
                       enum iso_capture capture)
{
    puppet_sensor_add_at(sensor, t_ns, face, capture, 0);
}

void puppet_sensor_add_at(struct puppet_sensor *sensor, int64_t t_ns, int face,
                          enum iso_capture capture, int right_mm)
{
    if (sensor->n_frames == PUPPET_FRAMES_MAX) { /* drop the fetched frames to make room */
        sensor->n_frames -= sensor->next;
        memmove(sensor->frames, sensor->frames + sensor->next,
                (size_t)sensor->n_frames * sizeof *sensor->frames);
        sensor->forgotten += (uint64_t)sensor->next;
        sensor->next = 0;
    }
    assert_in_range(sensor->n_frames, 0, PUPPET_FRAMES_MAX - 1);
    sensor->frames[sensor->n_frames].t_ns = t_ns;
    sensor->frames[sensor->n_frames].face = face;
    sensor->frames[sensor->n_frames].capture = capture;
    sensor->frames[sensor->n_frames].right_mm = right_mm;
    sensor->n_frames++;
}

/* ---- pipeline ---- */

static int extract(void *self, const struct iso_frame *frame, const char *sensor,
                   struct iso_extraction *out)
{
    struct puppet_pipeline *pipeline = self;
    (void)snprintf(pipeline->sensor, sizeof pipeline->sensor, "%s", sensor);
    pipeline->extracted++;
    if (pipeline->extract_error) {
        return pipeline->extract_error;
    }
    const int face = (int)frame->depth_mm[0] - 100;
    *out = (struct iso_extraction){.outcome = (enum iso_capture)((int)frame->depth_mm[1] - 100)};
    if (out->outcome != ISO_CAPTURE_OK) {
        out->cue = pipeline->cue;
    }
    if (face != 0) {
        out->camera_from_face = iso_rigid_identity();
        out->camera_from_face.translation_mm = iso_vec3((double)frame->depth_mm[2] - 1100, 0, 700);
        out->distance_mm = 700;
        out->yaw_rad = pipeline->yaw_rad;
        out->pitch_rad = pipeline->pitch_rad;
        out->fitted = true;
        out->fit_coverage = 0.95;
        out->coverage = 0.9 - pipeline->uncovered;
        out->expression_norm = pipeline->expression;
        out->sigma_mm[ISO_LM_MOUTH_L] = 2.5;
        out->residual_mm = 1.5;
        out->tmpl = puppet_template(face, PUPPET_ALGORITHM);
    }
    return 0;
}

static int by_falling_score(const void *a, const void *b)
{
    const double x = ((const struct iso_search_hit *)a)->score;
    const double y = ((const struct iso_search_hit *)b)->score;
    return (x < y) - (x > y);
}

static int search(void *self, const struct iso_candidate_list *among,
                  const struct iso_template *probe, struct iso_search_hit *hits, int capacity,
                  int *n_hits)
{
    const struct iso_search_entry *entries = among->entries;
    const struct puppet_pipeline *pipeline = self;
    struct iso_search_hit all[64];
    int n = 0;
    if (pipeline->search_error) {
        return pipeline->search_error;
    }
    if (pipeline->raving) {
        hits[0] = (struct iso_search_hit){INT64_MAX, NAN, INFINITY};
        *n_hits = capacity > 0;
        return 0;
    }
    for (int i = 0; i < among->n_entries; i++) {
        const double score = 10 - abs(puppet_face_of(probe) - puppet_face_of(entries[i].tmpl));
        int at = 0;
        assert_int_equal(entries[i].tmpl->algorithm, PUPPET_ALGORITHM);
        while (at < n && all[at].person != entries[i].person) {
            at++;
        }
        if (at == n) {
            all[n++] = (struct iso_search_hit){entries[i].person, 10 - score, score};
        }
        all[at].score = fmax(all[at].score, score);
    }
    qsort(all, (size_t)n, sizeof *all, by_falling_score);
    *n_hits = n < capacity ? n : capacity;
    memcpy(hits, all, (size_t)*n_hits * sizeof *hits);
    return 0;
}

static uint32_t algorithm(const void *self)
{
    (void)self;
    return PUPPET_ALGORITHM;
}

static uint32_t model(const void *self)
{
    (void)self;
    return PUPPET_MODEL;
}

static void close_pipeline(void *self)
{
    (void)self;
}

static enum iso_face_seen seen(const void *self)
{
    return ((const struct puppet_pipeline *)self)->seen;
}

static const char *image_check(const void *self)
{
    (void)self;
    return "flag";
}

static const struct iso_pipeline_ops pipeline_ops = {
    .extract = extract,
    .search = search,
    .algorithm = algorithm,
    .model = model,
    .close = close_pipeline,
    .seen = seen,
    .image_check = image_check,
};

struct iso_pipeline puppet_pipeline(struct puppet_pipeline *pipeline)
{
    return (struct iso_pipeline){&pipeline_ops, pipeline};
}
