#include "tests/vm/usb/usb_camera_descriptors.h"

#include <linux/usb/ch9.h>
#include <linux/usb/video.h>
#include <linux/videodev2.h>
#include <string.h>

enum { MANUFACTURER = 1, PRODUCT, SERIAL };   /* strings */
enum { INTERVAL = 333333, PACKET_MAX = 512 }; /* 100 ns; bytes of a bulk packet at high speed */

/* Bytes that are written one after the other; the low bytes of a number come first. */
struct writer {
    uint8_t *at;
    size_t n;
};

static void put(struct writer *w, size_t bytes, uint32_t value)
{
    for (size_t i = 0; i < bytes; i++) {
        w->at[w->n++] = (uint8_t)(value >> 8 * i);
    }
}

/* Several bytes, each a number. */
static void put_bytes(struct writer *w, const uint8_t *bytes, size_t n)
{
    memcpy(w->at + w->n, bytes, n);
    w->n += n;
}

#define PUT(w, ...) \
    put_bytes((w), (const uint8_t[]){__VA_ARGS__}, sizeof((const uint8_t[]){__VA_ARGS__}))

size_t usb_camera_pixel_bytes(uint32_t format, uint8_t guid[16])
{
    static const struct {
        uint32_t format;
        char code[5];
        size_t bytes;
    } formats[] = {
        {V4L2_PIX_FMT_Z16, "Z16 ", 2},
        {V4L2_PIX_FMT_GREY, "Y800", 1},
        {V4L2_PIX_FMT_Y16, "Y16 ", 2},
        {V4L2_PIX_FMT_YUYV, "YUY2", 2},
    };
    static const uint8_t media[12] = {0, 0, 0x10, 0, 0x80, 0, 0, 0xaa, 0, 0x38, 0x9b, 0x71};
    for (size_t i = 0; i < sizeof formats / sizeof *formats; i++) {
        if (formats[i].format == format) {
            memcpy(guid, formats[i].code, 4);
            memcpy(guid + 4, media, sizeof media);
            return formats[i].bytes;
        }
    }
    return 0;
}

static size_t picture_bytes(const struct usb_camera_stream *stream)
{
    uint8_t guid[16];
    return usb_camera_pixel_bytes(stream->format, guid) * (size_t)stream->width_px *
           (size_t)stream->height_px;
}

/* The interface that controls; terminals 2i+1 (a camera) and 2i+2 (a stream). */
static void put_control(struct writer *w, const struct usb_camera_options *o)
{
    const uint8_t n = (uint8_t)o->n_streams;
    PUT(w, 9, USB_DT_INTERFACE, 0, 0, 0, USB_CLASS_VIDEO, UVC_SC_VIDEOCONTROL, 0, 0);
    PUT(w, (uint8_t)(12 + n), USB_DT_CS_INTERFACE, UVC_VC_HEADER, 0x10, 0x01);
    put(w, 2, 12u + n + n * (18u + 9u)); /* the size of all these descriptors */
    put(w, 4, 1000000);                  /* the frequency of a clock that is not used */
    put(w, 1, n);
    for (uint8_t i = 0; i < n; i++) {
        put(w, 1, 1u + i);
    }
    for (uint8_t i = 0; i < n; i++) {
        const uint8_t in = (uint8_t)(2 * i + 1), out = (uint8_t)(2 * i + 2);
        PUT(w, 18, USB_DT_CS_INTERFACE, UVC_VC_INPUT_TERMINAL, in, 0x01, 0x02, 0, 0, 0, 0, 0, 0, 0,
            0, 3, 0, 0, 0);
        PUT(w, 9, USB_DT_CS_INTERFACE, UVC_VC_OUTPUT_TERMINAL, out, 0x01, 0x01, 0, in, 0);
    }
}

