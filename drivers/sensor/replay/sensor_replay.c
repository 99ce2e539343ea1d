#include "drivers/sensor/replay/sensor_replay.h"

#include <errno.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/recording/recording.h"

static const char owner[] = "sensor replay";

static const struct iso_option_spec option_specs[] = {
    {.name = "path",
     .kind = ISO_OPTION_PATH,
     .required = true,
     .help = "the directory of a recording, or a symbolic link to one"},
    {.name = "pace",
     .kind = ISO_OPTION_CHOICE,
     .choices = "realtime|asap",
     .standard = "realtime",
     .help = "when frames are due: by their time stamps, or at once"},
    {.name = "loop",
     .kind = ISO_OPTION_SWITCH,
     .standard = "no",
     .help = "whether the first frame follows the last one"},
    {.name = "repeats",
     .kind = ISO_OPTION_SWITCH,
     .standard = "no",
     .help = "whether a stored frame counts more than once within 10 minutes; for tests only"},
    {.name = NULL},
};

enum { LONE_FRAME_INTERVAL_NS = 33333333 }; /* for a loop over one frame: 30 frames a second */

/* What was found at the path. Two equal slots mean that the recording is the same. A link that was
 * replaced has another inode, or at least another time of change. */
struct slot {
    bool there;
    dev_t device;
    ino_t inode;
    struct timespec changed; /* only of a link: a directory changes while it is filled */
    char target[PATH_MAX];   /* only of a link */
};

/* How far a recording has been played. */
struct place {
    size_t next;       /* index of the next frame */
    int64_t origin_ns; /* clock time of the recording's time stamp 0 */
};

struct replay {
    struct iso_clock clock;
    char *path;
    bool realtime, loop, repeats;

    struct slot slot;
    struct iso_recording *recording; /* NULL: there is nothing to play */
    struct iso_frame *frame;         /* has the recording's size */
    struct place place;

    uint64_t sequence;   /* sequence of the next frame */
    int64_t last_ns;     /* t_ns of the last frame */
    int64_t interval_ns; /* at most one frame is wanted in this time; 0: every frame */
};

/* ---- opening and closing ---------------------------------------------------- */

static void close_recording(struct replay *replay)
{
    iso_recording_close(replay->recording);
    iso_frame_free(replay->frame);
    replay->recording = NULL;
    replay->frame = NULL;
}

static void replay_close(void *self)
{
    struct replay *replay = self;
    close_recording(replay);
    free(replay->path);
    free(replay);
}

