#include "firmware/appliance/sensor_keeper.h"

#include <errno.h>
#include <stdio.h>

#include "drivers/base/times.h"

/* For a back end that neither blocks nor says when it has something. */
enum { LOOK_NS = 5 * ISO_NS_PER_MS };

void iso_sensor_keeper_init(struct iso_sensor_keeper *keeper,
                            const struct iso_sensor_keeper_options *options,
                            const struct iso_sensor_source *source, int64_t now_ns)
{
    *keeper = (struct iso_sensor_keeper){
        .options = *options,
        .source = *source,
        .try_ns = now_ns,
        .wait_ns = options->retry_ns,
        .sees = true,
    };
}

static void note_fault(struct iso_sensor_keeper *keeper, int error, const struct iso_fault *fault)
{
    keeper->error = error;
    keeper->fault = *fault;
    if (!fault->text[0]) {
        (void)iso_fault_set_code(&keeper->fault, ISO_FAULT_SENSOR_FAILED, error,
                                 "sensor: failed without a reason");
    }
}

static void close_sensor(struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    iso_sensor_close(keeper->sensor);
    keeper->sensor = NULL;
    keeper->sees = false;
    keeper->try_ns = now_ns + keeper->wait_ns;
    keeper->wait_ns *= 2;
    if (keeper->wait_ns > keeper->options.retry_max_ns) {
        keeper->wait_ns = keeper->options.retry_max_ns;
    }
}

/* A try that comes to an end, well or not, is a sign that the program lives: a sensor that is
 * unplugged is no reason for the watchdog to kill a door that is in its safe state. */
static enum iso_sensor_news try_to_open(struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    keeper->progress++;
    int error = keeper->source.open(keeper->source.context, &keeper->sensor, &fault);
    if (error) {
        keeper->sensor = NULL;
    } else {
        error = iso_sensor_start(keeper->sensor, &fault);
    }
    if (error) {
        note_fault(keeper, error, &fault);
        close_sensor(keeper, now_ns);
        return ISO_SENSOR_FLAW;
    }
    keeper->heard_ns = keeper->seen_ns = now_ns;
    return ISO_SENSOR_BACK;
}

/* What was there at t_ns is known. */
static void sign_of_sight(struct iso_sensor_keeper *keeper, int64_t t_ns)
{
    keeper->seen_ns = t_ns;
    keeper->sees = true;
}

/* Nothing of any use has come. Returns true if it has become too long just now. */
static bool loses_sight(struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    if (!keeper->sees || now_ns - keeper->seen_ns < keeper->options.pause_ns) {
        return false;
    }
    keeper->sees = false;
    return true;
}

/* The same; it is the fault. */
static void doubt_sight(struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    struct iso_fault fault;
    if (loses_sight(keeper, now_ns)) {
        note_fault(keeper,
                   iso_fault_set_code(&fault, ISO_FAULT_SENSOR_SILENT, -ETIMEDOUT,
                                      "sensor %s: nothing seen for %lld ms",
                                      iso_sensor_name(keeper->sensor),
                                      (long long)((now_ns - keeper->seen_ns) / ISO_NS_PER_MS)),
                   &fault);
    }
}

static void sign_of_life(struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    keeper->progress++;
    keeper->heard_ns = now_ns;
    keeper->wait_ns = keeper->options.retry_ns;
}

/* The back end had nothing. Whether that is a sign of life, or silence. */
static enum iso_sensor_news note_nothing(struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    int64_t due_ns;
    if (iso_sensor_next_due_ns(keeper->sensor, &due_ns) == 0) {
        sign_of_life(keeper, now_ns);
        sign_of_sight(keeper, now_ns);
        return ISO_SENSOR_QUIET;
    }
    if (now_ns - keeper->heard_ns < keeper->options.silence_ns) {
        doubt_sight(keeper, now_ns);
        return ISO_SENSOR_QUIET;
    }
    struct iso_fault fault;
    note_fault(keeper,
               iso_fault_set_code(&fault, ISO_FAULT_SENSOR_SILENT, -EIO,
                                  "sensor %s: no frame for %lld ms",
                                  iso_sensor_name(keeper->sensor),
                                  (long long)((now_ns - keeper->heard_ns) / ISO_NS_PER_MS)),
               &fault);
    close_sensor(keeper, now_ns);
    return ISO_SENSOR_GONE;
}

/* A frame shows what was there when it was exposed, not when it comes. */
static void note_sight(struct iso_sensor_keeper *keeper, int64_t t_ns, int64_t now_ns)
{
    const int64_t age_ns = now_ns - t_ns;
    if (age_ns < keeper->options.stale_ns && age_ns < keeper->options.pause_ns) {
        sign_of_sight(keeper, t_ns);
    } else {
        doubt_sight(keeper, now_ns);
    }
}

enum iso_sensor_news iso_sensor_keeper_look(struct iso_sensor_keeper *keeper, int64_t now_ns,
                                            const struct iso_frame **frame)
{
    struct iso_fault fault = {.text = ""};
    if (!keeper->sensor) {
        return now_ns >= keeper->try_ns ? try_to_open(keeper, now_ns) : ISO_SENSOR_QUIET;
    }
    const int error = iso_sensor_wait(keeper->sensor, now_ns, frame, &fault);
    if (error == -ETIMEDOUT) {
        return note_nothing(keeper, now_ns);
    }
    if (error == 0) {
        struct iso_sensor_description description;
        sign_of_life(keeper, now_ns);
        note_sight(keeper, (*frame)->t_ns, now_ns);
        keeper->frames++;
        if (iso_sensor_describe(keeper->sensor, &description) == 0) {
            (void)snprintf(keeper->model, sizeof keeper->model, "%s", description.model);
            (void)snprintf(keeper->calibration, sizeof keeper->calibration, "%s",
                           description.calibration);
            keeper->calibration_code = description.calibration_code;
            keeper->repeats = description.repeats;
        }
        return ISO_SENSOR_FRAME;
    }
    note_fault(keeper, error, &fault);
    if (error == -EBADMSG) {
        keeper->heard_ns = now_ns;
        (void)loses_sight(keeper, now_ns);
        return ISO_SENSOR_FLAW;
    }
    close_sensor(keeper, now_ns);
    return ISO_SENSOR_GONE;
}

static int64_t later_by(int64_t t_ns, int64_t by_ns, int64_t now_ns)
{
    return t_ns + by_ns < now_ns ? t_ns + by_ns : now_ns;
}

void iso_sensor_keeper_excuse(struct iso_sensor_keeper *keeper, int64_t held_up_ns, int64_t now_ns)
{
    if (keeper->sensor) {
        keeper->heard_ns = later_by(keeper->heard_ns, held_up_ns, now_ns);
        keeper->seen_ns = later_by(keeper->seen_ns, held_up_ns, now_ns);
    }
}

int64_t iso_sensor_keeper_due_ns(const struct iso_sensor_keeper *keeper, int64_t now_ns)
{
    int64_t due_ns;
    if (!keeper->sensor) {
        return keeper->try_ns;
    }
    return iso_sensor_next_due_ns(keeper->sensor, &due_ns) == 0 ? due_ns : now_ns + LOOK_NS;
}

void iso_sensor_keeper_done(struct iso_sensor_keeper *keeper)
{
    iso_sensor_close(keeper->sensor);
    keeper->sensor = NULL;
}
