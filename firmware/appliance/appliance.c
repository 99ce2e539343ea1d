#include "firmware/appliance/appliance.h"

#include <errno.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>

#include "drivers/process/thread.h"
#include "firmware/appliance/appliance_state.h"

const char *iso_appliance_mode_name(enum iso_appliance_mode mode)
{
    static const char *const names[ISO_APPLIANCE_MODES] = {
        "watch", "claimed", "enroll", "verify", "identify",
    };
    return (unsigned)mode < ISO_APPLIANCE_MODES ? names[mode] : NULL;
}

void iso__appliance_say(struct iso_appliance *appliance, int priority, const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    appliance->borrowed.events.message(appliance->borrowed.events.context, priority, text);
}

/* ---- the log ---- */

int iso__appliance_say_fault(struct iso_appliance *appliance, int error,
                             const struct iso_fault *fault)
{
    char tag[ISO_FAULT_TAG_SIZE];
    if (error) {
        iso__appliance_say(appliance, LOG_ERR, "%s%s", fault->text,
                           iso_fault_tag(fault->code, tag));
    }
    return error;
}

void iso__appliance_warn(struct iso_appliance *appliance, const struct iso_fault *fault)
{
    char tag[ISO_FAULT_TAG_SIZE];
    iso__appliance_say(appliance, LOG_WARNING, "%s%s", fault->text,
                       iso_fault_tag(fault->code, tag));
}

int iso__appliance_record_first(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault)
{
    struct iso_fault own = {.text = ""};
    const int error = iso_audit_writer_append(appliance->log, record, ISO_NEVER_NS, NULL, &own);
    iso__appliance_note_storage(appliance, error, &own);
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

int iso__appliance_record(struct iso_appliance *appliance, const struct iso_audit_record *record)
{
    struct iso_fault fault = {.text = ""};
    const int error = iso__appliance_record_first(appliance, record, &fault);
    return iso__appliance_say_fault(appliance, error, &fault);
}

/* The writer keeps the fault, and iso__appliance_tell_door tells it. */
int iso__appliance_note(struct iso_appliance *appliance, const struct iso_audit_record *record)
{
    const int error = iso_audit_writer_post(appliance->log, record, NULL);
    iso__appliance_tell_door(appliance);
    return error;
}

/* A record that was in time by the clock of the wait may have come too late by the one that counts
 * on during a suspension. */
int iso__appliance_record_grant(struct iso_appliance *appliance,
                                const struct iso_audit_record *record, struct iso_fault *fault)
{
    static const int64_t wait_ns = ISO_GRANT_WAIT_MS * ISO_NS_PER_MS;
    const struct iso_times *times = &appliance->borrowed.times;
    const int64_t begin_ns = iso_times_boot_ns(times);
    struct iso_fault own = {.text = ""};
    int error = iso_audit_writer_append(appliance->log, record, wait_ns, NULL, &own);
    iso__appliance_note_storage(appliance, error, &own);
    const int64_t took_ns = iso_times_boot_ns(times) - begin_ns;
    if (!error && took_ns > wait_ns) {
        error = iso_fault_set_code(&own, ISO_FAULT_LOG_LATE, -ETIMEDOUT,
                                   "the record took %lld ms to get to the disk",
                                   (long long)(took_ns / ISO_NS_PER_MS));
    }
    if (error) {
        (void)iso_fault_set_code(fault, own.code, error, "%s", own.text);
    }
    return iso__appliance_say_fault(appliance, error, &own);
}

struct iso_audit_writer *iso_appliance_log(const struct iso_appliance *appliance)
{
    return appliance->log;
}

/* ---- the sensor ---- */

const char *iso__appliance_sensor_state(const struct iso_appliance *appliance)
{
    if (!appliance->supervisor.sensor) {
        return "lost";
    }
    return !appliance->supervisor.sees ? "silent"
           : appliance->repeats.stuck  ? "repeats"
                                       : "started";
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
    iso_sensor_supervisor_init(&appliance->supervisor, &options, &appliance->borrowed.sensor,
                               now_ns);
}

static void on_sensor_gone(struct iso_appliance *appliance)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = "lost";
    record.note = appliance->supervisor.fault.text;
    (void)iso__appliance_say_fault(appliance, appliance->supervisor.error,
                                   &appliance->supervisor.fault);
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_action_disconnect(appliance);
}

