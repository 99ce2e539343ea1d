/* What the door tells of its image, and its orders of parts of an update. */
#include <errno.h>
#include <string.h>

#include "firmware/fleet/door/fleet_state.h"

void iso__fleet_write_update(const struct iso_fleet *fleet, struct iso_json_line *line)
{
    const struct iso_fleet_update_report *report = &fleet->update;
    static const struct iso_fleet_id none;
    char text[ISO_FLEET_ID_TEXT_SIZE];
    if (!report->is_known) {
        return;
    }
    iso_json_line_string(line, ISO_FLEET_UPDATE_STATE, iso_fleet_update_state_word(report->state));
    iso_json_line_string(line, ISO_FLEET_UPDATE_ROLLOUT,
                         iso_fleet_id_is_same(&report->rollout, &none)
                             ? ""
                             : iso_fleet_id_text(&report->rollout, text));
    iso_json_line_string(line, ISO_FLEET_UPDATE_VERSION, report->version);
    iso_json_line_string(line, ISO_FLEET_UPDATE_BOARD, report->board);
    iso_json_line_string(line, ISO_FLEET_UPDATE_FAULT, report->fault);
}

static bool is_word(const char *text)
{
    return !*text || iso_fleet_update_word_is_good(text);
}

int iso_fleet_set_update(struct iso_fleet *fleet, const struct iso_fleet_update_report *report,
                         bool *busy, struct iso_fault *fault)
{
    const struct iso_fleet_host *host = &fleet->options.host;
    const int error = iso__fleet_ready(fleet, fault);
    if (error) {
        return error;
    }
    if (!is_word(report->version) || !is_word(report->board) || strchr(report->fault, '\n')) {
        return iso_fault_set(fault, -EINVAL, "the version, the board or the fault is none");
    }
    fleet->update = *report;
    /* A door that waits for its restart has nothing else to be busy for. */
    *busy = (host->busy && host->busy(host->context)) ||
            (report->state == ISO_FLEET_UPDATE_INSTALLED && host->may_restart &&
             !host->may_restart(host->context));
    return 0;
}

int iso_fleet_fetch_update(struct iso_fleet *fleet, const struct iso_fleet_id *rollout,
                           uint64_t after, struct iso_fleet_bytes *out, struct iso_fault *fault)
{
    struct iso_fleet_fetch fetch = {
        .zone = *rollout, .after = after, .what = ISO_FLEET_WANT_UPDATE};
    const int error = iso__fleet_ready(fleet, fault);
    return error ? error : iso__fleet_sign_fetch(fleet, &fetch, out, fault);
}
