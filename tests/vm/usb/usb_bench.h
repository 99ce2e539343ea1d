/* A bench (tests/openni2/virtual_camera.h) with a USB camera: video nodes of the kernel deliver the
 * recording in its slot, the depths as Z16 and, if wanted, the intensity as Y16. */
#ifndef TESTS_VM_USB_USB_BENCH_H
#define TESTS_VM_USB_USB_BENCH_H

#include <stdbool.h>

#include "core/base/fault.h"

struct usb_bench;

/* Starts the camera, and plugs it in unless the bench has the file `unplugged`. Errors of
 * sim_virtual_camera_new, usb_camera_new and usb_camera_plug. */
int usb_bench_new(const char *directory, bool with_intensity, struct usb_bench **out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Unplugs the camera and frees it. NULL is allowed. */
void usb_bench_free(struct usb_bench *bench);

/* Like usb_camera_node. Stream 0 has the depths, stream 1 the intensity. */
const char *usb_bench_node(struct usb_bench *bench, int stream);

/* How often streaming has begun since the camera was made. Two streams that start together count
 * once. */
unsigned usb_bench_starts(const struct usb_bench *bench);

/* Like usb_camera_halt. */
void usb_bench_halt(struct usb_bench *bench);

#endif
