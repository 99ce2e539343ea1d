/* A bench for the virtual OpenNI2 camera (tests/openni2/virtual_camera.h). Failures fail the
 * running cmocka test. */
#ifndef TESTS_SUPPORT_DEVICES_CAMERA_BENCH_H
#define TESTS_SUPPORT_DEVICES_CAMERA_BENCH_H

#include <stdbool.h>

/* Makes the bench `directory` with the camera that made `recording`, which stands in its slot, and
 * has the drivers of this process and of its children find it. With `shutter` the camera makes
 * frames only when it is told to; returns the descriptor to press it with, else -1. */
int camera_bench_make(const char *directory, const char *recording, bool shutter);

/* One frame, one that is lost on its way. */
void camera_bench_press(int shutter_fd);
void camera_bench_lose(int shutter_fd);

/* Pulls the cable, or puts it in again. */
void camera_bench_plug(const char *directory, bool in);

/* Undoes what is not in the directory. */
void camera_bench_leave(int shutter_fd);

#endif
