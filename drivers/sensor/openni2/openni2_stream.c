#include "drivers/sensor/openni2/openni2_stream.h"

#include <errno.h>
#include <stdint.h>

#include "drivers/sensor/openni2/openni2_frame.h"
#include "drivers/sensor/openni2/openni2_runtime.h"

static const char owner[] = "sensor openni2";

static int get_property(OniStreamHandle stream, int property, void *value, int size)
{
    return oniStreamGetProperty(stream, property, value, &size) == ONI_STATUS_OK ? 0 : -EIO;
}

/* Turns mirroring off. This cannot be set for a file, which only reports whether its frames are
 * mirrored. */
static void unmirror_stream(const struct iso__openni2_session *session,
                            struct iso__openni2_stream *stream)
{
    const OniBool off = FALSE;
    OniBool mirroring = FALSE;
    if (!session->file) {
        (void)oniStreamSetProperty(stream->handle, ONI_STREAM_PROPERTY_MIRRORING, &off, sizeof off);
    }
    stream->mirrored = get_property(stream->handle, ONI_STREAM_PROPERTY_MIRRORING, &mirroring,
                                    sizeof mirroring) == 0 &&
                       mirroring;
}

/* Reads the number of frames of a stream of a file, which tells where the file ends. The runtime
 * reports the end, too, but later and from another thread. */
static int count_frames(const struct iso__openni2_session *session,
                        struct iso__openni2_stream *stream, struct iso_fault *fault)
{
    if (get_property(stream->handle, ONI_STREAM_PROPERTY_NUMBER_OF_FRAMES, &stream->n_frames,
                     sizeof stream->n_frames)) {
        return iso_fault_set(fault, -EIO, "%s: %s: does not report its number of frames", owner,
                             session->info.uri);
    }
    return 0;
}

static bool modes_equal(const OniVideoMode *a, const OniVideoMode *b)
{
    return a->pixelFormat == b->pixelFormat && a->resolutionX == b->resolutionX &&
           a->resolutionY == b->resolutionY && a->fps == b->fps;
}

/* Ranks a mode: a larger number fits better, and 0 does not fit. `now` is the mode that is set. */
typedef int mode_rank(const OniVideoMode *mode, const OniVideoMode *now, const void *context);

/* Sets the mode that fits best. */
static int choose_mode(const struct iso__openni2_session *session, const char *name,
                       mode_rank *rank, const void *context, struct iso__openni2_stream *stream,
                       struct iso_fault *fault)
{
    OniVideoMode now = {0}, best = {0};
    int best_rank = 0;
    const OniSensorInfo *sensor = oniStreamGetSensorInfo(stream->handle);
    if (!sensor || get_property(stream->handle, ONI_STREAM_PROPERTY_VIDEO_MODE, &now, sizeof now)) {
        return iso__openni2_refuse(ONI_STATUS_ERROR, "video modes cannot be read", fault);
    }
    for (int i = 0; i < sensor->numSupportedVideoModes; i++) {
        const int value = rank(&sensor->pSupportedVideoModes[i], &now, context);
        if (value > best_rank) {
            best_rank = value;
            best = sensor->pSupportedVideoModes[i];
        }
    }
    if (best_rank == 0) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EINVAL,
                                  "%s: %s: no %s mode of %d fits; now it is %dx%d@%d, format %d",
                                  owner, session->info.uri, name, sensor->numSupportedVideoModes,
                                  now.resolutionX, now.resolutionY, now.fps, now.pixelFormat);
    }
    if (!modes_equal(&best, &now)) {
        const OniStatus status = oniStreamSetProperty(
            stream->handle, ONI_STREAM_PROPERTY_VIDEO_MODE, &best, sizeof best);
        if (status != ONI_STATUS_OK) {
            return iso__openni2_refuse(status, "video mode is refused", fault);
        }
    }
    stream->mode = best;
    return 0;
}

/* Claims a stream of the device in the mode that fits best, with the whole image and not
 * mirrored. */
static int claim_stream(struct iso__openni2_session *session, OniSensorType type, mode_rank *rank,
                        const void *context, struct iso__openni2_stream *stream,
                        struct iso_fault *fault)
{
    const char *name = type == ONI_SENSOR_DEPTH ? "depth" : "intensity";
    const OniCropping whole = {.enabled = FALSE};
    if (oniDeviceCreateStream(session->device, type, &stream->handle) != ONI_STATUS_OK) {
        stream->handle = NULL;
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EINVAL,
                                  "%s: %s: has no %s stream", owner, session->info.uri, name);
    }
    const int error = choose_mode(session, name, rank, context, stream, fault);
    if (error) {
        return error;
    }
    if (!session->file) {
        (void)oniStreamSetProperty(stream->handle, ONI_STREAM_PROPERTY_CROPPING, &whole,
                                   sizeof whole);
    }
    unmirror_stream(session, stream);
    return session->file ? count_frames(session, stream, fault) : 0;
}

/* Ranks modes of the wanted size, rate and unit. A size or rate that is not given is that of the
 * present mode. The mode with the finer unit is better. */
