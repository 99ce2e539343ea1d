/* One video capture node (/dev/video0): opens it, sets its format, and streams its pictures through
 * mapped buffers. Internal to the V4L2 back ends. */
#ifndef ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_NODE_H
#define ISO_DRIVERS_SENSOR_V4L2_SENSOR_V4L2_NODE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "drivers/sensor/contract/sensor.h"
#include "drivers/sensor/picture/picture_source.h"
#include "drivers/sensor/v4l2/sensor_v4l2_system.h"

enum { ISO_V4L2_FORMATS_MAX = 8 };

/* The requirements for a node. */
struct iso_v4l2_wish {
    const char *owner; /* of the faults: "sensor v4l2" */
    const char *path;
    int width_px, height_px;
    int fps; /* 0: the node's own rate */
    /* The accepted pixel formats (V4L2_PIX_FMT_...), the best first, 0 at the end. */
    uint32_t formats[ISO_V4L2_FORMATS_MAX + 1];
};

struct iso_v4l2_node;

/* The code of a fault, by the negative errno of a call on a node: SENSOR_MISSING, SENSOR_DENIED,
 * SENSOR_BUSY, USB_FULL, OUT_OF_MEMORY, else SENSOR_FAILED. */
enum iso_fault_code iso_v4l2_fault_code(int error);

/* Opens and sets up a node; does not stream yet. -ENODEV there is no such device, or it is no
 * camera; -EINVAL it has none of the formats, or not this size; -EBUSY, -EACCES, -ENOMEM, -EIO. */
int iso_v4l2_node_open(const struct iso_v4l2_system *system, const struct iso_v4l2_wish *wish,
                       struct iso_v4l2_node **out, struct iso_fault *fault)
    __attribute__((warn_unused_result));

/* Closes it and frees it. NULL is accepted. */
void iso_v4l2_node_close(struct iso_v4l2_node *node);

/* The node as a source of pictures; the node must outlive it. */
struct iso_picture_source iso_v4l2_node_source(struct iso_v4l2_node *node);

/* The port of the device; owned by the node. */
const char *iso_v4l2_node_bus(const struct iso_v4l2_node *node);

/* Calls the visitor for every node /dev/video0 to 63 that takes pictures (label: card, bus and
 * pixel formats) or that exists and cannot be opened (label and code: the reason). Returns 0. */
int iso_v4l2_probe(const struct iso_v4l2_system *system, iso_sensor_visitor *visit, void *context);

/* The same for the kernel's nodes, as the operation `probe` of the sensor class. */
int iso_v4l2_probe_kernel(iso_sensor_visitor *visit, void *context, struct iso_fault *fault)
    __attribute__((warn_unused_result));

#endif
