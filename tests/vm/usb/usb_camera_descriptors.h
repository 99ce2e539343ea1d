/* The descriptors of a USB video camera as bytes: those of USB 2.0 (chapter 9) and of the video
 * class (UVC 1.1, chapter 3). Internal to usb_camera. */
#ifndef TESTS_VM_USB_USB_CAMERA_DESCRIPTORS_H
#define TESTS_VM_USB_USB_CAMERA_DESCRIPTORS_H

#include <stddef.h>
#include <stdint.h>

#include "tests/vm/usb/usb_camera.h"

enum { USB_CAMERA_DESCRIPTOR_MAX = 512, USB_CAMERA_PROBE_BYTES = 34 };
enum { USB_CAMERA_HEADER_BYTES = 2 }; /* before each picture */

/* Returns the bytes of a pixel of a format, and writes the format's GUID; 0: unknown format. */
size_t usb_camera_pixel_bytes(uint32_t format, uint8_t guid[16]);

/* Writes the descriptor of a type and index and returns its size; 0: there is no such descriptor.
 */
size_t usb_camera_descriptor(const struct usb_camera_options *options, unsigned type,
                             unsigned index, uint8_t out[USB_CAMERA_DESCRIPTOR_MAX]);

/* Writes the only setting of a stream, which is its answer to probe and commit (UVC 1.1, 4.3.1.1).
 */
void usb_camera_probe(const struct usb_camera_stream *stream, uint8_t out[USB_CAMERA_PROBE_BYTES]);

#endif
