#include "tests/openni2/virtual_stream.h"

#include <math.h>
#include <string.h>

static OniVideoMode mode_of(OniPixelFormat format, const struct iso_recording_meta *meta)
{
    return (OniVideoMode){
        .pixelFormat = format,
        .resolutionX = meta->camera.width_px,
        .resolutionY = meta->camera.height_px,
        .fps = SIM_VIRTUAL_CAMERA_HZ,
    };
}

void sim_virtual_stream_init(struct sim_virtual_stream *stream, OniSensorType type,
                             const struct iso_recording_meta *meta, pthread_mutex_t *lock)
{
    *stream = (struct sim_virtual_stream){
        .type = type,
        .meta = meta,
        .lock = lock,
        .mirroring = TRUE,
        .cropping = {.width = meta->camera.width_px, .height = meta->camera.height_px},
    };
    if (type == ONI_SENSOR_IR) {
        stream->modes[stream->n_modes++] = mode_of(ONI_PIXEL_FORMAT_GRAY16, meta);
    } else {
        stream->modes[stream->n_modes++] = mode_of(ONI_PIXEL_FORMAT_DEPTH_1_MM, meta);
    }
    if (type == ONI_SENSOR_DEPTH && meta->unit_mm < 1.0) {
        stream->modes[stream->n_modes++] = mode_of(ONI_PIXEL_FORMAT_DEPTH_100_UM, meta);
    }
    stream->mode = stream->modes[0];
}

/* ---- properties ---- */

OniBool sim_virtual_stream_has(int property)
{
    switch (property) {
    case ONI_STREAM_PROPERTY_CROPPING:
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
    case ONI_STREAM_PROPERTY_MAX_VALUE:
    case ONI_STREAM_PROPERTY_MIN_VALUE:
    case ONI_STREAM_PROPERTY_MIRRORING:
    case ONI_STREAM_PROPERTY_STRIDE:
        return TRUE;
    default:
        return FALSE;
    }
}

static OniStatus copy_out(const void *value, size_t value_size, void *data, int *size)
{
    if (*size != (int)value_size) {
        return ONI_STATUS_BAD_PARAMETER;
    }
    memcpy(data, value, value_size);
    return ONI_STATUS_OK;
}

static float view_rad(int size_px, double focal_px)
{
    return (float)(2.0 * atan(size_px / (2.0 * focal_px)));
}

