#include "tests/vm/usb/usb_camera.h"

#include <dirent.h>
#include <errno.h>
#include <linux/usb/ch9.h>
#include <linux/usb/video.h>
#include <poll.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "tests/vm/usb/usb_camera_descriptors.h"
#include "tests/vm/usb/usbip.h"

enum { QUEUE_MAX = 8 };
enum { HEADER_END = 0x80, HEADER_LAST = 0x02 }; /* of bmHeaderInfo (UVC 1.1, 2.4.3.3) */

/* A picture on its way. */
struct shot {
    uint8_t *bytes;
    bool spoilt;
};

struct stream {
    size_t bytes; /* of a picture */
    bool started, halted;
    uint8_t toggle;  /* tells one picture from the next */
    size_t n_queued; /* the oldest is first */
    struct shot queue[QUEUE_MAX];
    size_t sent; /* bytes of the first one, with its header */
};

struct usb_camera {
    struct usb_camera_options options;
    char serial[32], node[64];
    struct usbip_cable *cable;
    pthread_mutex_t lock; /* protects `cable` and the streams */
    struct stream streams[USB_CAMERA_STREAMS];
};

/* ---- requests of the host ---------------------------------------------------- */

static void set_stream(struct stream *stream, bool start)
{
    stream->started = start;
    stream->halted = false;
    stream->n_queued = stream->sent = 0;
}

static int count_started(const struct usb_camera *camera)
{
    int n = 0;
    for (int i = 0; i < camera->options.n_streams; i++) {
        n += camera->streams[i].started;
    }
    return n;
}

static int answer_class(struct usb_camera *camera, const struct usbip_setup *setup, uint8_t *data)
{
    const int index = (setup->index & 0xff) - 1;
    const int what = setup->value >> 8;
    if (index < 0 || index >= camera->options.n_streams ||
        (what != UVC_VS_PROBE_CONTROL && what != UVC_VS_COMMIT_CONTROL)) {
        return -EPIPE;
    }
    switch (setup->request) {
    case UVC_SET_CUR:
        if (what == UVC_VS_COMMIT_CONTROL) {
            set_stream(&camera->streams[index], true);
        }
        return 0;
    case UVC_GET_LEN:
        data[0] = USB_CAMERA_PROBE_BYTES;
        data[1] = 0;
        return 2;
    case UVC_GET_INFO:
        data[0] = 3; /* may be read and written */
        return 1;
    default:
        usb_camera_probe(&camera->options.streams[index], data);
        return USB_CAMERA_PROBE_BYTES;
    }
}

/* A host stops the stream of a bulk endpoint by clearing the endpoint's halt. */
static void clear_halt(struct usb_camera *camera, unsigned endpoint)
{
    const int index = (int)(endpoint & 0x0f) - 1;
    if (index >= 0 && index < camera->options.n_streams) {
        set_stream(&camera->streams[index], false);
    }
}

static int answer_standard(struct usb_camera *camera, const struct usbip_setup *setup,
                           uint8_t *data)
{
    uint8_t descriptor[USB_CAMERA_DESCRIPTOR_MAX];
    size_t n;
    switch (setup->request) {
    case USB_REQ_GET_DESCRIPTOR:
        n = usb_camera_descriptor(&camera->options, setup->value >> 8, setup->value & 0xff,
                                  descriptor);
        n = n < setup->length ? n : setup->length;
        memcpy(data, descriptor, n);
        return n > 0 ? (int)n : -EPIPE;
    case USB_REQ_CLEAR_FEATURE:
        if ((setup->type & USB_RECIP_MASK) == USB_RECIP_ENDPOINT) {
            clear_halt(camera, setup->index);
        }
        return 0;
    case USB_REQ_SET_CONFIGURATION:
    case USB_REQ_SET_INTERFACE:
        return 0;
    case USB_REQ_GET_STATUS:
        data[0] = data[1] = 0;
        return 2;
    default:
        return -EPIPE;
    }
}

