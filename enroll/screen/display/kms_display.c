/* A monitor by the kernel's mode setting (KMS): two dumb buffers, drawn and shown in turn. */
#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>
#include <xf86drm.h>
#include <xf86drmMode.h>

#include "enroll/screen/display/display.h"

struct buffer {
    uint32_t handle, id; /* of the memory, of the frame buffer */
    size_t size;
    void *memory; /* NULL: not mapped */
    cairo_surface_t *surface;
};

struct kms {
    char device[64];
    int fd; /* negative: no card */
    uint32_t connector, crtc;
    drmModeModeInfo mode;
    struct buffer buffers[2];
    int next;              /* the buffer to be drawn next */
    bool lit;              /* a mode is set */
    bool flips;            /* a flip was asked for, and its event has not come */
    drmModeCrtcPtr before; /* what the console had */
};

/* ---- buffers ---- */

static void free_buffer(int fd, struct buffer *buffer)
{
    if (buffer->surface) {
        cairo_surface_destroy(buffer->surface);
    }
    if (buffer->memory) {
        (void)munmap(buffer->memory, buffer->size);
    }
    if (buffer->id) {
        (void)drmModeRmFB(fd, buffer->id);
    }
    if (buffer->handle) {
        (void)drmModeDestroyDumbBuffer(fd, buffer->handle);
    }
    *buffer = (struct buffer){.handle = 0};
}

static bool make_buffer(const struct kms *kms, struct buffer *buffer)
{
    const uint32_t width = kms->mode.hdisplay;
    const uint32_t height = kms->mode.vdisplay;
    uint32_t stride = 0;
    uint64_t size = 0;
    uint64_t offset = 0;
    if (drmModeCreateDumbBuffer(kms->fd, width, height, 32, 0, &buffer->handle, &stride, &size) ||
        drmModeAddFB(kms->fd, width, height, 24, 32, stride, buffer->handle, &buffer->id) ||
        drmModeMapDumbBuffer(kms->fd, buffer->handle, &offset)) {
        return false;
    }
    void *memory = mmap(NULL, size, PROT_READ | PROT_WRITE, MAP_SHARED, kms->fd, (off_t)offset);
    if (memory == MAP_FAILED) {
        return false;
    }
    buffer->memory = memory;
    buffer->size = size;
    buffer->surface = cairo_image_surface_create_for_data(memory, CAIRO_FORMAT_RGB24, (int)width,
                                                          (int)height, (int)stride);
    return cairo_surface_status(buffer->surface) == CAIRO_STATUS_SUCCESS;
}

/* ---- the monitor ---- */

static uint32_t crtc_of(int fd, const drmModeRes *resources, const drmModeConnector *connector)
{
    for (int e = 0; e < connector->count_encoders; e++) {
        drmModeEncoder *encoder = drmModeGetEncoder(fd, connector->encoders[e]);
        const uint32_t possible = encoder ? encoder->possible_crtcs : 0;
        drmModeFreeEncoder(encoder);
        for (int c = 0; c < resources->count_crtcs; c++) {
            if (possible & (1U << c)) {
                return resources->crtcs[c];
            }
        }
    }
    return 0;
}

static drmModeModeInfo preferred(const drmModeConnector *connector)
{
    for (int i = 0; i < connector->count_modes; i++) {
        if (connector->modes[i].type & DRM_MODE_TYPE_PREFERRED) {
            return connector->modes[i];
        }
    }
    return connector->modes[0];
}

/* Finds a connected monitor of the card. */
static bool find_monitor(struct kms *kms)
{
    drmModeRes *resources = drmModeGetResources(kms->fd);
    bool found = false;
    for (int i = 0; resources && !found && i < resources->count_connectors; i++) {
        drmModeConnector *connector = drmModeGetConnector(kms->fd, resources->connectors[i]);
        if (connector && connector->connection == DRM_MODE_CONNECTED &&
            connector->count_modes > 0) {
            kms->connector = connector->connector_id;
            kms->crtc = crtc_of(kms->fd, resources, connector);
            kms->mode = preferred(connector);
            found = kms->crtc != 0;
        }
        drmModeFreeConnector(connector);
    }
    drmModeFreeResources(resources);
    return found;
}

