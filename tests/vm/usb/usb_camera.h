/* A USB video camera (UVC 1.1) that is a program: the kernel's uvcvideo makes video nodes of it. It
 * has one or two streams of raw pictures, each of one format and size, sent by bulk transfers. */
#ifndef TESTS_VM_USB_USB_CAMERA_H
#define TESTS_VM_USB_USB_CAMERA_H

#include <stdbool.h>
#include <stddef.h>
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
    /* OPTIONAL. Is told how many streams are started now, in a thread of the camera's
     * or by usb_camera_plug. */
    void (*started)(void *context, int n);
    void *context;
};

struct usb_camera;

/* Not plugged in yet. -EINVAL an unknown format, -ENOMEM. */
int usb_camera_new(const struct usb_camera_options *options, struct usb_camera **out,
                   struct iso_fault *fault) __attribute__((warn_unused_result));
void usb_camera_free(struct usb_camera *camera);

/* Bytes of a picture. */
size_t usb_camera_picture_bytes(const struct usb_camera *camera, int stream);

/* Puts the cable in, or pulls it, which cannot fail. Nodes appear and go a little later:
 * usb_camera_node. */
int usb_camera_plug(struct usb_camera *camera, bool in, struct iso_fault *fault);

/* The video node of a stream, waited for; "" if none came. Of the camera, until the next call. */
const char *usb_camera_node(struct usb_camera *camera, int stream);

/* Sends a picture (width x height pixels, without padding), which is copied, if the stream is
 * started and no more than a few are on their way. One that is spoilt comes short, as pictures do
 * when USB loses packets. */
void usb_camera_shoot(struct usb_camera *camera, int stream, const void *picture, bool spoilt);

/* Transfers fail from now on (the endpoints stall), until streams are started anew. */
void usb_camera_halt(struct usb_camera *camera);

#endif
