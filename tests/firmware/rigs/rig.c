#include "tests/firmware/rigs/rig.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <syslog.h>

#include "tests/firmware/rigs/cmocka_headers.h"

#include "drivers/door/door_null.h"
#include "firmware/policy/zones/zone_file.h"
#include "tests/firmware/rigs/stores.h"
#include "tests/support/devices/manual_clock.h"
#include "tests/support/scratch.h"

/* ---- reports ---- */

__attribute__((format(printf, 2, 3))) static void tell(struct rig *rig, const char *format, ...)
{
    const size_t used = strlen(rig->told);
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(rig->told + used, sizeof rig->told - used, format, arguments);
    va_end(arguments);
}

static void on_enroll_status(void *context, const char *result, bool done, unsigned stage,
                             unsigned stages, double quality, const char *person)
{
    assert_true(isfinite(quality));
    tell(context, "enroll %s %u/%u%s%s%s; ", result, stage, stages, done ? " done" : "",
         *person ? " " : "", person);
}

static void on_enroll_step(void *context, const char *pose, const char *state, unsigned step,
                           unsigned steps, double turn_deg)
{
    char degrees[16] = "";
    if (turn_deg != 0.0) {
        (void)snprintf(degrees, sizeof degrees, " by %.0f", turn_deg);
    }
    tell(context, "step %u/%u %s %s%s; ", step, steps, pose, state, degrees);
}

static void on_recognition_status(void *context, enum iso_appliance_mode mode, const char *result,
                                  bool done, const char *person, double score, double threshold)
{
    const struct rig *rig = context;
    size_t n_people = 1;
    if (mode == ISO_APPLIANCE_IDENTIFY) {
        (void)iso_gallery_people(rig->gallery, &n_people);
    }
    assert_true(threshold == iso_config_threshold_among(&rig->config, n_people, false));
    assert_true(isnan(score) || score <= 10);
    tell(context, "%s %s%s%s%s; ", iso_appliance_mode_name(mode), result, *person ? " " : "",
         person, done ? " done" : "");
}

static void on_visit(void *context, const struct iso_visit *visit)
{
    const bool stuck = visit->door == ISO_DOOR_DID_NOT_UNLOCK;
    assert_int_equal(visit->verdict.allow, visit->door != ISO_DOOR_NOT_ASKED);
    assert_int_equal(stuck, *visit->door_fault != '\0');
    tell(context, "visit %s%s%s %s %d%s%s; ", visit->verdict.allow ? "allow" : "deny",
         *visit->person ? " " : "", visit->person, iso_reason_name(visit->verdict.reason),
         visit->verdict.frames, stuck ? " not-unlocked: " : "", visit->door_fault);
}

const struct iso_zone_source rig_zones = {iso_zone_file_read, ISO_ZONE_FOLDER};

static void on_wanted(void *context, const char *what)
{
    tell(context, "wanted %s; ", what);
}

static void on_hint(void *context, enum iso_capture capture)
{
    tell(context, "hint %s; ", iso_capture_name(capture));
}

static void on_view(void *context, const struct iso_view *view)
{
    tell(context, "view %s; ", iso_capture_name(view->capture));
}

static void on_picture(void *context, const struct iso_frame *frame)
{
    tell(context, "picture %s; ", frame ? "taken" : "failed");
}

static void on_door_changed(void *context, const char *state, const char *cause)
{
    tell(context, "door %s %s; ", state, cause);
}

static void on_claim_lost(void *context)
{
    tell(context, "claim lost; ");
}

static void on_message(void *context, int priority, const char *text)
{
    struct rig *rig = context;
    assert_in_range(priority, 0, 7);
    assert_null(strchr(text, '\n'));
    if (priority <= LOG_WARNING) {
        (void)snprintf(rig->warned, sizeof rig->warned, "%s", text);
    }
}

/* ---- set-up ---- */

int rig_capacity;
struct rig_log rig_log;

