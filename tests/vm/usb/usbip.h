/* A USB device that is a program. Its cable is a socket pair whose other end the kernel's vhci-hcd
 * has; the protocol is USB/IP (the kernel's Documentation/usb/usbip_protocol.rst, version 1.1.1).
 * The kernel sees a device at high speed and binds its drivers to it. Needs root and the module
 * vhci-hcd.
 */
#ifndef TESTS_VM_USB_USBIP_H
#define TESTS_VM_USB_USBIP_H

#include <stddef.h>
#include <stdint.h>

#include "core/base/fault.h"

enum { USBIP_ENDPOINTS = 4 };

/* A control request's first packet (USB 2.0, 9.3). */
struct usbip_setup {
    uint8_t type, request;
    uint16_t value, index, length;
};

/* The functions of a device; the thread of its cable calls them. */
struct usbip_device {
    void *self;

    /* A request to endpoint 0. `data` has the sent bytes, or room for an answer of `length` bytes.
     * Returns the size of the answer (0 for a request that sends), or -EPIPE: not supported. */
    int (*control)(void *self, const struct usbip_setup *setup, uint8_t *data);

    /* The host waits at an IN endpoint (1..USBIP_ENDPOINTS) for at most `room` bytes. Returns the
     * number of bytes (0 is an empty packet); -EAGAIN: none yet, and this is called again after
     * usbip_wake; -EPIPE: the endpoint stalls. */
    int (*fill)(void *self, unsigned endpoint, uint8_t *data, size_t room);
};

struct usbip_cable;

/* Plugs the device into a port (0..7), which must be free. The device must outlive the cable.
 * -ENOMEM, the error of starting a thread, or the errno of the kernel's file `attach`. */
int usbip_plug_in(const struct usbip_device *device, unsigned port, struct usbip_cable **out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Unplugs the cable; returns when the kernel has released the port. NULL is allowed. */
void usbip_pull_out(struct usbip_cable *cable);

/* Lets the cable's thread ask the device for data again. Any thread may call this. */
void usbip_wake(struct usbip_cable *cable);

#endif
