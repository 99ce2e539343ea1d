#include "firmware/sensor/sensor_supervisor.h"

#include <errno.h>
#include <stdio.h>

#include "drivers/base/times.h"

/* The interval of looks at a back end that has neither a descriptor nor next_due_ns, and so cannot
 * tell when it has something. */
enum { LOOK_NS = 5 * ISO_NS_PER_MS };

/* The same while few frames are wanted. */
enum { SELDOM_LOOK_NS = 20 * ISO_NS_PER_MS };

/* The interval of looks at a back end with a descriptor, although the descriptor wakes up the
 * caller. A caller that comes later was held up, and reports this by iso_sensor_supervisor_excuse.
 * Without such an interval it could not tell a stall of its own from a sensor that has nothing. For
 * a camera of 30 frames a second the interval never ends, because its frames come sooner. */
enum { BEAT_NS = 50 * ISO_NS_PER_MS };

void iso_sensor_supervisor_init(struct iso_sensor_supervisor *supervisor,
                                const struct iso_sensor_supervisor_options *options,
                                const struct iso_sensor_source *source, int64_t now_ns)
{
    *supervisor = (struct iso_sensor_supervisor){
        .options = *options,
        .source = *source,
        .try_ns = now_ns,
        .wait_ns = options->retry_ns,
        .sees = true,
    };
}

static void note_fault(struct iso_sensor_supervisor *supervisor, int error,
                       const struct iso_fault *fault)
{
    supervisor->error = error;
    supervisor->fault = *fault;
    if (!fault->text[0]) {
        (void)iso_fault_set_code(&supervisor->fault, ISO_FAULT_SENSOR_FAILED, error,
                                 "sensor: failed and gave no reason");
    }
}

static void close_sensor(struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    iso_sensor_close(supervisor->sensor);
    supervisor->sensor = NULL;
    supervisor->sees = false;
    supervisor->try_ns = now_ns + supervisor->wait_ns;
    supervisor->wait_ns *= 2;
    if (supervisor->wait_ns > supervisor->options.retry_max_ns) {
        supervisor->wait_ns = supervisor->options.retry_max_ns;
    }
}

/* An attempt that ends, with success or not, is a sign that the program lives: a sensor that is
 * unplugged is no reason for the watchdog to kill a door that is in its safe state. */
static enum iso_sensor_news try_to_open(struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    supervisor->progress++;
    int error = supervisor->source.open(supervisor->source.context, &supervisor->sensor, &fault);
    if (error) {
        supervisor->sensor = NULL;
    } else {
        error = iso_sensor_start(supervisor->sensor, &fault);
    }
    if (error) {
        note_fault(supervisor, error, &fault);
        close_sensor(supervisor, now_ns);
        return ISO_SENSOR_FLAW;
    }
    supervisor->heard_ns = supervisor->seen_ns = supervisor->taken_ns = now_ns;
    supervisor->interval_ns = 0;
    return ISO_SENSOR_BACK;
}

/* Notes that the scene was observed at t_ns. */
static void sign_of_sight(struct iso_sensor_supervisor *supervisor, int64_t t_ns)
{
    supervisor->seen_ns = t_ns;
    supervisor->sees = true;
}

/* Called when no usable frame has come. Clears `sees` if the last one is too old. Returns true if
 * it has done so. */
static bool loses_sight(struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    if (!supervisor->sees || now_ns - supervisor->seen_ns < supervisor->options.pause_ns) {
        return false;
    }
    supervisor->sees = false;
    return true;
}

/* Does the same, and notes it as a fault. */
static void doubt_sight(struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    struct iso_fault fault;
    if (loses_sight(supervisor, now_ns)) {
        note_fault(supervisor,
                   iso_fault_set_code(&fault, ISO_FAULT_SENSOR_SILENT, -ETIMEDOUT,
                                      "sensor %s: nothing seen for %lld ms",
                                      iso_sensor_name(supervisor->sensor),
                                      (long long)((now_ns - supervisor->seen_ns) / ISO_NS_PER_MS)),
                   &fault);
    }
}

static void sign_of_life(struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    supervisor->progress++;
    supervisor->heard_ns = now_ns;
    supervisor->wait_ns = supervisor->options.retry_ns;
}

/* Called when the back end has no frame. Decides whether that is a sign of life, or silence. */
static enum iso_sensor_news note_nothing(struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    int64_t due_ns;
    if (iso_sensor_next_due_ns(supervisor->sensor, &due_ns) == 0) {
        sign_of_life(supervisor, now_ns);
        sign_of_sight(supervisor, now_ns);
        return ISO_SENSOR_QUIET;
    }
    if (now_ns - supervisor->heard_ns < supervisor->options.silence_ns) {
        doubt_sight(supervisor, now_ns);
        return ISO_SENSOR_QUIET;
    }
    struct iso_fault fault;
    note_fault(supervisor,
               iso_fault_set_code(&fault, ISO_FAULT_SENSOR_SILENT, -EIO,
                                  "sensor %s: no frame for %lld ms",
                                  iso_sensor_name(supervisor->sensor),
                                  (long long)((now_ns - supervisor->heard_ns) / ISO_NS_PER_MS)),
               &fault);
    close_sensor(supervisor, now_ns);
    return ISO_SENSOR_GONE;
}