static bool is_connected(const struct kms *kms)
{
    drmModeConnector *connector = drmModeGetConnector(kms->fd, kms->connector);
    const bool connected = connector && connector->connection == DRM_MODE_CONNECTED;
    drmModeFreeConnector(connector);
    return connected;
}

/* ---- opening and closing ---- */

static void drop_monitor(struct kms *kms)
{
    for (int i = 0; i < 2; i++) {
        free_buffer(kms->fd, &kms->buffers[i]);
    }
    kms->lit = false;
    kms->flips = false;
}

static void drop_card(struct kms *kms)
{
    if (kms->fd >= 0) {
        if (kms->lit && kms->before) {
            (void)drmModeSetCrtc(kms->fd, kms->before->crtc_id, kms->before->buffer_id,
                                 kms->before->x, kms->before->y, &kms->connector, 1,
                                 &kms->before->mode);
        }
        drmModeFreeCrtc(kms->before);
        kms->before = NULL;
        drop_monitor(kms);
        (void)close(kms->fd);
        kms->fd = -1;
    }
}

/* Opens a card that has a monitor. */
static bool open_card(struct kms *kms, const char *path)
{
    uint64_t dumb = 0;
    kms->fd = open(path, O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (kms->fd < 0) {
        return false;
    }
    const bool works = drmGetCap(kms->fd, DRM_CAP_DUMB_BUFFER, &dumb) == 0 && dumb &&
                       find_monitor(kms) && make_buffer(kms, &kms->buffers[0]) &&
                       make_buffer(kms, &kms->buffers[1]);
    if (works) {
        kms->before = drmModeGetCrtc(kms->fd, kms->crtc);
        kms->next = 0;
    } else {
        drop_card(kms);
    }
    return works;
}

static bool find_card(struct kms *kms)
{
    char path[64];
    if (*kms->device) {
        return open_card(kms, kms->device);
    }
    for (int i = 0; i < 8; i++) {
        (void)snprintf(path, sizeof path, "/dev/dri/card%d", i);
        if (open_card(kms, path)) {
            return true;
        }
    }
    return false;
}

/* ---- the operations ---- */

static void on_flip(int fd, unsigned sequence, unsigned s, unsigned us, void *context)
{
    struct kms *kms = context;
    (void)fd;
    (void)sequence;
    (void)s;
    (void)us;
    kms->flips = false;
}

static void take_events(struct kms *kms)
{
    drmEventContext handlers = {.version = 2, .page_flip_handler = on_flip};
    struct pollfd event = {.fd = kms->fd, .events = POLLIN};
    while (kms->flips && poll(&event, 1, 0) == 1 && (event.revents & POLLIN)) {
        if (drmHandleEvent(kms->fd, &handlers)) {
            return;
        }
    }
}

static cairo_surface_t *begin(void *self)
{
    struct kms *kms = self;
    if (kms->fd < 0) {
        return NULL;
    }
    take_events(kms);
    return kms->flips ? NULL : kms->buffers[kms->next].surface;
}

static int show(void *self)
{
    struct kms *kms = self;
    const struct buffer *buffer = &kms->buffers[kms->next];
    cairo_surface_flush(buffer->surface);
    int error;
    if (kms->lit) {
        error = drmModePageFlip(kms->fd, kms->crtc, buffer->id, DRM_MODE_PAGE_FLIP_EVENT, kms);
        kms->flips = !error;
    } else {
        error = drmModeSetCrtc(kms->fd, kms->crtc, buffer->id, 0, 0, &kms->connector, 1,
                               &kms->mode);
        kms->lit = !error;
    }
    if (error) {
        return -errno;
    }
    kms->next = 1 - kms->next;
    return 0;
}

static bool look(void *self)
{
    struct kms *kms = self;
    if (kms->fd >= 0 && !is_connected(kms)) {
        drop_card(kms);
    }
    return kms->fd < 0 && find_card(kms);
}

static void close_kms(void *self)
{
    struct kms *kms = self;
    drop_card(kms);
    free(kms);
}

static const struct screen_display_ops ops = {begin, show, look, close_kms, .looks_often = false};

int screen_display_kms(const char *device, struct screen_display *out, struct iso_fault *fault)
{
    struct kms *kms = calloc(1, sizeof *kms);
    if (!kms) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    kms->fd = -1;
    (void)snprintf(kms->device, sizeof kms->device, "%s", device);
    (void)find_card(kms);
    *out = (struct screen_display){&ops, kms};
    return 0;
}
