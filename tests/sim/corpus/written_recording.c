#include "tests/sim/corpus/written_recording.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "tests/support/scratch.h"

struct iso_recording_meta written_meta(void)
{
    return (struct iso_recording_meta){
        .sensor = "d435",
        .camera = {.projection = ISO_PINHOLE,
                   .width_px = WRITTEN_WIDTH,
                   .height_px = WRITTEN_HEIGHT,
                   .fx_px = 1.0 / 3.0 + 425.0,
                   .fy_px = 424.7,
                   .cx_px = 6.1,
                   .cy_px = 3.9,
                   .k1 = 0.1,
                   .p2 = -1e-4},
        .unit_mm = 0.1,
    };
}

struct iso_frame *written_frame(bool with_intensity)
{
    struct iso_recording_meta meta = written_meta();
    struct iso_frame *frame;
    assert_int_equal(
        iso_frame_new(&meta.camera, WRITTEN_WIDTH, WRITTEN_HEIGHT, with_intensity, &frame), 0);
    for (int i = 0; i < WRITTEN_WIDTH * WRITTEN_HEIGHT; i++) {
        frame->depth_mm[i] = (float)((i * 631 % 65535 + 1) * meta.unit_mm);
        if (with_intensity) {
            frame->intensity[i] = (float)(i * 601 % 65536) / 65535.0F;
        }
    }
    frame->depth_mm[5] = 0.0F;
    frame->depth_mm[6] = (float)(65535 * meta.unit_mm);
    frame->depth_mm[7] = (float)(1 * meta.unit_mm);
    frame->t_ns = 1305031102175304001;
    return frame;
}

struct sim_recording_writer *written_create(void **state, const struct iso_recording_meta *meta)
{
    struct sim_recording_writer *writer = NULL;
    struct iso_fault fault = {.text = ""};
    int error = sim_recording_writer_create(scratch_path(*state, "r"), meta, 9, &writer, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return writer;
}

void written_finish(struct sim_recording_writer *writer)
{
    assert_int_equal(sim_recording_writer_finish(writer, NULL), 0);
    sim_recording_writer_free(writer);
}

struct iso_recording *written_open(void **state)
{
    struct iso_recording *recording = NULL;
    struct iso_fault fault = {.text = ""};
    int error = iso_recording_open(scratch_path(*state, "r"), &recording, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
    return recording;
}
