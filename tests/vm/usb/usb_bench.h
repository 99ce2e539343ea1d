/* A bench (tests/openni2/virtual_camera.h) whose camera is at USB: what stands in its slot comes
 * out of video nodes of the kernel, depths as Z16 and, if wanted, the intensity beside them as Y16.
 */
#ifndef TESTS_VM_USB_USB_BENCH_H
#define TESTS_VM_USB_USB_BENCH_H

#include <stdbool.h>

#include "core/base/fault.h"

struct usb_bench;

/* Plugs the camera in, unless the bench says otherwise, and lets it live. Errors of
 * sim_virtual_camera_new, usb_camera_new and usb_camera_plug. */
int usb_bench_new(const char *directory, bool with_intensity, struct usb_bench **out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Pulls it out for good. NULL is fine. */
void usb_bench_free(struct usb_bench *bench);

/* As usb_camera_node: 0 the depths, 1 the intensity. */
const char *usb_bench_node(struct usb_bench *bench, int stream);

/* How often somebody has begun to stream, since ever. */
unsigned usb_bench_starts(const struct usb_bench *bench);

/* As usb_camera_halt. */
void usb_bench_halt(struct usb_bench *bench);

#endif