static int64_t boot_ns(void *context)
{
    const struct rig *rig = context;
    return rig->now_ns + rig->asleep_ns;
}

static void open_parts(struct rig *rig)
{
    const struct iso_clock clock = manual_clock(&rig->now_ns);
    const struct iso_door_outputs unpowered = {{false}};
    rig->sensor.clock = clock;
    rig->borrowed = (struct iso_appliance_borrowed){
        .config = &rig->config,
        .times = {clock, manual_clock_now_ns, &rig->wall_ns, {boot_ns, rig}},
        .sensor = puppet_sensor_source(&rig->sensor),
        .pipeline = puppet_pipeline(&rig->puppet),
        .zones = &rig_zones,
        .events = {on_enroll_status, on_enroll_step, on_recognition_status, on_visit, on_wanted,
                   on_hint, on_view, NULL, on_picture, on_door_changed, on_claim_lost, on_message,
                   rig, NULL},
    };
    assert_int_equal(iso_door_io_open("null", NULL, 0, &clock, &unpowered, &rig->door_io, NULL), 0);
    struct iso_gallery_options gallery = stores_gallery(rig->directory);
    gallery.capacity = rig_capacity ? rig_capacity : gallery.capacity;
    struct iso_audit_options audit = stores_audit(rig->directory);
    audit.sync = rig_log.sync;
    audit.segment_bytes = rig_log.segment_bytes;
    audit.segments = rig_log.segments;
    assert_int_equal(iso_gallery_open(&gallery, &rig->gallery, NULL), 0);
    assert_int_equal(iso_audit_open(&audit, &rig->borrowed.times, &rig->audit, NULL), 0);
    rig->borrowed.ring = stores_ring(rig->directory);
    (void)snprintf(rig->settings_path, sizeof rig->settings_path, "%s/settings", rig->directory);
    iso_live_settings_init(&rig->settings, &rig->config, rig->settings_path, rig->borrowed.ring);
    rig->borrowed.settings = &rig->settings;
    rig->borrowed.door_io = rig->door_io;
    rig->borrowed.gallery = rig->gallery;
    rig->borrowed.audit = rig->audit;
}

int rig_setup(void **state)
{
    void *directory = NULL;
    return scratch_setup(&directory) ? -1 : rig_setup_in(state, directory);
}

int rig_setup_in(void **state, char *directory)
{
    struct rig *rig = calloc(1, sizeof *rig);
    if (!rig) {
        return -1;
    }
    rig->directory = directory;
    rig->now_ns = 100 * ISO_NS_PER_S;
    rig->wall_ns = INT64_C(1795250000) * ISO_NS_PER_S;
    rig->config = iso_config_default();
    rig->config.decision.threshold = 6;
    rig->config.motion.frozen_frames = 0; /* all frames of the puppet are equal */
    rig->config.motion.lifeless_ms = 0;
    rig->config.decision.margin = 1;
    rig->config.enroll.agree_score = 4;
    rig->config.enroll.duplicate_score = 6;
    rig->config.enroll.stages = 3;
    open_parts(rig);
    *state = rig;
    return iso_appliance_new(&rig->borrowed, &rig->appliance);
}

int rig_teardown(void **state)
{
    struct rig *rig = *state;
    void *directory = rig->directory;
    iso_appliance_free(rig->appliance);
    iso_audit_close(rig->audit);
    iso_gallery_close(rig->gallery);
    iso_door_io_close(rig->door_io);
    assert_int_equal(rig->sensor.opened, rig->sensor.closed);
    free(rig);
    return stores_teardown(&directory);
}

/* ---- frames and time ---- */

void rig_start(struct rig *rig)
{
    struct iso_fault fault = {.text = ""};
    if (iso_appliance_start(rig->appliance, &fault)) {
        fail_msg("%s", fault.text);
    }
    (void)rig_news(rig);
}