static int control(void *self, const struct usbip_setup *setup, uint8_t *data)
{
    struct usb_camera *camera = self;
    (void)pthread_mutex_lock(&camera->lock);
    const int before = count_started(camera);
    const int n = (setup->type & USB_TYPE_MASK) == USB_TYPE_CLASS
                      ? answer_class(camera, setup, data)
                      : answer_standard(camera, setup, data);
    const int after = count_started(camera);
    (void)pthread_mutex_unlock(&camera->lock);
    if (after != before && camera->options.started) {
        camera->options.started(camera->options.context, after);
    }
    return n;
}

/* ---- pictures ---------------------------------------------------------------- */

/* Writes the next piece of a payload, which is a header and the picture. A spoilt picture ends half
 * way, with a transfer that is not full. */
static int send_piece(struct stream *stream, uint8_t *data, size_t room)
{
    const struct shot *shot = &stream->queue[0];
    size_t whole = stream->bytes + USB_CAMERA_HEADER_BYTES, at = 0;
    if (shot->spoilt) {
        whole /= 2;
        whole -= whole % room == 0;
    }
    if (stream->sent == 0) {
        data[0] = USB_CAMERA_HEADER_BYTES;
        data[1] = (uint8_t)(HEADER_END | HEADER_LAST | stream->toggle);
        at = stream->sent = USB_CAMERA_HEADER_BYTES;
    }
    size_t n = whole - stream->sent < room - at ? whole - stream->sent : room - at;
    memcpy(data + at, shot->bytes + stream->sent - USB_CAMERA_HEADER_BYTES, n);
    stream->sent += n;
    if (stream->sent == whole) {
        stream->sent = 0;
        stream->toggle ^= 1;
        uint8_t *bytes = shot->bytes;
        stream->n_queued--;
        memmove(stream->queue, stream->queue + 1, (QUEUE_MAX - 1) * sizeof *stream->queue);
        stream->queue[QUEUE_MAX - 1].bytes = bytes;
    }
    return (int)(at + n);
}

static int fill(void *self, unsigned endpoint, uint8_t *data, size_t room)
{
    struct usb_camera *camera = self;
    int n = -EAGAIN;
    if (endpoint > (unsigned)camera->options.n_streams) {
        return -EPIPE;
    }
    (void)pthread_mutex_lock(&camera->lock);
    struct stream *stream = &camera->streams[endpoint - 1];
    if (stream->halted) {
        n = -EPIPE;
    } else if (stream->started && stream->n_queued > 0) {
        n = send_piece(stream, data, room);
    }
    (void)pthread_mutex_unlock(&camera->lock);
    return n;
}

/* Tells the cable's thread that there is something to send. The caller holds the lock. */
static void wake(const struct usb_camera *camera)
{
    if (camera->cable) {
        usbip_wake(camera->cable);
    }
}

void usb_camera_shoot(struct usb_camera *camera, int index, const void *picture, bool spoilt)
{
    struct stream *stream = &camera->streams[index];
    (void)pthread_mutex_lock(&camera->lock);
    if (stream->started && stream->n_queued < QUEUE_MAX) {
        struct shot *shot = &stream->queue[stream->n_queued++];
        memcpy(shot->bytes, picture, stream->bytes);
        shot->spoilt = spoilt;
    }
    wake(camera);
    (void)pthread_mutex_unlock(&camera->lock);
}

void usb_camera_halt(struct usb_camera *camera)
{
    (void)pthread_mutex_lock(&camera->lock);
    for (int i = 0; i < camera->options.n_streams; i++) {
        camera->streams[i].halted = camera->streams[i].started;
    }
    wake(camera);
    (void)pthread_mutex_unlock(&camera->lock);
}

/* ---- the camera -------------------------------------------------------------- */

static int prepare_stream(struct stream *stream, const struct usb_camera_stream *options,
                          struct iso_fault *fault)
{
    uint8_t guid[16];
    stream->bytes = usb_camera_pixel_bytes(options->format, guid) * (size_t)options->width_px *
                    (size_t)options->height_px;
    if (stream->bytes == 0) {
        return iso_fault_set(fault, -EINVAL, "USB camera: an unknown format");
    }
    for (int i = 0; i < QUEUE_MAX; i++) {
        stream->queue[i].bytes = malloc(stream->bytes);
        if (!stream->queue[i].bytes) {
            return iso_fault_set(fault, -ENOMEM, "USB camera: out of memory");
        }
    }
    return 0;
}