OniStatus sim_virtual_stream_get(struct sim_virtual_stream *stream, int property, void *data,
                                 int *size)
{
    const struct iso_camera *camera = &stream->meta->camera;
    pthread_mutex_lock(stream->lock);
    const OniVideoMode mode = stream->mode;
    const OniCropping cropping = stream->cropping;
    const OniBool mirroring = stream->mirroring;
    pthread_mutex_unlock(stream->lock);
    switch (property) {
    case ONI_STREAM_PROPERTY_CROPPING:
        return copy_out(&cropping, sizeof cropping, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
        return copy_out(&(float){view_rad(camera->width_px, camera->fx_px)}, sizeof(float), data,
                        size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
        return copy_out(&(float){view_rad(camera->height_px, camera->fy_px)}, sizeof(float), data,
                        size);
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
        return copy_out(&mode, sizeof mode, data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE: /* a recorder sizes its tables by it */
        return copy_out(&(int){UINT16_MAX}, sizeof(int), data, size);
    case ONI_STREAM_PROPERTY_MIN_VALUE:
        return copy_out(&(int){0}, sizeof(int), data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
        return copy_out(&mirroring, sizeof mirroring, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
        return copy_out(&(int){mode.resolutionX * 2}, sizeof(int), data, size);
    default:
        return ONI_STATUS_NOT_SUPPORTED;
    }
}

static OniStatus set_mode(struct sim_virtual_stream *stream, const OniVideoMode *mode)
{
    for (int i = 0; i < stream->n_modes; i++) {
        const OniVideoMode *known = &stream->modes[i];
        if (mode->pixelFormat == known->pixelFormat && mode->fps == known->fps &&
            mode->resolutionX == known->resolutionX && mode->resolutionY == known->resolutionY) {
            stream->mode = *known;
            return ONI_STATUS_OK;
        }
    }
    return ONI_STATUS_BAD_PARAMETER;
}

static OniStatus set_cropping(struct sim_virtual_stream *stream, const OniCropping *cropping)
{
    if (cropping->enabled &&
        (cropping->originX < 0 || cropping->originY < 0 || cropping->width < 1 ||
         cropping->height < 1 || cropping->width > stream->mode.resolutionX - cropping->originX ||
         cropping->height > stream->mode.resolutionY - cropping->originY)) {
        return ONI_STATUS_BAD_PARAMETER;
    }
    stream->cropping = *cropping;
    return ONI_STATUS_OK;
}

OniStatus sim_virtual_stream_set(struct sim_virtual_stream *stream, int property, const void *data,
                                 int size)
{
    OniStatus status = ONI_STATUS_NOT_SUPPORTED;
    pthread_mutex_lock(stream->lock);
    if (property == ONI_STREAM_PROPERTY_VIDEO_MODE) {
        status = size == (int)sizeof(OniVideoMode) ? set_mode(stream, data)
                                                   : ONI_STATUS_BAD_PARAMETER;
    } else if (property == ONI_STREAM_PROPERTY_CROPPING) {
        status = size == (int)sizeof(OniCropping) ? set_cropping(stream, data)
                                                  : ONI_STATUS_BAD_PARAMETER;
    } else if (property == ONI_STREAM_PROPERTY_MIRRORING) {
        status = size == (int)sizeof(OniBool) ? ONI_STATUS_OK : ONI_STATUS_BAD_PARAMETER;
        if (status == ONI_STATUS_OK) {
            memcpy(&stream->mirroring, data, sizeof stream->mirroring);
        }
    }
    pthread_mutex_unlock(stream->lock);
    return status;
}

/* ---- frames ---- */

/* The 16-bit sample of a pixel; a depth beyond 16 bits is not measured. */
static uint16_t sample_of(const struct iso_frame *frame, size_t pixel, OniPixelFormat format)
{
    if (format == ONI_PIXEL_FORMAT_GRAY16) {
        return (uint16_t)lround((double)frame->intensity[pixel] * UINT16_MAX);
    }
    const double unit_mm = format == ONI_PIXEL_FORMAT_DEPTH_100_UM ? 0.1 : 1.0;
    const long count = lround((double)frame->depth_mm[pixel] / unit_mm);
    return count > UINT16_MAX ? 0 : (uint16_t)count;
}

static void fill(const struct iso_frame *frame, OniPixelFormat format, OniBool mirroring,
                 const OniCropping *window, uint16_t *samples)
{
    for (int row = 0; row < window->height; row++) {
        for (int column = 0; column < window->width; column++) {
            const int x = window->originX + column;
            const int u = mirroring ? frame->width_px - 1 - x : x;
            const size_t pixel = (size_t)(window->originY + row) * (size_t)frame->width_px +
                                 (size_t)u;
            *samples++ = sample_of(frame, pixel, format);
        }
    }
}

void sim_virtual_stream_deliver(struct sim_virtual_stream *stream, const struct iso_frame *frame,
                                int index, uint64_t t_us)
{
    pthread_mutex_lock(stream->lock);
    const struct sim_virtual_stream now = *stream;
    pthread_mutex_unlock(stream->lock);
    if (!now.started || !now.services || !now.new_frame) {
        return;
    }
    OniCropping window = now.cropping;
    if (!window.enabled) {
        window = (OniCropping){0, 0, 0, frame->width_px, frame->height_px};
    }
    OniFrame *out = now.services->acquireFrame(now.services->streamServices);
    if (!out) {
        return;
    }
    out->dataSize = window.width * window.height * (int)sizeof(uint16_t);
    out->sensorType = now.type;
    out->timestamp = t_us;
    out->frameIndex = index;
    out->videoMode = now.mode;
    out->width = window.width;
    out->height = window.height;
    out->croppingEnabled = window.enabled;
    out->cropOriginX = window.originX;
    out->cropOriginY = window.originY;
    out->stride = window.width * (int)sizeof(uint16_t);
    fill(frame, now.mode.pixelFormat, now.mirroring, &window, out->data);
    now.new_frame(stream, out, now.new_frame_cookie);
    now.services->releaseFrame(now.services->streamServices, out);
}