/* Notes what a frame shows. It shows the scene at its exposure, and not at its arrival. */
static void note_sight(struct iso_sensor_supervisor *supervisor, int64_t t_ns, int64_t now_ns)
{
    const int64_t age_ns = now_ns - t_ns;
    if (age_ns < supervisor->options.stale_ns && age_ns < supervisor->options.pause_ns) {
        sign_of_sight(supervisor, t_ns);
    } else {
        doubt_sight(supervisor, now_ns);
    }
}

enum iso_sensor_news iso_sensor_supervisor_look(struct iso_sensor_supervisor *supervisor,
                                                int64_t now_ns, const struct iso_frame **frame)
{
    struct iso_fault fault = {.text = ""};
    if (!supervisor->sensor) {
        return now_ns >= supervisor->try_ns ? try_to_open(supervisor, now_ns) : ISO_SENSOR_QUIET;
    }
    const int error = iso_sensor_wait(supervisor->sensor, now_ns, frame, &fault);
    supervisor->found = error == 0;
    if (error == -ETIMEDOUT) {
        return note_nothing(supervisor, now_ns);
    }
    if (error == 0) {
        struct iso_sensor_description description;
        sign_of_life(supervisor, now_ns);
        note_sight(supervisor, (*frame)->t_ns, now_ns);
        supervisor->taken_ns = now_ns;
        supervisor->frames++;
        if (iso_sensor_describe(supervisor->sensor, &description) == 0) {
            (void)snprintf(supervisor->model, sizeof supervisor->model, "%s", description.model);
            (void)snprintf(supervisor->calibration, sizeof supervisor->calibration, "%s",
                           description.calibration);
            supervisor->calibration_code = description.calibration_code;
            supervisor->repeats = description.repeats;
        }
        return ISO_SENSOR_FRAME;
    }
    note_fault(supervisor, error, &fault);
    if (error == -EBADMSG) {
        supervisor->heard_ns = now_ns;
        (void)loses_sight(supervisor, now_ns);
        return ISO_SENSOR_FLAW;
    }
    close_sensor(supervisor, now_ns);
    return ISO_SENSOR_GONE;
}

static int64_t later_by(int64_t t_ns, int64_t by_ns, int64_t now_ns)
{
    return t_ns + by_ns < now_ns ? t_ns + by_ns : now_ns;
}

void iso_sensor_supervisor_excuse(struct iso_sensor_supervisor *supervisor, int64_t held_up_ns,
                                  int64_t now_ns)
{
    if (supervisor->sensor) {
        supervisor->heard_ns = later_by(supervisor->heard_ns, held_up_ns, now_ns);
        supervisor->seen_ns = later_by(supervisor->seen_ns, held_up_ns, now_ns);
    }
}

void iso_sensor_supervisor_set_interval(struct iso_sensor_supervisor *supervisor,
                                        int64_t interval_ns)
{
    if (supervisor->sensor) {
        iso_sensor_set_interval(supervisor->sensor, interval_ns);
        supervisor->interval_ns = interval_ns;
    }
}

/* Whether a frame that comes now would be passed over. */
static bool pauses(const struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    return now_ns - supervisor->taken_ns < supervisor->interval_ns;
}

int iso_sensor_supervisor_fd(const struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    if (!supervisor->sensor) {
        return -ENODEV;
    }
    const int fd = iso_sensor_poll_fd(supervisor->sensor);
    return fd >= 0 && pauses(supervisor, now_ns) ? -EAGAIN : fd;
}

static int64_t earlier_time(int64_t a_ns, int64_t b_ns)
{
    return a_ns < b_ns ? a_ns : b_ns;
}

/* The descriptor is readable when a new frame has come. It may not be readable for a frame that the
 * back end fetched together with the one just taken, so after a frame the next look is due at once.
 */
static int64_t due_with_descriptor(const struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    const struct iso_sensor_supervisor_options *options = &supervisor->options;
    if (supervisor->found) {
        return now_ns;
    }
    int64_t due_ns = earlier_time(now_ns + BEAT_NS, supervisor->heard_ns + options->silence_ns);
    if (supervisor->sees) {
        due_ns = earlier_time(due_ns, supervisor->seen_ns + options->pause_ns);
    }
    return due_ns;
}

int64_t iso_sensor_supervisor_due_ns(const struct iso_sensor_supervisor *supervisor, int64_t now_ns)
{
    int64_t due_ns;
    if (!supervisor->sensor) {
        return supervisor->try_ns;
    }
    if (iso_sensor_next_due_ns(supervisor->sensor, &due_ns) == 0) {
        return due_ns;
    }
    if (pauses(supervisor, now_ns)) {
        return supervisor->taken_ns + supervisor->interval_ns;
    }
    if (iso_sensor_poll_fd(supervisor->sensor) < 0) {
        return now_ns + (supervisor->interval_ns > 0 ? SELDOM_LOOK_NS : LOOK_NS);
    }
    return due_with_descriptor(supervisor, now_ns);
}

void iso_sensor_supervisor_done(struct iso_sensor_supervisor *supervisor)
{
    iso_sensor_close(supervisor->sensor);
    supervisor->sensor = NULL;
}
