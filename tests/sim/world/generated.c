#include "tests/sim/world/generated.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "drivers/recording/recording.h"
#include "tests/support/scratch.h"
#include "tests/support/shared_data.h"

struct sim_generate_options generated_options(const char *preset, const char *directory)
{
    struct sim_generate_options options = sim_generate_options_default();
    options.ict_directory = shared_data_or_skip("data/ict-face");
    options.preset = preset;
    options.directory = directory;
    return options;
}

struct sim_generate_options generated_small(const char *directory)
{
    struct sim_generate_options options = generated_options("mild", directory);
    options.n_people = 2;
    options.n_probes = 3;
    options.n_strangers = 1;
    options.frames_per_visit = 2;
    return options;
}

void generated_write(const struct sim_generate_options *options)
{
    struct iso_fault fault = {.text = ""};
    int error = sim_generate(options, &fault);
    assert_string_equal(fault.text, "");
    assert_int_equal(error, 0);
}

struct sim_corpus *generated_corpus(const struct sim_generate_options *options)
{
    struct sim_corpus *corpus = NULL;
    generated_write(options);
    assert_int_equal(sim_corpus_read(options->directory, &corpus, NULL), 0);
    return corpus;
}

struct iso_frame *generated_frame(const char *directory, const char *recording, size_t index)
{
    struct iso_recording *opened = NULL;
    struct iso_frame *frame = NULL;
    const char *path = scratch_path(directory, recording);
    assert_int_equal(iso_recording_open(path, &opened, NULL), 0);
    assert_int_equal(iso_recording_frame_new(opened, &frame), 0);
    assert_int_equal(iso_recording_read(opened, index, frame, NULL), 0);
    iso_recording_close(opened);
    return frame;
}

bool generated_same(const char *a, const char *b, const char *file)
{
    size_t n_a, n_b;
    void *bytes_a = scratch_read(scratch_path(a, file), &n_a);
    void *bytes_b = scratch_read(scratch_path(b, file), &n_b);
    bool same = n_a == n_b && memcmp(bytes_a, bytes_b, n_a) == 0;
    free(bytes_a);
    free(bytes_b);
    return same;
}

struct iso_vec3 generated_point(const struct iso_frame *frame, int column, int row)
{
    double z = (double)iso_frame_depth_at(frame, column, row);
    return iso_vec3((column - frame->camera.cx_px) * z / frame->camera.fx_px,
                    (row - frame->camera.cy_px) * z / frame->camera.fy_px, z);
}

void generated_solve(double a[6][7], int n)
{
    for (int i = 0; i < n; i++) {
        int best = i;
        for (int r = i + 1; r < n; r++) {
            best = fabs(a[r][i]) > fabs(a[best][i]) ? r : best;
        }
        for (int c = 0; c < 7; c++) {
            double swap = a[i][c];
            a[i][c] = a[best][c];
            a[best][c] = swap;
        }
        for (int r = 0; r < n; r++) {
            double f = r == i ? 0.0 : a[r][i] / a[i][i];
            for (int c = i; c < 7 && f != 0.0; c++) {
                a[r][c] -= f * a[i][c];
            }
        }
    }
    for (int i = 0; i < n; i++) {
        a[i][6] /= a[i][i];
    }
}