static void on_sensor_back(struct iso_appliance *appliance)
{
    struct iso_audit_record record = iso_audit_record_of("sensor");
    record.reason = "started";
    iso__appliance_repeat_reset(appliance);
    iso__appliance_say(appliance, LOG_NOTICE, "sensor %s started",
                       iso_sensor_name(appliance->supervisor.sensor));
    (void)iso__appliance_note(appliance, &record);
    iso__appliance_stale_sensor(appliance);
}

/* The safe state and its end: whoever was before the camera may be another by now, and what was
 * decided of the one before is forgotten. A client's action goes on if the camera does. */
static void follow_sight(struct iso_appliance *appliance)
{
    const struct iso_sensor_supervisor *supervisor = &appliance->supervisor;
    if (supervisor->sees == !appliance->blind) {
        return;
    }
    appliance->blind = !supervisor->sees;
    if (appliance->blind) {
        iso_decision_reset(&appliance->decision);
        iso_track_reset(&appliance->track);
        if (supervisor->sensor) {
            struct iso_audit_record record = iso_audit_record_of("sensor");
            record.reason = "silent";
            record.note = supervisor->fault.text;
            iso__appliance_warn(appliance, &supervisor->fault);
            (void)iso__appliance_note(appliance, &record);
        }
    }
    iso_door_guard_set_fault(appliance->door, appliance->blind);
    iso__appliance_tell_door(appliance);
}

/* ---- start, step, stop ---- */

int iso_appliance_new(const struct iso_appliance_borrowed *borrowed, struct iso_appliance **out)
{
    struct iso_appliance *appliance = calloc(1, sizeof *appliance);
    if (!appliance) {
        return -ENOMEM;
    }
    const struct iso_frame_memory_options memory = iso_frame_memory_options_default();
    iso_thread_mutex_init(&appliance->recorded_mutex);
    appliance->borrowed = *borrowed;
    appliance->ended = ISO_APPLIANCE_CLAIMED;
    int error = iso_frame_memory_new(&memory, &appliance->shown) ? -ENOMEM : 0;
    error = error ? error
                  : iso_audit_writer_new(borrowed->audit, &appliance->borrowed.times,
                                         borrowed->threads, &appliance->log);
    error = error ? error : iso__appliance_new_door(appliance);
    if (error) {
        iso_appliance_free(appliance);
        return error;
    }
    *out = appliance;
    return 0;
}

void iso_appliance_free(struct iso_appliance *appliance)
{
    if (appliance) {
        iso__appliance_free_door(appliance); /* its thread posts records */
        iso_audit_writer_free(appliance->log);
        iso_sensor_supervisor_done(&appliance->supervisor);
        iso_enrolment_wipe(&appliance->enrolment);
        iso_frame_memory_free(appliance->shown);
        (void)pthread_mutex_destroy(&appliance->recorded_mutex);
        explicit_bzero(appliance, sizeof *appliance); /* the frame worked on last */
        free(appliance);
    }
}

/* An attempt is over when nobody could still be in the middle of it. */
static const int64_t attack_longest_ns = 60 * ISO_NS_PER_S;

/* What is not to be looked at needs more than is ever held. */
static void init_liveness(struct iso_appliance *appliance)
{
    const struct iso_config_motion *motion = &appliance->borrowed.config->motion;
    struct iso_liveness_options options = iso_liveness_options_default();
    options.still_ns = motion->lifeless_ms > 0 ? motion->lifeless_ms * ISO_NS_PER_MS : INT64_MAX;
    options.frozen_frames = motion->frozen_frames > 0 ? motion->frozen_frames : INT_MAX;
    iso_liveness_init(&options, &appliance->liveness);
}

