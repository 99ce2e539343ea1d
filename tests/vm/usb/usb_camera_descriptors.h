/* What a USB video camera says of itself: the descriptors of USB 2.0 (chapter 9) and of the video
 * class (UVC 1.1, chapter 3), as bytes. Internal to usb_camera. */
#ifndef TESTS_VM_USB_USB_CAMERA_DESCRIPTORS_H
#define TESTS_VM_USB_USB_CAMERA_DESCRIPTORS_H

#include <stddef.h>
#include <stdint.h>

#include "tests/vm/usb/usb_camera.h"

enum { USB_CAMERA_DESCRIPTOR_MAX = 512, USB_CAMERA_PROBE_BYTES = 34 };
enum { USB_CAMERA_HEADER_BYTES = 2 }; /* before each picture */

/* Bytes of a pixel of a format, and the GUID that stands for it; 0: not known here. */
size_t usb_camera_pixel_bytes(uint32_t format, uint8_t guid[16]);

/* The descriptor of a type and index; its bytes, or 0: there is none. */
size_t usb_camera_descriptor(const struct usb_camera_options *options, unsigned type,
                             unsigned index, uint8_t out[USB_CAMERA_DESCRIPTOR_MAX]);

/* The only setting that a stream has: what it answers to probe and commit (UVC 1.1, 4.3.1.1). */
void usb_camera_probe(const struct usb_camera_stream *stream, uint8_t out[USB_CAMERA_PROBE_BYTES]);

#endif
