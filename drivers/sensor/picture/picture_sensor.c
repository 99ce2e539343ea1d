#include "drivers/sensor/picture/picture_sensor.h"

int iso_picture_sensor_options(const char *owner, const struct iso_option *options,
                               size_t n_options, int *fps, int64_t *tolerance_ns,
                               struct iso_fault *fault)
{
    double rate = 0.0, pair_ms = 0.0;
    int error = iso_options_number(owner, options, n_options, "fps", 1.0, 1000.0, 0.0, &rate,
                                   fault);
    error = error ? error
                  : iso_options_number(owner, options, n_options, "pair_ms", 0.1, 1000.0, 4.0,
                                       &pair_ms, fault);
    if (!error) {
        *fps = (int)rate;
        *tolerance_ns = (int64_t)(pair_ms * 1e6);
    }
    return error;
}

int iso_picture_sensor_start(void *self, struct iso_fault *fault)
{
    const struct iso_picture_sensor *sensor = self;
    return iso_picture_stream_start(sensor->stream, fault);
}

int iso_picture_sensor_stop(void *self)
{
    const struct iso_picture_sensor *sensor = self;
    return iso_picture_stream_stop(sensor->stream);
}

int iso_picture_sensor_poll_fd(void *self)
{
    const struct iso_picture_sensor *sensor = self;
    return iso_picture_stream_fd(sensor->stream);
}

void iso_picture_sensor_health(void *self, struct iso_sensor_device_health *out)
{
    const struct iso_picture_sensor *sensor = self;
    out->dropped = iso_picture_stream_dropped(sensor->stream);
}