static void init_watch(struct iso_appliance *appliance)
{
    const struct iso_config *config = appliance->borrowed.config;
    const struct iso_decision_options decision = iso__appliance_decision_options(config);
    const struct iso_track_options track = {
        .lost_ns = decision.gap_ns,
        .jump_mm_s = config->motion.jump_mm_s,
        .jump_rad_s = config->motion.jump_deg_s * ISO_RAD_PER_DEG,
        .still_mm_s = config->motion.still_mm_s,
        .still_rad_s = config->motion.still_deg_s * ISO_RAD_PER_DEG,
    };
    const struct iso_hint_options hints = {
        .hold = config->hint.hold_frames,
        .interval_ns = config->hint.interval_ms * ISO_NS_PER_MS,
    };
    iso_decision_init(&appliance->decision, &decision);
    iso_track_init(&appliance->track, &track);
    init_liveness(appliance);
    iso_hint_filter_init(&appliance->hints, &hints);
    iso_attack_tally_init(&appliance->attacks, decision.refractory_ns, attack_longest_ns);
}

void iso__appliance_record_gallery(struct iso_appliance *appliance, const char *event,
                                   const char *note)
{
    const struct iso_gallery_version version = iso_gallery_version(appliance->borrowed.gallery);
    struct iso_audit_record record = iso_audit_record_of(event);
    record.gallery = version.gallery;
    record.gallery_changes = version.changes;
    record.note = note;
    (void)iso__appliance_record(appliance, &record);
}

/* Nobody is named: that goes to a log which is not sealed. */
static void tell_unusable(struct iso_appliance *appliance)
{
    size_t n = 0, unusable = 0;
    const struct iso_person *people = iso_gallery_people(appliance->borrowed.gallery, &n);
    for (size_t i = 0; i < n; i++) {
        unusable += people[i].usable == 0;
    }
    if (unusable > 0) {
        iso__appliance_say(appliance, LOG_WARNING,
                           "%zu of %zu people have templates of another algorithm only and are "
                           "not recognised until they are enrolled anew",
                           unusable, n);
    }
}

/* Nobody is named here, either. */
static void tell_same_names(struct iso_appliance *appliance)
{
    const size_t n = iso_gallery_same_names(appliance->borrowed.gallery);
    if (n > 0) {
        iso__appliance_say(appliance, LOG_WARNING,
                           "names of enrolled people that look like another's: %zu; isotherm list "
                           "names them, give one of each pair another name (isotherm rename)",
                           n);
    }
}

