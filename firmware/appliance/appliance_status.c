/* The status of the appliance, and the view of its sensor. */
#include <stdio.h>

#include "firmware/appliance/appliance_access.h"
#include "firmware/appliance/appliance_calls.h"

struct iso_appliance_status iso_appliance_status(const struct iso_appliance *appliance)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const struct iso_sensor *sensor = appliance->sensor.supervisor.sensor;
    const struct iso_door_look door = iso_door_guard_look(appliance->door);
    struct iso_appliance_status status = {
        .mode = appliance->mode,
        .door = door.state,
        .door_ordinary = door.ordinary,
        .sensor_state = iso__appliance_sensor_state(appliance),
        .sensor_model = appliance->sensor.supervisor.model,
        .sensor_calibration = appliance->sensor.supervisor.calibration,
        .sensor_fault = appliance->sensor.supervisor.fault.text,
        .sensor_fault_code = appliance->sensor.supervisor.fault.code,
        .sensor_calibration_code = appliance->sensor.supervisor.calibration_code,
        .clock_fault = appliance->clock_fault.text,
        .clock_fault_code = iso__appliance_clock_code(appliance),
        .stale_fault = appliance->stale.fault.text,
        .stale_fault_code = appliance->stale.fault.code,
        .storage_fault = iso__appliance_storage_fault(appliance)->text,
        .storage_fault_code = iso__appliance_storage_fault(appliance)->code,
        .key_is_credential = iso_key_ring_has_credential(appliance->borrowed.ring),
        .counter_fault = appliance->counter.fault.text,
        .counter_fault_code = appliance->counter.fault.code,
        .last_outcome = appliance->outcome.text,
        .view = appliance->aim.has_view ? &appliance->aim.view : NULL,
        .counts = appliance->outcome.counts,
        .reader_state = iso__appliance_reader_state(appliance),
        .reader_fault = appliance->access.reader_fault.text,
        .lockdown = appliance->lockout.state.lockdown,
        .lockout_ns = iso_lockout_remaining_ns(&appliance->lockout.state,
                                               iso_times_now_ns(&appliance->borrowed.times)),
        .image_check = pipeline->ops->image_check ? pipeline->ops->image_check(pipeline->self)
                                                  : "off",
        .frames = appliance->sensor.supervisor.frames,
        .model = pipeline->ops->model(pipeline->self),
        .algorithm = pipeline->ops->algorithm(pipeline->self),
        .people_valid = iso__appliance_count_valid(appliance),
        .uptime_ns = iso_times_now_ns(&appliance->borrowed.times) - appliance->start_ns,
    };
    (void)snprintf(status.door_fault, sizeof status.door_fault, "%s", door.fault.text);
    status.door_fault_code = door.fault.code;
    if (sensor) {
        const struct iso_sensor_health health = iso_sensor_health(sensor);
        (void)snprintf(status.sensor_health, sizeof status.sensor_health, "%s",
                       health.device.state);
        status.sensor_health_code = health.device.code;
    }
    return status;
}

/* ---- the view of the sensor, for the person who aims it ---- */

/* A person who turns a camera cannot follow more. */
static const int64_t view_interval_ns = 100 * ISO_NS_PER_MS;

void iso_appliance_aim(struct iso_appliance *appliance, bool on)
{
    appliance->aim.on = on;
    /* The next frame is shown at once, however short ago another one was shown. */
    appliance->aim.told_ns = iso_times_now_ns(&appliance->borrowed.times) - ISO_NS_PER_S;
}

bool iso_appliance_is_aimed(const struct iso_appliance *appliance)
{
    return appliance->aim.on;
}

void iso__appliance_show(struct iso_appliance *appliance, enum iso_capture capture)
{
    const struct iso_appliance_events *events = &appliance->borrowed.events;
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    appliance->aim.view = iso_view_of(&appliance->face.extraction, capture,
                                      &appliance->face.motion);
    if (appliance->aim.on && now_ns - appliance->aim.told_ns >= view_interval_ns) {
        appliance->aim.told_ns = now_ns;
        events->view(events->context, &appliance->aim.view);
    }
    appliance->aim.has_view = true;
}