int usb_camera_new(const struct usb_camera_options *options, struct usb_camera **out,
                   struct iso_fault *fault)
{
    int error = 0;
    struct usb_camera *camera = calloc(1, sizeof *camera);
    if (!camera) {
        return iso_fault_set(fault, -ENOMEM, "USB camera: out of memory");
    }
    camera->options = *options;
    (void)snprintf(camera->serial, sizeof camera->serial, "%s", options->serial);
    camera->options.serial = camera->serial;
    (void)pthread_mutex_init(&camera->lock, NULL);
    for (int i = 0; !error && i < options->n_streams; i++) {
        error = prepare_stream(&camera->streams[i], &options->streams[i], fault);
    }
    if (error) {
        usb_camera_free(camera);
        return error;
    }
    *out = camera;
    return 0;
}

void usb_camera_free(struct usb_camera *camera)
{
    if (camera) {
        usbip_pull_out(camera->cable);
        for (int i = 0; i < USB_CAMERA_STREAMS * QUEUE_MAX; i++) {
            free(camera->streams[i / QUEUE_MAX].queue[i % QUEUE_MAX].bytes);
        }
        (void)pthread_mutex_destroy(&camera->lock);
        free(camera);
    }
}

int usb_camera_plug(struct usb_camera *camera, bool in, struct iso_fault *fault)
{
    const struct usbip_device device = {camera, control, fill};
    struct usbip_cable *cable = NULL;
    const int error = in ? usbip_plug_in(&device, camera->options.port, &cable, fault) : 0;
    (void)pthread_mutex_lock(&camera->lock);
    struct usbip_cable *old = camera->cable;
    camera->cable = cable;
    for (int i = 0; !in && i < camera->options.n_streams; i++) {
        set_stream(&camera->streams[i], false);
    }
    (void)pthread_mutex_unlock(&camera->lock);
    usbip_pull_out(old);
    if (!in && camera->options.started) {
        camera->options.started(camera->options.context, 0);
    }
    return error;
}

/* ---- video nodes ------------------------------------------------------------- */

/* Whether a video node is number `index` of the device at the port. */
static bool is_node_of(const char *name, unsigned port, int index)
{
    char path[320], target[256] = "", end[24];
    int found = -1;
    (void)snprintf(path, sizeof path, "/sys/class/video4linux/%s/device", name);
    const ssize_t n = readlink(path, target, sizeof target - 1);
    (void)snprintf(end, sizeof end, "-%u:1.0", port + 1);
    if (n < (ssize_t)strlen(end) || strcmp(target + n - strlen(end), end) != 0) {
        return false;
    }
    (void)snprintf(path, sizeof path, "/sys/class/video4linux/%s/index", name);
    FILE *file = fopen(path, "re");
    if (file) {
        found = fscanf(file, "%d", &found) == 1 ? found : -1;
        (void)fclose(file);
    }
    return found == index;
}

static bool find_node(struct usb_camera *camera, int stream)
{
    struct dirent *entry;
    bool found = false;
    DIR *directory = opendir("/sys/class/video4linux");
    while (directory && !found && (entry = readdir(directory))) {
        /* Each stream has a node of pictures and one of metadata. */
        if (is_node_of(entry->d_name, camera->options.port, 2 * stream)) {
            (void)snprintf(camera->node, sizeof camera->node, "/dev/%.50s", entry->d_name);
            found = access(camera->node, F_OK) == 0;
        }
    }
    if (directory) {
        (void)closedir(directory);
    }
    return found;
}

const char *usb_camera_node(struct usb_camera *camera, int stream)
{
    for (int i = 0; i < 2000; i++) {
        if (find_node(camera, stream)) {
            return camera->node;
        }
        (void)poll(NULL, 0, 10);
    }
    camera->node[0] = '\0';
    return camera->node;
}