/* The first try to open the sensor: whether its configuration is one that can ever work. */
static int first_look(struct iso_appliance *appliance, int64_t now_ns, struct iso_fault *fault)
{
    const struct iso_frame *frame;
    const struct iso_sensor_supervisor *supervisor = &appliance->supervisor;
    init_sensor(appliance, now_ns);
    if (iso_sensor_supervisor_look(&appliance->supervisor, now_ns, &frame) == ISO_SENSOR_BACK) {
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

static void tell_image_check(struct iso_appliance *appliance)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const char *word = iso_appliance_status(appliance).image_check;
    if (strcmp(word, "absent") == 0) {
        const char *lacks = pipeline->ops->image_lacks ? pipeline->ops->image_lacks(pipeline->self)
                                                       : "what that needs is missing";
        iso__appliance_say(appliance, LOG_WARNING, "images are not checked for faces: %s", lacks);
    }
}

int iso_appliance_start(struct iso_appliance *appliance, struct iso_fault *fault)
{
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    appliance->start_ns = now_ns;
    appliance->gallery_retry_ns = ISO_NEVER_NS;
    appliance->look_due_ns = ISO_NEVER_NS;
    init_watch(appliance);
    iso_suspension_init(&appliance->suspension, &appliance->borrowed.times);
    int error = iso__appliance_start_door(appliance, fault); /* first: it does not need the disk */
    if (error) {
        return error;
    }
    iso__appliance_record_gallery(appliance, "start", ISOTHERM_VERSION);
    iso__appliance_record_door(appliance);
    iso__appliance_unlearn(appliance);
    tell_unusable(appliance);
    tell_same_names(appliance);
    iso__appliance_start_lockout(appliance);
    tell_image_check(appliance);
    error = first_look(appliance, iso_times_now_ns(&appliance->borrowed.times), fault);
    iso__appliance_tell_door(appliance);
    return error;
}

/* Who was there before the machine was suspended is not there any more. */
static void follow_suspension(struct iso_appliance *appliance)
{
    if (iso_suspension_look(&appliance->suspension, &appliance->borrowed.times)) {
        iso_decision_reset(&appliance->decision);
        iso_track_reset(&appliance->track);
    }
}

/* A step that comes so much later than it was due was held up by something else than the sensor: by
 * the disk, by a frame that took long, or by other work of the machine. */
static const int64_t stall_ns = 50 * ISO_NS_PER_MS;

static void excuse_stall(struct iso_appliance *appliance, int64_t now_ns)
{
    const int64_t due_ns = appliance->look_due_ns;
    if (due_ns != ISO_NEVER_NS && now_ns - due_ns >= stall_ns) {
        iso_sensor_supervisor_excuse(&appliance->supervisor, now_ns - due_ns, now_ns);
    }
}

/* The time that a driver takes in the look itself is the sensor's. */
static void note_next_look(struct iso_appliance *appliance)
{
    const int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    const int64_t due_ns = iso_sensor_supervisor_due_ns(&appliance->supervisor, now_ns);
    appliance->look_due_ns = due_ns > now_ns ? due_ns : now_ns;
}

static void look_at_sensor(struct iso_appliance *appliance, int64_t now_ns)
{
    const struct iso_frame *frame = NULL;
    excuse_stall(appliance, now_ns);
    const enum iso_sensor_news news = iso_sensor_supervisor_look(&appliance->supervisor, now_ns,
                                                                 &frame);
    note_next_look(appliance);
    follow_sight(appliance); /* before what was seen now is looked at */
    switch (news) {
    case ISO_SENSOR_FRAME:
        iso__appliance_frame(appliance, frame, now_ns);
        break;
    case ISO_SENSOR_QUIET:
        /* Nothing has been seen until now: who was there has left, perhaps. */
        iso__appliance_time(appliance, now_ns);
        break;
    case ISO_SENSOR_FLAW:
        iso__appliance_complain(appliance, &appliance->supervisor.fault);
        break;
    case ISO_SENSOR_BACK:
        on_sensor_back(appliance);
        break;
    case ISO_SENSOR_GONE:
        on_sensor_gone(appliance);
        break;
    }
}

static int64_t earliest(int64_t a, int64_t b)
{
    return a < b ? a : b;
}

/* By the clock that the steps go by; the door has the one that counts during a suspension. */
static int64_t door_due_ns(const struct iso_appliance *appliance)
{
    const int64_t due_ns = iso_door_guard_due_ns(appliance->door);
    return due_ns == ISO_NEVER_NS ? due_ns : due_ns - appliance->suspension.asleep_ns;
}

int64_t iso_appliance_step(struct iso_appliance *appliance)
{
    follow_suspension(appliance);
    int64_t now_ns = iso_times_now_ns(&appliance->borrowed.times);
    iso_door_guard_step(appliance->door);
    iso__appliance_tell_door(appliance);
    look_at_sensor(appliance, now_ns);
    now_ns = iso_times_now_ns(&appliance->borrowed.times);
    iso__appliance_lockout_time(appliance, now_ns);
    iso__appliance_clock_time(appliance);
    iso__appliance_storage_time(appliance, now_ns);
    iso__appliance_counter_time(appliance, now_ns);
    iso__appliance_action_deadline(appliance, now_ns);
    iso__appliance_picture_time(appliance, now_ns);
    const int64_t lines_ns = earliest(door_due_ns(appliance),
                                      iso_sensor_supervisor_due_ns(&appliance->supervisor, now_ns));
    return earliest(earliest(lines_ns, iso__appliance_door_events_due_ns(appliance)),
                    iso__appliance_due_ns(appliance));
}

void iso_appliance_stop(struct iso_appliance *appliance)
{
    const struct iso_audit_record record = iso_audit_record_of("stop");
    iso_door_guard_stop(appliance->door);
    iso__appliance_tell_door(appliance);
    iso__appliance_flush_door(appliance);
    iso_sensor_supervisor_done(&appliance->supervisor);
    iso__appliance_end_attack(appliance);
    (void)iso__appliance_note(appliance, &record);
}

/* ---- what is known of it ---- */

int iso_appliance_sensor_fd(const struct iso_appliance *appliance)
{
    return appliance->supervisor.sensor ? iso_sensor_poll_fd(appliance->supervisor.sensor)
                                        : -ENODEV;
}

int iso_appliance_door_fd(const struct iso_appliance *appliance)
{
    return iso_door_guard_fd(appliance->door);
}

uint64_t iso_appliance_progress(const struct iso_appliance *appliance)
{
    return appliance->supervisor.progress;
}

void iso_appliance_aim(struct iso_appliance *appliance, bool on)
{
    appliance->aimed = on;
    /* Whoever begins to aim sees the next frame at once, however short ago another one was told. */
    appliance->view_told_ns = iso_times_now_ns(&appliance->borrowed.times) - ISO_NS_PER_S;
}

bool iso_appliance_is_aimed(const struct iso_appliance *appliance)
{
    return appliance->aimed;
}

struct iso_appliance_status iso_appliance_status(const struct iso_appliance *appliance)
{
    const struct iso_pipeline *pipeline = &appliance->borrowed.pipeline;
    const struct iso_sensor *sensor = appliance->supervisor.sensor;
    const struct iso_door_look door = iso_door_guard_look(appliance->door);
    struct iso_appliance_status status = {
        .mode = appliance->mode,
        .door = door.state,
        .door_ordinary = door.ordinary,
        .sensor_state = iso__appliance_sensor_state(appliance),
        .sensor_model = appliance->supervisor.model,
        .sensor_calibration = appliance->supervisor.calibration,
        .sensor_fault = appliance->supervisor.fault.text,
        .sensor_fault_code = appliance->supervisor.fault.code,
        .sensor_calibration_code = appliance->supervisor.calibration_code,
        .clock_fault = appliance->clock_fault.text,
        .clock_fault_code = iso__appliance_clock_code(appliance),
        .stale_fault = appliance->stale_fault.text,
        .stale_fault_code = appliance->stale_fault.code,
        .storage_fault = iso__appliance_storage_fault(appliance)->text,
        .storage_fault_code = iso__appliance_storage_fault(appliance)->code,
        .counter_fault = appliance->counter_fault.text,
        .counter_fault_code = appliance->counter_fault.code,
        .last_outcome = appliance->last_outcome,
        .view = appliance->has_view ? &appliance->view : NULL,
        .counts = appliance->counts,
        .lockdown = appliance->lockout.lockdown,
        .lockout_ns = iso_lockout_remaining_ns(&appliance->lockout,
                                               iso_times_now_ns(&appliance->borrowed.times)),
        .image_check = pipeline->ops->image_check ? pipeline->ops->image_check(pipeline->self)
                                                  : "off",
        .frames = appliance->supervisor.frames,
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
