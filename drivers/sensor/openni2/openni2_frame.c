#include "drivers/sensor/openni2/openni2_frame.h"

#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "core/base/fault.h"

double iso__openni2_unit_mm(OniPixelFormat format)
{
    switch (format) {
    case ONI_PIXEL_FORMAT_DEPTH_1_MM:
        return 1.0;
    case ONI_PIXEL_FORMAT_DEPTH_100_UM:
        return 0.1;
    default:
        return 0.0;
    }
}

struct iso_camera iso__openni2_camera(int width_px, int height_px, double view_x_rad,
                                      double view_y_rad)
{
    return (struct iso_camera){
        .projection = ISO_PINHOLE,
        .width_px = width_px,
        .height_px = height_px,
        .fx_px = width_px / 2.0 / tan(view_x_rad / 2.0),
        .fy_px = height_px / 2.0 / tan(view_y_rad / 2.0),
        .cx_px = (width_px - 1) / 2.0,
        .cy_px = (height_px - 1) / 2.0,
    };
}

/* Finds a frame's pixels and checks them against the description in the frame. */
struct window {
    const uint8_t *bytes;
    size_t stride;
    int width_px, height_px, x_px, y_px;
};

static int find_window(const OniFrame *in, const struct iso_camera *camera, size_t pixel_bytes,
                       bool mirrored, struct window *out, struct iso_fault *fault)
{
    const int x = in->croppingEnabled ? in->cropOriginX : 0;
    const int y = in->croppingEnabled ? in->cropOriginY : 0;
    const char *flaw = NULL;
    if (in->width < 1 || in->height < 1 || x < 0 || y < 0 || in->width > camera->width_px ||
        in->height > camera->height_px || x > camera->width_px - in->width ||
        y > camera->height_px - in->height) {
        flaw = "is not within the image";
    } else if (in->stride < 0 || (size_t)in->stride < (size_t)in->width * pixel_bytes) {
        flaw = "has rows shorter than its width";
    } else if (!in->data || in->dataSize < 0 ||
               (size_t)in->dataSize < (size_t)in->stride * (size_t)(in->height - 1) +
                                          (size_t)in->width * pixel_bytes) {
        flaw = "is truncated";
    }
    if (flaw) {
        (void)iso_fault_set(fault, -EBADMSG, "%s", flaw);
        return -EBADMSG;
    }
    *out = (struct window){
        .bytes = in->data,
        .stride = (size_t)in->stride,
        .width_px = in->width,
        .height_px = in->height,
        .x_px = mirrored ? camera->width_px - in->width - x : x,
        .y_px = y,
    };
    return 0;
}

static uint16_t load16(const uint8_t *bytes)
{
    uint16_t value;
    memcpy(&value, bytes, sizeof value);
    return value;
}

int iso__openni2_read_depth(const OniFrame *in, bool mirrored, struct iso_frame *out,
                            struct iso_fault *fault)
{
    const double unit_mm = iso__openni2_unit_mm(in->videoMode.pixelFormat);
    struct window window;
    if (unit_mm == 0.0) {
        return iso_fault_set(fault, -EBADMSG, "is not of a depth format");
    }
    const int error = find_window(in, &out->camera, sizeof(uint16_t), mirrored, &window, fault);
    if (error) {
        return error;
    }
    out->width_px = window.width_px;
    out->height_px = window.height_px;
    out->crop_x_px = window.x_px;
    out->crop_y_px = window.y_px;
    float *depth_mm = out->depth_mm;
    for (int row = 0; row < window.height_px; row++) {
        const uint8_t *line = window.bytes + (size_t)row * window.stride;
        for (int column = 0; column < window.width_px; column++) {
            const int from = mirrored ? window.width_px - 1 - column : column;
            *depth_mm++ = (float)(load16(line + (size_t)from * sizeof(uint16_t)) * unit_mm);
        }
    }
    return 0;
}

static size_t grey_bytes(OniPixelFormat format)
{
    switch (format) {
    case ONI_PIXEL_FORMAT_GRAY8:
        return 1;
    case ONI_PIXEL_FORMAT_GRAY16:
        return 2;
    case ONI_PIXEL_FORMAT_RGB888:
        return 3;
    default:
        return 0;
    }
}

/* The grey level of a pixel of so many bytes. */
static double grey_of(const uint8_t *pixel, size_t bytes)
{
    switch (bytes) {
    case 1:
        return pixel[0];
    case 2:
        return load16(pixel);
    default: /* ITU-R BT.709, item 3.2 */
        return 0.2126 * pixel[0] + 0.7152 * pixel[1] + 0.0722 * pixel[2];
    }
}

int iso__openni2_read_intensity(const OniFrame *in, bool mirrored, double full_scale,
                                struct iso_frame *out, struct iso_fault *fault)
{
    const size_t bytes = grey_bytes(in->videoMode.pixelFormat);
    struct window window;
    if (bytes == 0) {
        return iso_fault_set(fault, -EBADMSG, "is not of a grey or colour format");
    }
    const int error = find_window(in, &out->camera, bytes, mirrored, &window, fault);
    if (error) {
        return error;
    }
    if (window.width_px != out->width_px || window.height_px != out->height_px ||
        window.x_px != out->crop_x_px || window.y_px != out->crop_y_px) {
        return iso_fault_set(fault, -EBADMSG, "does not cover the depths");
    }
    float *intensity = out->intensity;
    for (int row = 0; row < window.height_px; row++) {
        const uint8_t *line = window.bytes + (size_t)row * window.stride;
        for (int column = 0; column < window.width_px; column++) {
            const int from = mirrored ? window.width_px - 1 - column : column;
            const double value = grey_of(line + (size_t)from * bytes, bytes) / full_scale;
            *intensity++ = (float)(value < 1.0 ? value : 1.0);
        }
    }
    return 0;
}