static void put_stream(struct writer *w, const struct usb_camera_stream *stream, unsigned i)
{
    uint8_t guid[16];
    const uint8_t endpoint = (uint8_t)(USB_DIR_IN | (i + 1));
    const uint32_t bytes = (uint32_t)picture_bytes(stream);
    const uint8_t bits = (uint8_t)(8 * usb_camera_pixel_bytes(stream->format, guid));
    PUT(w, 9, USB_DT_INTERFACE, (uint8_t)(i + 1), 0, 1, USB_CLASS_VIDEO, UVC_SC_VIDEOSTREAMING, 0,
        0);
    PUT(w, 14, USB_DT_CS_INTERFACE, UVC_VS_INPUT_HEADER, 1);
    put(w, 2, 14 + 27 + 30);
    PUT(w, endpoint, 0, (uint8_t)(2 * i + 2), 0, 0, 0, 1, 0);
    PUT(w, 27, USB_DT_CS_INTERFACE, UVC_VS_FORMAT_UNCOMPRESSED, 1, 1);
    put_bytes(w, guid, sizeof guid);
    PUT(w, bits, 1, 0, 0, 0, 0);
    PUT(w, 30, USB_DT_CS_INTERFACE, UVC_VS_FRAME_UNCOMPRESSED, 1, 0);
    put(w, 2, (uint32_t)stream->width_px);
    put(w, 2, (uint32_t)stream->height_px);
    put(w, 4, bytes * 8 * 30);
    put(w, 4, bytes * 8 * 30);
    put(w, 4, bytes);
    put(w, 4, INTERVAL);
    put(w, 1, 1);
    put(w, 4, INTERVAL);
    PUT(w, 7, USB_DT_ENDPOINT, endpoint, USB_ENDPOINT_XFER_BULK);
    put(w, 2, PACKET_MAX);
    put(w, 1, 0);
}

static void put_configuration(struct writer *w, const struct usb_camera_options *o)
{
    const uint8_t interfaces = (uint8_t)(1 + o->n_streams);
    PUT(w, 9, USB_DT_CONFIG, 0, 0, interfaces, 1, 0, USB_CONFIG_ATT_ONE, 50);
    PUT(w, 8, USB_DT_INTERFACE_ASSOCIATION, 0, interfaces, USB_CLASS_VIDEO,
        UVC_SC_VIDEO_INTERFACE_COLLECTION, 0, PRODUCT);
    put_control(w, o);
    for (int i = 0; i < o->n_streams; i++) {
        put_stream(w, &o->streams[i], (unsigned)i);
    }
    w->at[2] = (uint8_t)w->n;
    w->at[3] = (uint8_t)(w->n >> 8);
}

static void put_device(struct writer *w)
{
    PUT(w, 18, USB_DT_DEVICE, 0x00, 0x02, USB_CLASS_MISC, 2, 1, 64);
    put(w, 2, 0x1d6b); /* the Linux Foundation's webcam gadget */
    put(w, 2, 0x0102);
    PUT(w, 0x00, 0x01, MANUFACTURER, PRODUCT, SERIAL, 1);
}

static void put_string(struct writer *w, const struct usb_camera_options *o, unsigned index)
{
    const char *const texts[] = {NULL, "Isotherm", "Isotherm test camera", o->serial};
    if (index == 0) {
        PUT(w, 4, USB_DT_STRING, 0x09, 0x04); /* English */
    } else if (index < sizeof texts / sizeof *texts) {
        const size_t length = strnlen(texts[index], 100);
        PUT(w, (uint8_t)(2 + 2 * length), USB_DT_STRING);
        for (size_t i = 0; i < length; i++) {
            put(w, 2, (uint8_t)texts[index][i]);
        }
    }
}

size_t usb_camera_descriptor(const struct usb_camera_options *options, unsigned type,
                             unsigned index, uint8_t out[USB_CAMERA_DESCRIPTOR_MAX])
{
    struct writer w = {out, 0};
    switch (type) {
    case USB_DT_DEVICE:
        put_device(&w);
        break;
    case USB_DT_CONFIG:
        put_configuration(&w, options);
        break;
    case USB_DT_STRING:
        put_string(&w, options, index);
        break;
    default:
        break;
    }
    return w.n;
}

void usb_camera_probe(const struct usb_camera_stream *stream, uint8_t out[USB_CAMERA_PROBE_BYTES])
{
    struct writer w = {out, 0};
    const uint32_t bytes = (uint32_t)picture_bytes(stream);
    PUT(&w, 0, 0, 1, 1);
    put(&w, 4, INTERVAL);
    for (int i = 0; i < 5; i++) {
        put(&w, 2, 0);
    }
    put(&w, 4, bytes);
    put(&w, 4, bytes + USB_CAMERA_HEADER_BYTES); /* a picture is one payload */
    put(&w, 4, 1000000);
    PUT(&w, 3, 0, 0, 0);
}
