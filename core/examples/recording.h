/* Reads the depth frames of a recording, so that the examples have something to work on. The
 * library itself opens no files: a program of yours gets its frames from its own camera.
 *
 * A recording is a directory: recording.ini describes the camera, depth.txt has one line for each
 * frame (time in seconds, name of a file), and each file is a 16-bit grey PNG. Only recordings of
 * pinhole cameras are read. */
#ifndef EXAMPLE_RECORDING_H
#define EXAMPLE_RECORDING_H

#include <isotherm/frame.h>

struct recording {
    char directory[512];
    char sensor[16]; /* the kind of camera, such as "astra" */
    struct iso_camera camera;
    double unit_mm; /* millimetres of one count in the PNG files */
};

/* Reads recording.ini. Returns 0, or -1 with a line on standard error. */
int recording_open(const char *directory, struct recording *out);

/* Reads frame `index` (0, 1, ...) of the recording. Returns 1 with a new frame in *out, which the
 * caller frees with iso_frame_free; 0 after the last frame; -1 with a line on standard error. */
int recording_read(const struct recording *recording, int index, struct iso_frame **out);

/* Reads a whole file into memory that the caller frees with free(). Returns 0, or -1 with a line on
 * standard error. */
int file_read(const char *path, void **bytes, size_t *size);

#endif
