#include "drivers/sensor/picture/picture_sensor.h"

void iso_picture_sensor_options(const struct iso_option_set *set, int *fps, int64_t *tolerance_ns)
{
    *fps = (int)iso_option_number(set, "fps");
    *tolerance_ns = (int64_t)(iso_option_number(set, "pair_ms") * 1e6);
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

void iso_picture_sensor_set_interval(void *self, int64_t interval_ns)
{
    const struct iso_picture_sensor *sensor = self;
    iso_picture_stream_set_interval(sensor->stream, interval_ns);
}

void iso_picture_sensor_health(void *self, struct iso_sensor_device_health *out)
{
    const struct iso_picture_sensor *sensor = self;
    out->dropped = iso_picture_stream_dropped(sensor->stream);
}
