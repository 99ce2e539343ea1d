/* Takes frames from a sensor and writes them as pictures. Near points are bright; black pixels were
 * not measured.
 *
 *     frames_to_png BACK_END COUNT PREFIX [KEY=VALUE...]
 *
 * BACK_END is the name of a sensor back end, and the keys are its options. Both are the same as in
 * the section [sensor] of isotherm.conf. The pictures are PREFIX0.png, PREFIX1.png and so on.
 *
 *     frames_to_png replay 3 /tmp/frame path=sim/stored/p01-v1
 *     frames_to_png v4l2 10 /tmp/frame device=/dev/video0
 *
 * Every program that uses a sensor takes these steps: open, start, wait for frames, close. */
#include <errno.h>
#include <limits.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "core/base/fault.h"
#include "drivers/base/times.h"
#include "drivers/file/png.h"
#include "drivers/sensor/contract/sensor.h"

enum { OPTIONS_MAX = 16 };

/* Depths in this range are drawn in shades of grey. */
static const double nearest_mm = 300.0, farthest_mm = 1500.0;

/* Takes the next frame, and waits for it for at most five seconds. A back end either waits itself,
 * or says when to ask it again. */
static int next_frame(struct iso_sensor *sensor, const struct iso_clock *clock,
                      const struct iso_frame **frame, struct iso_fault *fault)
{
    const int64_t deadline_ns = iso_clock_now_ns(clock) + 5 * ISO_NS_PER_S;
    for (;;) {
        const int error = iso_sensor_wait(sensor, deadline_ns, frame, fault);
        if (error == -EBADMSG) {
            continue; /* one frame was damaged; the next may be good */
        }
        if (error != -ETIMEDOUT || iso_clock_now_ns(clock) >= deadline_ns) {
            return error == -ETIMEDOUT ? iso_fault_set(fault, error, "no frame came") : error;
        }
        int64_t due_ns = 0;
        const int64_t now_ns = iso_clock_now_ns(clock);
        if (iso_sensor_next_due_ns(sensor, &due_ns) == 0 && due_ns > now_ns) {
            const int64_t pause_ns = (due_ns < deadline_ns ? due_ns : deadline_ns) - now_ns;
            const struct timespec pause = {.tv_sec = pause_ns / ISO_NS_PER_S,
                                           .tv_nsec = pause_ns % ISO_NS_PER_S};
            (void)nanosleep(&pause, NULL);
        }
    }
}

static unsigned char shade(float depth_mm)
{
    if (depth_mm <= 0.0f) {
        return 0;
    }
    const double nearness = (farthest_mm - (double)depth_mm) / (farthest_mm - nearest_mm);
    const double clipped = fmin(fmax(nearness, 0.0), 1.0);
    return (unsigned char)(32.0 + 223.0 * clipped);
}

static int write_picture(const struct iso_frame *frame, const char *path, struct iso_fault *fault)
{
    const size_t n = (size_t)frame->width_px * (size_t)frame->height_px;
    unsigned char *samples = malloc(n);
    if (!samples) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    for (size_t i = 0; i < n; i++) {
        samples[i] = shade(frame->depth_mm[i]);
    }
    const struct iso_image image = {.width_px = frame->width_px,
                                    .height_px = frame->height_px,
                                    .pixel = ISO_PIXEL_GREY8,
                                    .samples = samples,
                                    .capacity = n};
    const int error = iso_png_write(path, &image, 6, fault);
    free(samples);
    return error;
}

static int take_frames(struct iso_sensor *sensor, const struct iso_clock *clock, int count,
                       const char *prefix, struct iso_fault *fault)
{
    int error = iso_sensor_start(sensor, fault);
    for (int i = 0; !error && i < count; i++) {
        const struct iso_frame *frame = NULL; /* belongs to the sensor, valid until the next call */
        char path[PATH_MAX];
        error = next_frame(sensor, clock, &frame, fault);
        if (!error) {
            (void)snprintf(path, sizeof path, "%s%d.png", prefix, i);
            error = write_picture(frame, path, fault);
        }
        if (!error) {
            printf("%s: %d x %d pixels, frame %llu\n", path, frame->width_px, frame->height_px,
                   (unsigned long long)frame->sequence);
        }
    }
    return error;
}

/* Cuts each KEY=VALUE into its key and its value. */
static size_t read_options(char **words, struct iso_option options[OPTIONS_MAX])
{
    size_t n = 0;
    for (; words[n] && n < OPTIONS_MAX; n++) {
        char *equals = strchr(words[n], '=');
        if (equals) {
            *equals = '\0';
        }
        options[n] = (struct iso_option){words[n], equals ? equals + 1 : ""};
    }
    return n;
}

int main(int argc, char **argv)
{
    if (argc < 4) {
        fprintf(stderr, "usage: %s BACK_END COUNT PREFIX [KEY=VALUE...]\n", argv[0]);
        return 2;
    }
    const struct iso_times times = iso_times_system();
    struct iso_option options[OPTIONS_MAX];
    struct iso_sensor *sensor = NULL;
    struct iso_fault fault = {0};

    const size_t n_options = read_options(argv + 4, options);
    int error = iso_sensor_open(argv[1], options, n_options, &times.monotonic, &sensor, &fault);
    if (!error) {
        error = take_frames(sensor, &times.monotonic, (int)strtol(argv[2], NULL, 10), argv[3],
                            &fault);
    }
    iso_sensor_close(sensor); /* closing also stops the sensor */
    if (error) {
        fprintf(stderr, "%s: %s\n", argv[0], fault.text);
        return 1;
    }
    return 0;
}