static int rank_depth(const OniVideoMode *mode, const OniVideoMode *now, const void *context)
{
    const struct iso__openni2_wish *wish = context;
    const double unit_mm = iso__openni2_unit_mm(mode->pixelFormat);
    const bool fits = unit_mm > 0.0 &&
                      (wish->unit_um == 0 || wish->unit_um == (int)(unit_mm * 1000.0 + 0.5)) &&
                      mode->resolutionX == (wish->width_px ? wish->width_px : now->resolutionX) &&
                      mode->resolutionY == (wish->height_px ? wish->height_px : now->resolutionY) &&
                      mode->fps == (wish->fps ? wish->fps : now->fps);
    if (!fits) {
        return 0;
    }
    return unit_mm < 1.0 ? 2 : 1;
}

/* Ranks modes of the size of the depth mode. A mode with the rate of the depth mode is better;
 * among equal rates, 16 grey bits are better than 8, and these are better than colours. */
static int rank_grey(const OniVideoMode *mode, const OniVideoMode *now, const void *context)
{
    const OniVideoMode *depth = context;
    (void)now;
    if (mode->resolutionX != depth->resolutionX || mode->resolutionY != depth->resolutionY) {
        return 0;
    }
    const int same_rate = mode->fps == depth->fps ? 4 : 0;
    switch (mode->pixelFormat) {
    case ONI_PIXEL_FORMAT_GRAY16:
        return same_rate + 3;
    case ONI_PIXEL_FORMAT_GRAY8:
        return same_rate + 2;
    case ONI_PIXEL_FORMAT_RGB888:
        return same_rate + 1;
    default:
        return 0;
    }
}

/* Tells the device to align the depths with the view of the colour camera. */
static int register_to_color(const struct iso__openni2_session *session, struct iso_fault *fault)
{
    const OniImageRegistrationMode mode = ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR;
    if (session->file) {
        return iso_fault_set(fault, -EINVAL,
                             "%s: %s: a file does not say whether its colours are registered",
                             owner, session->info.uri);
    }
    if (!oniDeviceIsImageRegistrationModeSupported(session->device, mode) ||
        oniDeviceSetProperty(session->device, ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION, &mode,
                             sizeof mode) != ONI_STATUS_OK) {
        return iso_fault_set(fault, -EINVAL, "%s: %s: cannot register depths to colours", owner,
                             session->info.uri);
    }
    /* Without this, frames are paired by their times. */
    (void)oniDeviceEnableDepthColorSync(session->device);
    return 0;
}

/* The count that means full intensity. */
static double grey_full_scale(const struct iso__openni2_stream *stream)
{
    int top = 0;
    if (stream->mode.pixelFormat != ONI_PIXEL_FORMAT_GRAY16) {
        return UINT8_MAX;
    }
    const bool told = get_property(stream->handle, ONI_STREAM_PROPERTY_MAX_VALUE, &top,
                                   sizeof top) == 0 &&
                      top > 0 && top <= UINT16_MAX;
    return told ? top : UINT16_MAX;
}

int iso__openni2_claim_depth(struct iso__openni2_session *session,
                             const struct iso__openni2_wish *wish, struct iso_fault *fault)
{
    return claim_stream(session, ONI_SENSOR_DEPTH, rank_depth, wish, &session->depth, fault);
}

int iso__openni2_claim_grey(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                            struct iso_fault *fault)
{
    const OniSensorType type = grey == ISO__OPENNI2_IR ? ONI_SENSOR_IR : ONI_SENSOR_COLOR;
    int error = grey == ISO__OPENNI2_COLOR ? register_to_color(session, fault) : 0;
    if (!error) {
        error = claim_stream(session, type, rank_grey, &session->depth.mode, &session->grey, fault);
    }
    if (!error) {
        session->grey.full_scale = grey_full_scale(&session->grey);
    }
    return error;
}

int iso__openni2_find_camera(struct iso__openni2_session *session, enum iso__openni2_grey grey,
                             struct iso_fault *fault)
{
    const OniStreamHandle eye = grey == ISO__OPENNI2_COLOR ? session->grey.handle
                                                           : session->depth.handle;
    const OniVideoMode *mode = &session->depth.mode;
    struct iso_fault why;
    float x_rad = 0, y_rad = 0;
    if (get_property(eye, ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &x_rad, sizeof x_rad) ||
        get_property(eye, ONI_STREAM_PROPERTY_VERTICAL_FOV, &y_rad, sizeof y_rad)) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EIO,
                                  "%s: %s: does not report its field of view", owner,
                                  session->info.uri);
    }
    session->camera = iso__openni2_camera(mode->resolutionX, mode->resolutionY, (double)x_rad,
                                          (double)y_rad);
    if (iso_camera_check(&session->camera, &why)) {
        return iso_fault_set_code(fault, ISO_FAULT_SENSOR_FORMAT, -EIO,
                                  "%s: %s: view of %g x %g rad: %s", owner, session->info.uri,
                                  (double)x_rad, (double)y_rad, why.text);
    }
    return 0;
}
