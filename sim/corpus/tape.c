#include "sim/corpus/tape.h"

#include <errno.h>
#include <pthread.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/process/thread.h"

struct sim_tape {
    struct sim_recording_writer *writer;
    pthread_t thread;
    pthread_mutex_t lock;
    pthread_cond_t changed;
    struct iso_frame *frames[SIM_TAPE_FRAMES]; /* a ring */
    size_t first, count;
    bool ending;
    int error;
    struct iso_fault fault;
};

static void *write_frames(void *context)
{
    struct sim_tape *tape = context;
    pthread_mutex_lock(&tape->lock);
    for (;;) {
        while (tape->count == 0 && !tape->ending) {
            pthread_cond_wait(&tape->changed, &tape->lock);
        }
        if (tape->count == 0) {
            break;
        }
        if (!tape->error) {
            struct iso_fault fault = {.text = ""};
            const struct iso_frame *frame = tape->frames[tape->first];
            pthread_mutex_unlock(&tape->lock); /* the frame stays in the ring until `count--` */
            const int error = sim_recording_writer_append(tape->writer, frame, &fault);
            pthread_mutex_lock(&tape->lock);
            tape->error = error;
            tape->fault = fault;
        }
        tape->first = (tape->first + 1) % SIM_TAPE_FRAMES;
        tape->count--;
        pthread_cond_broadcast(&tape->changed);
    }
    pthread_mutex_unlock(&tape->lock);
    return NULL;
}

static void free_tape(struct sim_tape *tape)
{
    for (size_t i = 0; i < SIM_TAPE_FRAMES; i++) {
        iso_frame_free(tape->frames[i]);
    }
    pthread_cond_destroy(&tape->changed);
    pthread_mutex_destroy(&tape->lock);
    free(tape);
}

int sim_tape_new(struct sim_recording_writer *writer, const struct iso_frame *like,
                 struct sim_tape **out, struct iso_fault *fault)
{
    struct sim_tape *tape = calloc(1, sizeof *tape);
    int error = tape ? 0 : -ENOMEM;
    if (!tape) {
        return iso_fault_set(fault, error, "out of memory");
    }
    tape->writer = writer;
    pthread_mutex_init(&tape->lock, NULL);
    pthread_cond_init(&tape->changed, NULL);
    for (size_t i = 0; !error && i < SIM_TAPE_FRAMES; i++) {
        error = iso_frame_new(&like->camera, like->width_px, like->height_px,
                              like->intensity != NULL, &tape->frames[i]);
    }
    if (!error) {
        error = iso_thread_start(&tape->thread, write_frames, tape);
    }
    if (error) {
        free_tape(tape);
        return iso_fault_set(fault, error, "recording: %s", strerror(-error));
    }
    *out = tape;
    return 0;
}

static void copy(const struct iso_frame *from, struct iso_frame *to)
{
    const size_t bytes = (size_t)from->width_px * (size_t)from->height_px * sizeof(float);
    float *depth_mm = to->depth_mm, *intensity = to->intensity;
    *to = *from;
    to->depth_mm = memcpy(depth_mm, from->depth_mm, bytes);
    to->intensity = intensity ? memcpy(intensity, from->intensity, bytes) : NULL;
}

int sim_tape_put(struct sim_tape *tape, const struct iso_frame *frame, struct iso_fault *fault)
{
    const struct iso_frame *like = tape->frames[0];
    if (frame->width_px != like->width_px || frame->height_px != like->height_px ||
        (frame->intensity != NULL) != (like->intensity != NULL)) {
        return iso_fault_set(fault, -EINVAL, "recording: a frame of another shape");
    }
    pthread_mutex_lock(&tape->lock);
    while (tape->count == SIM_TAPE_FRAMES) {
        pthread_cond_wait(&tape->changed, &tape->lock);
    }
    const int error = tape->error;
    if (error) {
        (void)iso_fault_set(fault, error, "%s", tape->fault.text);
    } else {
        copy(frame, tape->frames[(tape->first + tape->count) % SIM_TAPE_FRAMES]);
        tape->count++;
        pthread_cond_broadcast(&tape->changed);
    }
    pthread_mutex_unlock(&tape->lock);
    return error;
}

int sim_tape_finish(struct sim_tape *tape, struct iso_fault *fault)
{
    if (!tape) {
        return 0;
    }
    pthread_mutex_lock(&tape->lock);
    tape->ending = true;
    pthread_cond_broadcast(&tape->changed);
    pthread_mutex_unlock(&tape->lock);
    (void)pthread_join(tape->thread, NULL);
    const int error = tape->error;
    if (error) {
        (void)iso_fault_set(fault, error, "%s", tape->fault.text);
    }
    free_tape(tape);
    return error;
}
