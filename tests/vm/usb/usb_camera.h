/* A USB video camera (UVC 1.1) that is a program: the kernel's uvcvideo makes video nodes for it.
 * It has one or two streams of raw pictures, each with one format and size, sent by bulk transfers.
 */
#ifndef TESTS_VM_USB_USB_CAMERA_H
#define TESTS_VM_USB_USB_CAMERA_H

#include <stdbool.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { USB_CAMERA_STREAMS = 2 };

struct usb_camera_stream {
    uint32_t format; /* V4L2_PIX_FMT_Z16, _GREY, _Y16 or _YUYV */
    int width_px, height_px;
};

struct usb_camera_options {
    const char *serial; /* the product is "Isotherm test camera" */
    unsigned port;      /* of vhci-hcd, 0..7 */
    int n_streams;
    struct usb_camera_stream streams[USB_CAMERA_STREAMS];
    /* OPTIONAL. Called with the number of started streams: by a thread of the camera when the
     * number changes, and by usb_camera_plug with 0 at each unplugging. */
    void (*started)(void *context, int n);
    void *context;
};

struct usb_camera;

/* Makes a camera that is not plugged in. -EINVAL for an unknown format, -ENOMEM. */
int usb_camera_new(const struct usb_camera_options *options, struct usb_camera **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));
/* Unplugs the camera and frees it. NULL is accepted. */
void usb_camera_free(struct usb_camera *camera);

/* Plugs the cable in, or unplugs it, which cannot fail. The nodes appear and disappear a little
 * later: see usb_camera_node. */
int usb_camera_plug(struct usb_camera *camera, bool in, struct iso_fault *fault);

/* Waits for the video node of a stream and returns its path; "" if there is none after some time.
 * The text belongs to the camera and is valid until the next call. */
const char *usb_camera_node(struct usb_camera *camera, int stream);

/* Copies and sends a picture (width x height pixels, without padding) if the stream is started and
 * no more than a few pictures wait. A spoilt picture is cut short, as when USB loses packets. */
void usb_camera_shoot(struct usb_camera *camera, int stream, const void *picture, bool spoilt);

/* Transfers of the started streams fail from now on (the endpoints stall) until the streams are
 * stopped or started again. */
void usb_camera_halt(struct usb_camera *camera);

#endif
