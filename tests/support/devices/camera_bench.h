/* A bench for a virtual camera (tests/openni2/virtual_camera.h). Failures fail the running cmocka
 * test. */
#ifndef TESTS_SUPPORT_DEVICES_CAMERA_BENCH_H
#define TESTS_SUPPORT_DEVICES_CAMERA_BENCH_H

#include <stdbool.h>

/* Makes the bench `directory` with the camera of `recording`, puts the recording into its slot, and
 * lets the drivers of this process and of its children find it. With `shutter` the camera makes a
 * frame only on request. Returns the descriptor for the requests; without `shutter` -1. */
int camera_bench_make(const char *directory, const char *recording, bool shutter);

/* Requests one frame; the second function requests a frame that is lost on its way. */
void camera_bench_press(int shutter_fd);
void camera_bench_lose(int shutter_fd);

/* Unplugs the cable, or plugs it in again. */
void camera_bench_plug(const char *directory, bool in);

/* Undoes everything that camera_bench_make() changed outside the directory. */
void camera_bench_leave(int shutter_fd);

#endif
