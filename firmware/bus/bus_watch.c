/* The methods Watch and WatchRelief, and the records of their streams. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "firmware/bus/bus_state.h"
#include "firmware/contract/contract.h"
#include "firmware/stream/silhouette.h"

/* ---- the methods ---- */

/* The relief shows the shape of a face: it is for the client that has the claim, and recorded. */
static int allow_relief(const struct iso_bus *bus, sd_bus_message *call, sd_bus_error *out)
{
    struct iso_fault fault = {.text = ""};
    const int r = iso__bus_require_claim(bus, call, out);
    if (r < 0) {
        return r;
    }
    const int error = iso_appliance_record_relief(bus->appliance, &fault);
    return error ? iso__bus_refuse(out, error, &fault) : 0;
}

/* Selects the points of the mean head when they are needed first. */
static void prepare_head(struct iso_bus *bus)
{
    const struct iso_pipeline *pipeline = &bus->borrowed->pipeline;
    if (bus->head.n == 0 && pipeline->ops->head) {
        iso_head_outline_init(&bus->head, pipeline->ops->head(pipeline->self));
    }
}

static int reply_stream(struct iso_bus *bus, sd_bus_message *call, enum iso_stream_kind kind,
                        sd_bus_error *out)
{
    struct iso_fault fault = {.text = ""};
    uid_t user = 0;
    int r = iso__bus_user_of(call, &user);
    if (r < 0) {
        return r;
    }
    const int fd = iso_stream_list_add(&bus->streams, kind, user, &fault);
    if (fd < 0) {
        return iso__bus_refuse(out, fd, &fault);
    }
    prepare_head(bus);
    iso_appliance_report_frames(bus->appliance, true);
    r = sd_bus_reply_method_return(call, "h", fd);
    (void)close(fd);
    return r;
}

int iso__bus_watch(sd_bus_message *call, void *context, sd_bus_error *out)
{
    const char *what = NULL;
    const int r = sd_bus_message_read(call, "s", &what);
    if (r < 0) {
        return r;
    }
    return strcmp(what, ISO_CONTRACT_WATCH_OUTLINE) == 0
               ? reply_stream(context, call, ISO_STREAM_OUTLINE, out)
               : sd_bus_error_setf(out, SD_BUS_ERROR_INVALID_ARGS,
                                   "there is no stream '%s'; there is '%s'", what,
                                   ISO_CONTRACT_WATCH_OUTLINE);
}

int iso__bus_watch_relief(sd_bus_message *call, void *context, sd_bus_error *out)
{
    struct iso_bus *bus = context;
    const int r = allow_relief(bus, call, out);
    return r < 0 ? r : reply_stream(bus, call, ISO_STREAM_RELIEF, out);
}

void iso__bus_end_relief(struct iso_bus *bus)
{
    iso_stream_list_end(&bus->streams, ISO_STREAM_RELIEF);
}

/* ---- the records ---- */

static struct iso_stream_head head_of(const struct iso_bus *bus, const struct iso_seen_frame *seen)
{
    return (struct iso_stream_head){.sequence = bus->frames_seen, .t_ns = seen->frame->t_ns};
}

static void send_outline(struct iso_bus *bus, const struct iso_seen_frame *seen)
{
    uint8_t bytes[ISO_OUTLINE_BYTES];
    struct iso_outline_record record = {
        .head = head_of(bus, seen),
        .distance_mm = (uint16_t)lround(fmax(0.0, fmin(65535.0, seen->distance_mm))),
        .lockdown = seen->lockdown,
        .locked_out = seen->locked_out,
    };
    (void)snprintf(record.mode, sizeof record.mode, "%s", iso_appliance_mode_name(seen->mode));
    (void)snprintf(record.hint, sizeof record.hint, "%s", iso_capture_name(seen->hint));
    (void)snprintf(record.verdict, sizeof record.verdict, "%s", seen->verdict);
    (void)snprintf(record.reason, sizeof record.reason, "%s", seen->reason);
    if (seen->camera_from_face) {
        record.n_points = iso_head_outline_project(&bus->head, seen->camera_from_face, seen->frame,
                                                   record.outline);
    }
    iso_silhouette_draw(seen->frame, record.outline, record.n_points, record.silhouette);
    iso_stream_list_send(&bus->streams, ISO_STREAM_OUTLINE, bytes,
                         iso_outline_record_write(&record, bytes));
}

/* Both buffers show the shape of a face. */
static void send_relief(struct iso_bus *bus, const struct iso_seen_frame *seen)
{
    struct iso__bus_relief *relief = &bus->relief;
    relief->record.head = head_of(bus, seen);
    iso_relief_sample(seen->frame, &relief->record);
    iso_stream_list_send(&bus->streams, ISO_STREAM_RELIEF, relief->bytes,
                         iso_relief_record_write(&relief->record, relief->bytes));
    explicit_bzero(relief, sizeof *relief);
}

void iso__bus_on_seen(void *context, const struct iso_seen_frame *seen)
{
    struct iso_bus *bus = context;
    bus->frames_seen++;
    if (iso_stream_list_has(&bus->streams, ISO_STREAM_OUTLINE)) {
        send_outline(bus, seen);
    }
    if (iso_stream_list_has(&bus->streams, ISO_STREAM_RELIEF)) {
        send_relief(bus, seen);
    }
    iso_appliance_report_frames(bus->appliance, bus->streams.n > 0);
}