void rig_enrol(struct rig *rig, const char *person, int face)
{
    struct iso_person entry = {.enrolled_s = 1};
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    (void)snprintf(entry.name, sizeof entry.name, "%s", person);
    assert_int_equal(iso_gallery_add(rig->gallery, &entry, &tmpl, NULL), 0);
}

void rig_show(struct rig *rig, int face, int n)
{
    for (int i = 1; i <= n; i++) {
        puppet_sensor_add(&rig->sensor, rig->now_ns + 33 * i * ISO_NS_PER_MS, face, ISO_CAPTURE_OK);
    }
}

void rig_show_at(struct rig *rig, int face, int right_mm, int64_t in_ms)
{
    puppet_sensor_add_at(&rig->sensor, rig->now_ns + in_ms * ISO_NS_PER_MS, face, ISO_CAPTURE_OK,
                         right_mm);
}

void rig_show_unusable(struct rig *rig, enum iso_capture capture, int n)
{
    for (int i = 1; i <= n; i++) {
        puppet_sensor_add(&rig->sensor, rig->now_ns + 33 * i * ISO_NS_PER_MS, 0, capture);
    }
}

void rig_run(struct rig *rig, int64_t ms)
{
    const int64_t end_ns = rig->now_ns + ms * ISO_NS_PER_MS;
    for (int steps = 0;; steps++) {
        const int64_t wake_ns = iso_appliance_step(rig->appliance);
        assert_true(steps < 100 + 2 * ms); /* otherwise it is always due and never waits */
        if (wake_ns > end_ns) {
            break;
        }
        if (wake_ns > rig->now_ns) {
            rig->wall_ns += wake_ns - rig->now_ns;
            rig->now_ns = wake_ns;
        }
    }
    rig->wall_ns += end_ns - rig->now_ns;
    rig->now_ns = end_ns;
}

/* ---- results ---- */

const char *rig_news(struct rig *rig)
{
    static char text[sizeof rig->told];
    strcpy(text, rig->told);
    rig->told[0] = '\0';
    const size_t length = strlen(text);
    if (length > 2) {
        text[length - 2] = '\0'; /* remove the last "; " */
    }
    return text;
}

bool rig_relay(const struct rig *rig)
{
    bool active = false;
    assert_int_equal(iso_door_null_get_output(rig->door_io, ISO_DOOR_RELAY, &active), 0);
    return active;
}

struct record {
    char event[64], line[1024];
};

static int keep_last(void *context, const char *line)
{
    struct record *record = context;
    if (strstr(line, record->event)) {
        (void)snprintf(record->line, sizeof record->line, "%s", line);
    }
    return 0;
}

const char *rig_record(struct rig *rig, const char *event)
{
    static struct record record;
    record.line[0] = '\0';
    (void)snprintf(record.event, sizeof record.event, "\"event\":\"%s\"", event);
    assert_int_equal(iso_audit_read(rig->audit, 1, UINT32_MAX, keep_last, &record), 0);
    return record.line;
}

static void limit_files(rlim_t bytes)
{
    struct rlimit limit;
    assert_int_equal(getrlimit(RLIMIT_FSIZE, &limit), 0);
    limit.rlim_cur = bytes;
    assert_int_equal(setrlimit(RLIMIT_FSIZE, &limit), 0);
}

void rig_fill_disk_from(off_t bytes)
{
    (void)signal(SIGXFSZ, SIG_IGN);
    limit_files((rlim_t)bytes);
}

void rig_fill_disk(void)
{
    rig_fill_disk_from(1);
}

void rig_free_disk(void)
{
    limit_files(RLIM_INFINITY);
}

void rig_start_claimed(struct rig *rig)
{
    rig_start(rig);
    assert_int_equal(iso_appliance_claim(rig->appliance), 0);
}

void rig_start_enrolling(struct rig *rig, const struct iso_enroll_request *request)
{
    struct iso_fault fault = {.text = ""};
    if (iso_appliance_enroll(rig->appliance, request, &fault)) {
        fail_msg("%s", fault.text);
    }
}
