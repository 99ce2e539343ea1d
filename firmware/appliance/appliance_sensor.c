/* Opens the sensor, reads it, and puts the door at fault when the sensor shows nothing. */
#include <errno.h>
#include <syslog.h>

#include "firmware/appliance/appliance_calls.h"
#include "firmware/appliance/appliance_claim.h"

const char *iso__appliance_sensor_state(const struct iso_appliance *appliance)
{
    if (!appliance->sensor.supervisor.sensor) {
        return "lost";
    }
    if (!appliance->sensor.supervisor.sees) {
        return "silent";
    }
    return appliance->repeats.watch.stuck ? "repeats" : "started";
}

static void init_sensor(struct iso_appliance *appliance, int64_t now_ns)
{
    const struct iso_config_sensor *config = &appliance->borrowed.config->sensor;
    const struct iso_sensor_supervisor_options options = {
        .silence_ns = config->silence_ms * ISO_NS_PER_MS,
        .retry_ns = config->retry_ms * ISO_NS_PER_MS,
        .retry_max_ns = config->retry_max_ms * ISO_NS_PER_MS,
        .pause_ns = config->pause_ms * ISO_NS_PER_MS,
        .stale_ns = config->stale_ms * ISO_NS_PER_MS,
    };
    appliance->sensor.look_due_ns = ISO_NEVER_NS;
    iso_sensor_supervisor_init(&appliance->sensor.supervisor, &options, &appliance->borrowed.sensor,
                               now_ns);
}

static void on_sensor_gone(struct iso_appliance *appliance)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = "lost";
    record.note = appliance->sensor.supervisor.fault.text;
    (void)iso__appliance_say_fault(appliance, appliance->sensor.supervisor.error,
                                   &appliance->sensor.supervisor.fault);
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_action_disconnect(appliance);
}

static void on_sensor_back(struct iso_appliance *appliance)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = "started";
    iso__appliance_repeat_reset(appliance);
    iso__appliance_end_rest(appliance);
    iso__appliance_say(appliance, LOG_NOTICE, "sensor %s started",
                       iso_sensor_name(appliance->sensor.supervisor.sensor));
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_stale_sensor(appliance);
}

/* Begins and ends the safe state. Another person may be before the camera by now, so the visit is
 * forgotten. An action of a client goes on if the camera does. */
static void follow_sight(struct iso_appliance *appliance)
{
    const struct iso_sensor_supervisor *supervisor = &appliance->sensor.supervisor;
    if (supervisor->sees == !appliance->sensor.blind) {
        return;
    }
    appliance->sensor.blind = !supervisor->sees;
    if (appliance->sensor.blind) {
        iso__appliance_forget_face(appliance);
        if (supervisor->sensor) {
            struct iso_audit_record record = iso_audit_record_of("sensor");
            record.reason = "silent";
            record.note = supervisor->fault.text;
            iso__appliance_warn(appliance, &supervisor->fault);
            (void)iso__appliance_note(appliance, &record);
        }
    }
    iso_door_guard_set_fault(appliance->door, appliance->sensor.blind);
    iso__appliance_tell_door(appliance);
}

int iso__appliance_open_sensor(struct iso_appliance *appliance, int64_t now_ns,
                               struct iso_fault *fault)
{
    const struct iso_frame *frame;
    const struct iso_sensor_supervisor *supervisor = &appliance->sensor.supervisor;
    init_sensor(appliance, now_ns);
    if (iso_sensor_supervisor_look(&appliance->sensor.supervisor, now_ns, &frame) ==
        ISO_SENSOR_BACK) {
        on_sensor_back(appliance);
        return 0;
    }
    if (supervisor->error == -EINVAL || supervisor->error == -ENOENT) {
        return iso_fault_set_code(fault, supervisor->fault.code, supervisor->error, "%s",
                                  supervisor->fault.text);
    }
    on_sensor_gone(appliance);
    follow_sight(appliance);
    return 0;
}

/* A step that is late by this time was held up by the disk, by a frame that took long, or by other
 * work of the machine, and not by the sensor. */
static const int64_t stall_ns = 50 * ISO_NS_PER_MS;

static void excuse_stall(struct iso_appliance *appliance, int64_t now_ns)
{
    const int64_t due_ns = appliance->sensor.look_due_ns;
    if (due_ns != ISO_NEVER_NS && now_ns - due_ns >= stall_ns) {
        iso_sensor_supervisor_excuse(&appliance->sensor.supervisor, now_ns - due_ns, now_ns);
    }
}

/* Notes when the next look is due. Called after a look, so that the time that the driver takes in
 * it counts against the sensor. */
static void note_next_look(struct iso_appliance *appliance)
{
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    const int64_t due_ns = iso_sensor_supervisor_due_ns(&appliance->sensor.supervisor, now_ns);
    appliance->sensor.look_due_ns = due_ns > now_ns ? due_ns : now_ns;
}

void iso__appliance_look_at_sensor(struct iso_appliance *appliance, int64_t now_ns)
{
    const struct iso_frame *frame = NULL;
    excuse_stall(appliance, now_ns);
    const enum iso_sensor_news news = iso_sensor_supervisor_look(&appliance->sensor.supervisor,
                                                                 now_ns, &frame);
    note_next_look(appliance);
    follow_sight(appliance); /* before the news is handled */
    switch (news) {
    case ISO_SENSOR_FRAME:
        iso_gallery_set_sensor(appliance->borrowed.gallery, appliance->sensor.supervisor.model);
        iso__appliance_frame(appliance, frame, now_ns);
        break;
    case ISO_SENSOR_QUIET:
        /* Nothing has been seen until now: the person may have left. */
        iso__appliance_time(appliance, now_ns);
        break;
    case ISO_SENSOR_FLAW:
        iso__appliance_complain(appliance, &appliance->sensor.supervisor.fault);
        break;
    case ISO_SENSOR_BACK:
        on_sensor_back(appliance);
        break;
    case ISO_SENSOR_GONE:
        on_sensor_gone(appliance);
        break;
    }
}

int iso_appliance_sensor_fd(const struct iso_appliance *appliance)
{
    return iso_sensor_supervisor_fd(&appliance->sensor.supervisor,
                                    iso_times_now_ns(&appliance->borrowed.times));
}

uint64_t iso_appliance_progress(const struct iso_appliance *appliance)
{
    return appliance->sensor.supervisor.progress;
}

int64_t iso__appliance_sensor_due_ns(const struct iso_appliance *appliance, int64_t now_ns)
{
    return iso_sensor_supervisor_due_ns(&appliance->sensor.supervisor, now_ns);
}

void iso__appliance_close_sensor(struct iso_appliance *appliance)
{
    iso_sensor_supervisor_done(&appliance->sensor.supervisor);
}

int iso__appliance_has_sensor(const struct iso_appliance *appliance, struct iso_fault *fault)
{
    const struct iso_sensor_supervisor *supervisor = &appliance->sensor.supervisor;
    return supervisor->sensor ? 0
                              : iso_fault_set_code(fault, supervisor->fault.code, -ENODEV, "%s",
                                                   supervisor->fault.text);
}

void iso__appliance_blame_sensor(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    appliance->sensor.supervisor.fault = *fault;
    iso__appliance_warn(appliance, fault);
}
