#include "drivers/sensor/picture/picture_format.h"

#include <linux/videodev2.h>

const uint32_t iso_picture_grey_formats[7] = {V4L2_PIX_FMT_GREY, V4L2_PIX_FMT_Y16,
                                              V4L2_PIX_FMT_Y12,  V4L2_PIX_FMT_Y10,
                                              V4L2_PIX_FMT_YUYV, V4L2_PIX_FMT_UYVY};

/* How a format stores the grey level of a pixel. */
struct layout {
    size_t step, first; /* bytes from pixel to pixel, and to the grey level of the first pixel */
    int bits;           /* more than 8: stored in two bytes, the lower one first */
};

static struct layout layout_of(uint32_t format)
{
    switch (format) {
    case V4L2_PIX_FMT_Y10:
        return (struct layout){2, 0, 10};
    case V4L2_PIX_FMT_Y12:
        return (struct layout){2, 0, 12};
    case V4L2_PIX_FMT_Y16:
    case V4L2_PIX_FMT_Z16:
        return (struct layout){2, 0, 16};
    case V4L2_PIX_FMT_YUYV:
        return (struct layout){2, 0, 8};
    case V4L2_PIX_FMT_UYVY:
        return (struct layout){2, 1, 8};
    default:
        return (struct layout){1, 0, 8};
    }
}

static unsigned level_at(const uint8_t *pixel, int bits)
{
    if (bits == 8) {
        return pixel[0];
    }
    unsigned level = pixel[0] | (unsigned)pixel[1] << 8, most = (1u << bits) - 1;
    return level < most ? level : most;
}

static const uint8_t *pixel_at(const struct iso_picture *p, struct layout layout, size_t i)
{
    const size_t width = (size_t)p->width_px;
    return p->bytes + i / width * p->stride_bytes + i % width * layout.step + layout.first;
}

static size_t pixels_of(const struct iso_picture *p)
{
    return (size_t)p->width_px * (size_t)p->height_px;
}

void iso_picture_to_grey8(const struct iso_picture *picture, uint8_t *grey)
{
    struct layout layout = layout_of(picture->format);
    for (size_t i = 0; i < pixels_of(picture); i++) {
        grey[i] = (uint8_t)(level_at(pixel_at(picture, layout, i), layout.bits) >>
                            (layout.bits - 8));
    }
}

void iso_picture_to_intensity(const struct iso_picture *picture, float *intensity)
{
    struct layout layout = layout_of(picture->format);
    const float whole = (float)((1u << layout.bits) - 1);
    for (size_t i = 0; i < pixels_of(picture); i++) {
        intensity[i] = (float)level_at(pixel_at(picture, layout, i), layout.bits) / whole;
    }
}

void iso_picture_to_depth(const struct iso_picture *picture, double unit_mm, float *depth_mm)
{
    struct layout layout = layout_of(picture->format);
    for (size_t i = 0; i < pixels_of(picture); i++) {
        depth_mm[i] = (float)(unit_mm * level_at(pixel_at(picture, layout, i), layout.bits));
    }
}
