/* A USB device that is a program: its cable is a socket pair whose other end the kernel's vhci-hcd
 * holds, and what goes over it is USB/IP (the kernel's Documentation/usb/usbip_protocol.rst,
 * version 1.1.1). The kernel sees a device at high speed and binds its own drivers to it. Needs
 * root and the module vhci-hcd. */
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

/* What a device does; called in the thread of its cable. */
struct usbip_device {
    void *self;

    /* A request to endpoint 0. `data` holds what was sent, or has room for `length` bytes of
     * answer. Returns how many are answered (0 for one that sends), or -EPIPE: not supported. */
    int (*control)(void *self, const struct usbip_setup *setup, uint8_t *data);

    /* The host waits at an IN endpoint (1..USBIP_ENDPOINTS) for at most `room` bytes. Returns how
     * many there are (0 is an empty packet); -EAGAIN: none yet, and it is asked again after
     * usbip_wake; -EPIPE: the endpoint stalls. */
    int (*fill)(void *self, unsigned endpoint, uint8_t *data, size_t room);
};

struct usbip_cable;

/* Puts the device into a port (0..7), which must be free. The device must outlive the cable. */
int usbip_plug_in(const struct usbip_device *device, unsigned port, struct usbip_cable **out,
                  struct iso_fault *fault) __attribute__((warn_unused_result));

/* Pulls the cable; returns when the kernel has let go of the port. NULL is fine. */
void usbip_pull_out(struct usbip_cable *cable);

/* The device has something to say. From any thread. */
void usbip_wake(struct usbip_cable *cable);

#endif
