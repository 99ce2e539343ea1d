#include "firmware/fleet/program/figures.h"

#include <inttypes.h>
#include <jansson.h>
#include <limits.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

static const char standard_folder[] = "/run/isotherm-link", name[] = "figures.json";

/* What is kept of a report. */
static const struct {
    const char *member;
    size_t at;
} members[] = {
    {"deltas", offsetof(struct link_report, deltas)},
    {"snapshots", offsetof(struct link_report, snapshots)},
    {"failed_fetches", offsetof(struct link_report, failed_fetches)},
    {"forged", offsetof(struct link_report, forged)},
    {"refused", offsetof(struct link_report, refused)},
    {"missing", offsetof(struct link_report, missing)},
};

static int64_t now_s(void)
{
    struct timespec now;

    (void)clock_gettime(CLOCK_BOOTTIME, &now);
    return now.tv_sec;
}

/* ---- the file of the service ---- */

void link_figures_keep(const struct link_report *report)
{
    const char *folder = getenv("RUNTIME_DIRECTORY");
    char path[PATH_MAX], fresh[PATH_MAX];
    json_t *json = json_pack("{s:I, s:i}", "at_s", (json_int_t)now_s(), "phase",
                             (int)report->phase);

    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        uint64_t value;
        memcpy(&value, (const char *)report + members[i].at, sizeof value);
        (void)json_object_set_new(json, members[i].member, json_integer((json_int_t)value));
    }
    if (folder && json && snprintf(path, sizeof path, "%s/%s", folder, name) < PATH_MAX &&
        snprintf(fresh, sizeof fresh, "%s/%s.new", folder, name) < PATH_MAX &&
        json_dump_file(json, fresh, JSON_COMPACT) == 0) {
        (void)rename(fresh, path);
    }
    json_decref(json);
}

bool link_figures_find(struct link_report *out)
{
    struct link_report report = {.phase = LINK_AWAY};
    const char *folder = getenv("RUNTIME_DIRECTORY");
    char path[PATH_MAX];

    if (snprintf(path, sizeof path, "%s/%s", folder ? folder : standard_folder, name) >= PATH_MAX) {
        return false;
    }
    json_t *json = json_load_file(path, JSON_REJECT_DUPLICATES, NULL);
    const int64_t at_s = json_integer_value(json_object_get(json, "at_s"));
    const int64_t phase = json_integer_value(json_object_get(json, "phase"));
    const bool is_new = at_s <= now_s() && now_s() - at_s <= LINK_FIGURES_OLD_S && phase >= 0 &&
                        phase < LINK_PHASES;

    for (size_t i = 0; i < sizeof members / sizeof *members; i++) {
        const int64_t value = json_integer_value(json_object_get(json, members[i].member));
        const uint64_t kept = value > 0 ? (uint64_t)value : 0;
        memcpy((char *)&report + members[i].at, &kept, sizeof kept);
    }
    json_decref(json);
    if (is_new) {
        report.phase = (enum link_phase)phase;
        *out = report;
    }
    return is_new;
}

/* ---- the text ---- */

static void head(FILE *out, const char *metric, const char *help)
{
    const size_t n = strlen(metric), total = strlen("_total");
    const bool grows = n > total && strcmp(metric + n - total, "_total") == 0;

    (void)fprintf(out, "# HELP isotherm_door_%s %s.\n# TYPE isotherm_door_%s %s\n", metric, help,
                  metric, grows ? "counter" : "gauge");
}

static void number(FILE *out, const char *metric, const char *help, int64_t value)
{
    head(out, metric, help);
    (void)fprintf(out, "isotherm_door_%s %" PRId64 "\n", metric, value);
}

static uint64_t epoch_of(const struct iso_link_status *status, size_t i)
{
    return status->places[i].epoch;
}

static uint64_t sequence_of(const struct iso_link_status *status, size_t i)
{
    return status->places[i].sequence;
}

static uint64_t waits_of(const struct iso_link_status *status, size_t i)
{
    return status->wants_snapshot[i];
}

static void zones(FILE *out, const struct iso_link_status *status)
{
    static const struct {
        const char *metric, *help;
        uint64_t (*value)(const struct iso_link_status *status, size_t i);
    } all[] = {
        {"zone_epoch", "Epoch of the zone's key", epoch_of},
        {"zone_sequence", "Number of the newest change that the door has", sequence_of},
        {"zone_waits", "Whether the zone has to be fetched whole", waits_of},
    };
    char zone[ISO_FLEET_ID_TEXT_SIZE];

    for (size_t k = 0; k < sizeof all / sizeof *all; k++) {
        head(out, all[k].metric, all[k].help);
        for (size_t i = 0; i < status->n; i++) {
            (void)fprintf(out, "isotherm_door_%s{zone=\"%s\"} %" PRIu64 "\n", all[k].metric,
                          iso_fleet_id_text(&status->places[i].zone, zone),
                          all[k].value(status, i));
        }
    }
}

static void service(FILE *out, const struct link_report *report)
{
    number(out, "changes_missing", "Changes that the hub has named and the door lacks",
           (int64_t)report->missing);
    number(out, "deltas_total", "Changes that were applied", (int64_t)report->deltas);
    number(out, "snapshots_total", "Snapshots that were applied", (int64_t)report->snapshots);
    number(out, "fetches_failed_total", "Fetches that failed", (int64_t)report->failed_fetches);
    head(out, "messages_refused_total", "Messages that were refused, by the reason");
    (void)fprintf(out, "isotherm_door_messages_refused_total{reason=\"forged\"} %" PRIu64 "\n",
                  report->forged);
    (void)fprintf(out, "isotherm_door_messages_refused_total{reason=\"refused\"} %" PRIu64 "\n",
                  report->refused);
}

void link_figures_write(FILE *out, const struct iso_link_status *status,
                        const struct link_bus_lease *lease, int64_t ends_s,
                        const struct link_report *report)
{
    const uint64_t waiting = status->last_event > status->acked ? status->last_event - status->acked
                                                                : 0;

    number(out, "connected", "Whether the hub answers", report && report->phase == LINK_ONLINE);
    number(out, "lease_left_seconds", "Time until the lease ends",
           lease->left_s > 0 ? lease->left_s : 0);
    number(out, "events_waiting", "Records of the log that the hub has not acknowledged",
           (int64_t)waiting);
    number(out, "requests_pending", "People who wait for approval", lease->pending);
    number(out, "hub_behind", "Whether the hub knows less than the door", lease->is_hub_behind);
    number(out, "certificate_ends_seconds", "End of the certificate in seconds since 1970", ends_s);
    zones(out, status);
    if (report) {
        service(out, report);
    }
}
