/* Finds the video nodes, the formats of their pictures, and whether they may be opened. */
#include <errno.h>
#include <linux/videodev2.h>
#include <stdio.h>
#include <string.h>

#include "drivers/sensor/v4l2/sensor_v4l2_node.h"

enum { NODES_MAX = 64 };

static int call(const struct iso_v4l2_system *system, int fd, unsigned long request, void *argument)
{
    return system->ioctl(system->context, fd, request, argument);
}

/* Writes the formats as " Z16 GREY ...". Returns whether depth is among them. */
static bool list_formats(const struct iso_v4l2_system *system, int fd, char *text, size_t size)
{
    bool depth = false;
    size_t used = 0;
    for (uint32_t i = 0; i < 16 && used < size; i++) {
        struct v4l2_fmtdesc format = {.index = i, .type = V4L2_BUF_TYPE_VIDEO_CAPTURE};
        if (call(system, fd, VIDIOC_ENUM_FMT, &format)) {
            break;
        }
        const uint32_t code = format.pixelformat;
        depth |= code == V4L2_PIX_FMT_Z16;
        const int n = snprintf(text + used, size - used, " %c%c%c%c", (int)(code & 0x7f),
                               (int)(code >> 8 & 0x7f), (int)(code >> 16 & 0x7f),
                               (int)(code >> 24 & 0x7f));
        used += n > 0 ? (size_t)n : 0;
    }
    return depth;
}

/* Returns whether the node is a camera. Its label is "CARD at BUS: FORMATS", or says why it cannot
 * be opened. */
static bool look_at(const struct iso_v4l2_system *system, struct iso_sensor_device *device)
{
    struct v4l2_capability capability = {0};
    char formats[64] = "";
    const int fd = system->open(system->context, device->id);
    if (fd < 0) {
        (void)snprintf(device->label, sizeof device->label, "cannot be opened: %s", strerror(-fd));
        device->code = iso_v4l2_fault_code(fd);
        return fd != -ENOENT && fd != -ENXIO && fd != -ENODEV;
    }
    const bool known = call(system, fd, VIDIOC_QUERYCAP, &capability) == 0;
    const uint32_t can = capability.capabilities & V4L2_CAP_DEVICE_CAPS ? capability.device_caps
                                                                        : capability.capabilities;
    device->depth = list_formats(system, fd, formats, sizeof formats);
    system->close(system->context, fd);
    (void)snprintf(device->label, sizeof device->label, "%.32s at %.32s:%s",
                   (const char *)capability.card, (const char *)capability.bus_info, formats);
    return known && (can & V4L2_CAP_VIDEO_CAPTURE) && (can & V4L2_CAP_STREAMING);
}

int iso_v4l2_probe(const struct iso_v4l2_system *system, iso_sensor_visitor *visit, void *context)
{
    for (int i = 0; i < NODES_MAX; i++) {
        struct iso_sensor_device device = {.label = ""};
        (void)snprintf(device.id, sizeof device.id, "/dev/video%d", i);
        if (look_at(system, &device)) {
            visit(&device, context);
        }
    }
    return 0;
}

int iso_v4l2_probe_kernel(iso_sensor_visitor *visit, void *context, struct iso_fault *fault)
{
    (void)fault;
    return iso_v4l2_probe(&iso_v4l2_kernel, visit, context);
}