static int replay_open(const struct iso_option *options, size_t n_options,
                       const struct iso_clock *clock, void **self, struct iso_fault *fault)
{
    const struct iso_option_set set = {option_specs, options, n_options};
    struct replay *replay = calloc(1, sizeof *replay);
    if (!replay) {
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    replay->clock = *clock;
    replay->last_ns = INT64_MIN;
    replay->realtime = iso_option_choice(&set, "pace") == 0;
    replay->loop = iso_option_switch(&set, "loop");
    replay->repeats = iso_option_switch(&set, "repeats");
    replay->path = strdup(iso_option_text(&set, "path"));
    if (!replay->path) {
        replay_close(replay);
        return iso_fault_set(fault, -ENOMEM, "%s: out of memory", owner);
    }
    *self = replay;
    return 0;
}

static int replay_start(void *self, struct iso_fault *fault)
{
    struct replay *replay = self;
    (void)fault;
    close_recording(replay);
    replay->slot = (struct slot){.there = false};
    replay->interval_ns = 0;
    return 0;
}

static int replay_stop(void *self)
{
    close_recording(self);
    return 0;
}

/* ---- the slot --------------------------------------------------------------- */

static int look_at_slot(const char *path, struct slot *slot, struct iso_fault *fault)
{
    struct stat status;
    *slot = (struct slot){.there = false};
    if (lstat(path, &status) != 0) {
        if (errno == ENOENT || errno == ENOTDIR) {
            return 0;
        }
        return iso_fault_set_code(fault, ISO_FAULT_RECORDING_DAMAGED, -EIO, "%s: %m", path);
    }
    if (S_ISLNK(status.st_mode)) {
        const ssize_t length = readlink(path, slot->target, sizeof slot->target - 1);
        if (length < 0) {
            return 0; /* the link was removed in the meantime */
        }
        slot->changed = status.st_ctim;
    }
    slot->there = true;
    slot->device = status.st_dev;
    slot->inode = status.st_ino;
    return 0;
}

static bool slots_equal(const struct slot *a, const struct slot *b)
{
    return a->there == b->there && a->device == b->device && a->inode == b->inode &&
           a->changed.tv_sec == b->changed.tv_sec && a->changed.tv_nsec == b->changed.tv_nsec &&
           strcmp(a->target, b->target) == 0;
}

/* Opens the recording by its resolved name, so that all frames come from one recording even if the
 * link is replaced meanwhile. */
static int load_recording(struct replay *replay, struct iso_fault *fault)
{
    char resolved[PATH_MAX];
    if (!realpath(replay->path, resolved)) {
        return iso_fault_set_code(fault, ISO_FAULT_RECORDING_DAMAGED, -EBADMSG, "%s: %m",
                                  replay->path);
    }
    int error = iso_recording_open(resolved, &replay->recording, fault);
    if (!error) {
        error = iso_recording_frame_new(replay->recording, &replay->frame);
    }
    if (error) {
        close_recording(replay);
        return error == -ENOMEM
                   ? iso_fault_set(fault, error, "%s: out of memory", resolved)
                   : iso_fault_code_default(fault, ISO_FAULT_RECORDING_DAMAGED, -EBADMSG);
    }
    replay->place.next = 0;
    replay->place.origin_ns = iso_clock_now_ns(&replay->clock) -
                              iso_recording_t_ns(replay->recording, 0);
    return 0;
}

/* Checks the slot, and opens the new recording if it has changed. */
static int follow_slot(struct replay *replay, struct iso_fault *fault)
{
    struct slot before, after;
    int error = look_at_slot(replay->path, &before, fault);
    if (error || slots_equal(&before, &replay->slot)) {
        return error;
    }
    close_recording(replay);
    replay->slot = before;
    if (!before.there) {
        return 0;
    }
    error = load_recording(replay, fault);
    if (look_at_slot(replay->path, &after, NULL) || !slots_equal(&before, &after)) {
        /* The link was replaced during the opening, so either recording may have been opened. */
        close_recording(replay);
        error = -EAGAIN;
    }
    if (error == -EAGAIN || error == -ENOMEM) {
        replay->slot = (struct slot){.there = false}; /* the next call checks the slot again */
    }
    return error == -EAGAIN ? 0 : error;
}

/* ---- frames ----------------------------------------------------------------- */

/* Goes from the last frame back to the first, and keeps the time of the recording. */
static void rewind_loop(const struct replay *replay, struct place *place)
{
    const size_t n = iso_recording_frames(replay->recording);
    const int64_t span_ns = iso_recording_t_ns(replay->recording, n - 1) -
                            iso_recording_t_ns(replay->recording, 0);
    const int64_t interval_ns = n > 1 ? span_ns / (int64_t)(n - 1) : LONE_FRAME_INTERVAL_NS;
    place->origin_ns += span_ns + interval_ns;
    place->next = 0;
}

static bool has_next(const struct replay *replay, const struct place *place)
{
    return replay->recording && place->next < iso_recording_frames(replay->recording);
}

static void advance(const struct replay *replay, struct place *place)
{
    place->next++;
    if (replay->loop && !has_next(replay, place)) {
        rewind_loop(replay, place);
    }
}

static int64_t due_ns(const struct replay *replay, const struct place *place, int64_t now_ns)
{
    int64_t due = now_ns;
    if (replay->realtime) {
        due = place->origin_ns + iso_recording_t_ns(replay->recording, place->next);
    }
    return due > replay->last_ns ? due : replay->last_ns + 1;
}

/* A recording that is played at once (`asap`) has no times of its own, so every frame of it is
 * wanted. */
static bool is_slowed(const struct replay *replay)
{
    return replay->realtime && replay->interval_ns > 0 && replay->sequence > 0;
}

/* The place of the next frame that is wanted, or the end. The frames before it are passed over if
 * they are due by until_ns. */
static struct place next_wanted(const struct replay *replay, int64_t until_ns)
{
    struct place place = replay->place;
    const int64_t wanted_ns = replay->last_ns + replay->interval_ns;
    while (is_slowed(replay) && has_next(replay, &place)) {
        const int64_t due = due_ns(replay, &place, until_ns);
        if (due > until_ns || due >= wanted_ns) {
            break;
        }
        advance(replay, &place);
    }
    return place;
}

static void replay_set_interval(void *self, int64_t interval_ns)
{
    ((struct replay *)self)->interval_ns = interval_ns;
}

static int read_next(struct replay *replay, int64_t t_ns, struct iso_fault *fault)
{
    const int error = iso_recording_read(replay->recording, replay->place.next, replay->frame,
                                         fault);
    replay->frame->t_ns = t_ns;
    replay->frame->sequence = replay->sequence;
    replay->last_ns = t_ns;
    replay->sequence++;
    advance(replay, &replay->place);
    return error && error != -ENOMEM
               ? iso_fault_code_default(fault, ISO_FAULT_RECORDING_DAMAGED, -EBADMSG)
               : error;
}

static int replay_wait(void *self, int64_t deadline_ns, const struct iso_frame **frame,
                       struct iso_fault *fault)
{
    struct replay *replay = self;
    (void)deadline_ns; /* this back end never blocks */
    int error = follow_slot(replay, fault);
    if (error) {
        return error;
    }
    const int64_t now_ns = iso_clock_now_ns(&replay->clock);
    replay->place = next_wanted(replay, now_ns);
    if (!has_next(replay, &replay->place)) {
        return -ETIMEDOUT;
    }
    const int64_t t_ns = due_ns(replay, &replay->place, now_ns);
    if (replay->realtime && t_ns > now_ns) {
        return -ETIMEDOUT;
    }
    error = read_next(replay, t_ns, fault);
    if (!error) {
        *frame = replay->frame;
    }
    return error;
}

static int replay_next_due_ns(void *self, int64_t *out)
{
    const struct replay *replay = self;
    const int64_t now_ns = iso_clock_now_ns(&replay->clock);
    const int64_t look_ms = is_slowed(replay) ? ISO_SENSOR_REPLAY_SELDOM_LOOK_MS
                                              : ISO_SENSOR_REPLAY_LOOK_MS;
    const int64_t look_ns = now_ns + look_ms * INT64_C(1000000);
    const struct place place = next_wanted(replay, look_ns);
    const int64_t due = has_next(replay, &place) ? due_ns(replay, &place, now_ns) : look_ns;
    *out = due < look_ns ? due : look_ns;
    return 0;
}

static int replay_describe(void *self, struct iso_sensor_description *out)
{
    const struct replay *replay = self;
    if (!replay->recording) {
        return -ENODATA;
    }
    const struct iso_recording_meta *meta = iso_recording_meta(replay->recording);
    *out = (struct iso_sensor_description){
        .width_px = meta->camera.width_px,
        .height_px = meta->camera.height_px,
        .intensity = iso_recording_has_intensity(replay->recording),
        .unit_mm = meta->unit_mm,
        .repeats = replay->repeats,
    };
    (void)snprintf(out->model, sizeof out->model, "%s", meta->sensor);
    return 0;
}

/* An empty slot is not an error of wait, because recordings come and go. But the path may also be
 * wrong, so it is reported here. */
static void replay_health(void *self, struct iso_sensor_device_health *out)
{
    const struct replay *replay = self;
    if (!replay->slot.there) {
        (void)snprintf(out->state, sizeof out->state, "there is no recording at its path");
        out->code = ISO_FAULT_RECORDING_MISSING;
    } else if (replay->repeats) {
        (void)snprintf(out->state, sizeof out->state,
                       "stored frames may count more than once (repeats = yes)");
        out->code = ISO_FAULT_RECORDING_REPEATS;
    }
}

const struct iso_sensor_ops iso_sensor_replay_ops = {
    .name = "replay",
    .options = option_specs,
    .open = replay_open,
    .start = replay_start,
    .wait = replay_wait,
    .next_due_ns = replay_next_due_ns,
    .set_interval = replay_set_interval,
    .describe = replay_describe,
    .health = replay_health,
    .stop = replay_stop,
    .close = replay_close,
};
