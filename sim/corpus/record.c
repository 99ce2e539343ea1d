#include "sim/corpus/record.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <time.h>

#include "drivers/recording/recording_writer.h"
#include "sim/base/progress.h"
#include "sim/corpus/tape.h"

enum { PNG_LEVEL = 1 }; /* fast, because the camera does not wait for the disk */

/* Waits for the next frame: 0, -ETIMEDOUT after `patience_ns`, or another error of the sensor. */
static int fetch(struct iso_sensor *sensor, const struct iso_clock *clock, int64_t patience_ns,
                 const struct iso_frame **frame, struct iso_fault *fault)
{
    const int64_t end_ns = iso_clock_now_ns(clock) + patience_ns;
    for (;;) {
        int64_t due_ns = 0;
        const int error = iso_sensor_wait(sensor, end_ns, frame, fault);
        const int64_t now_ns = iso_clock_now_ns(clock);
        if (error != -ETIMEDOUT) {
            return error;
        }
        if (now_ns >= end_ns) {
            return iso_fault_set(fault, -ETIMEDOUT, "sensor %s: no frame for %lld ms",
                                 iso_sensor_name(sensor), (long long)(patience_ns / 1000000));
        }
        if (iso_sensor_next_due_ns(sensor, &due_ns) == 0 && due_ns > now_ns) {
            const int64_t until_ns = due_ns < end_ns ? due_ns : end_ns;
            const struct timespec until = {until_ns / 1000000000, until_ns % 1000000000};
            (void)clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, NULL);
        }
    }
}

/* The output while it is written. */
struct output {
    struct sim_recording_writer *writer; /* NULL: no output */
    struct sim_tape *tape;
    int64_t first_ns;
};

/* Begins the recording with the properties of its first frame. */
static int begin(struct iso_sensor *sensor, const char *directory, const struct iso_frame *frame,
                 struct output *output, struct iso_fault *fault)
{
    struct iso_sensor_description description = {.unit_mm = 0.0};
    struct iso_recording_meta meta = {.camera = sim_recording_camera(frame)};
    const bool described = iso_sensor_describe(sensor, &description) == 0;
    (void)snprintf(meta.sensor, sizeof meta.sensor, "%s",
                   described ? description.model : iso_sensor_name(sensor));
    meta.unit_mm = description.unit_mm > 0.0 ? description.unit_mm
                                             : SIM_RECORD_DEFAULT_UNIT_UM / 1000.0;
    const int error = sim_recording_writer_create(directory, &meta, PNG_LEVEL, &output->writer,
                                                  fault);
    if (error) {
        return error;
    }
    return sim_tape_new(output->writer, frame, &output->tape, fault);
}

static int put(struct output *output, struct iso_sensor *sensor, const char *directory,
               const struct iso_frame *frame, struct sim_record_result *result,
               struct iso_fault *fault)
{
    struct iso_frame stamped = *frame;
    int error = 0;
    if (result->frames == 0) {
        output->first_ns = frame->t_ns;
        error = directory ? begin(sensor, directory, frame, output, fault) : 0;
    }
    stamped.t_ns -= output->first_ns;
    if (!error && output->tape) {
        error = sim_tape_put(output->tape, &stamped, fault);
    }
    if (!error) {
        result->frames++;
        result->span_ns = stamped.t_ns;
    }
    return error;
}

static int finish(struct output *output, struct iso_fault *fault)
{
    int error = sim_tape_finish(output->tape, fault);
    if (output->writer) {
        const int closed = sim_recording_writer_finish(output->writer, error ? NULL : fault);
        if (!error) {
            error = closed;
        }
    }
    sim_recording_writer_free(output->writer);
    return error;
}

int sim_record(struct iso_sensor *sensor, const struct iso_clock *clock,
               const struct sim_record_options *options, struct sim_record_result *result,
               struct iso_fault *fault)
{
    struct output output = {NULL, NULL, 0};
    int error = 0;
    const bool shown = sim_progress_begin("recording frames", options->frames);
    memset(result, 0, sizeof *result);
    while (!error && result->frames < options->frames) {
        const struct iso_frame *frame = NULL;
        error = fetch(sensor, clock, options->patience_ns, &frame, fault);
        if (error == -EBADMSG) {
            result->damaged++;
            error = 0;
        } else if (!error) {
            error = put(&output, sensor, options->directory, frame, result, fault);
            sim_progress_step(1);
        }
    }
    sim_progress_end(shown);
    result->health = iso_sensor_health(sensor);
    const int finished = finish(&output, error ? NULL : fault);
    if (error) {
        return error;
    }
    return finished;
}
