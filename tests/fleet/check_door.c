#include "tests/fleet/check_door.h"

#include <errno.h>
#include <limits.h>
#include <sodium.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include "drivers/door/door_null.h"
#include "firmware/appliance/administration/administration.h"
#include "firmware/appliance/appliance.h"
#include "firmware/fleet/door/fleet_direct.h"
#include "firmware/fleet/update/update.h"
#include "firmware/policy/zones/zone_file.h"
#include "tests/firmware/rigs/puppets.h"
#include "tests/fleet/check_events.h"
#include "tests/fleet/check_files.h"
#include "tests/fleet/check_update.h"

/* LEFT_MS: after this time without a frame a visit is over. */
enum { PEOPLE_MOST = 20000, VISIT_MS = 3000, LEFT_MS = 4500, FRAMES = 5 };

struct check_door {
    struct check_door_setup setup;
    char folder[PATH_MAX];
    int64_t advanced_ns; /* how far the clock of the boot was moved */
    struct iso_config config;
    struct puppet_sensor sensor;
    struct puppet_pipeline puppet;
    struct iso_key_ring *ring;
    struct iso_gallery *gallery;
    struct iso_audit *audit;
    struct iso_door_io *door_io;
    struct iso_live_settings settings;
    char settings_path[PATH_MAX];
    struct iso_appliance_borrowed borrowed;
    struct iso_appliance *appliance;
    struct check_files files;
    int64_t shown_ns; /* when a face was shown last; 0: never */
    struct check_heard heard;
    struct link_update *update; /* NULL: there is no link */
};

static const struct iso_zone_source zones = {iso_zone_file_read, ISO_ZONE_FOLDER};

static void end_with(const struct check_door *door, const char *what, const char *why)
{
    fprintf(stderr, "fleet_doors: %s: %s: %s\n", door->folder, what, why);
    exit(4);
}

static void expect(const struct check_door *door, int error, const char *what,
                   const struct iso_fault *fault)
{
    if (error) {
        end_with(door, what, fault->text[0] ? fault->text : strerror(-error));
    }
}

/* ---- the stores ---- */

static const char *path_of(const struct check_door *door, const char *name)
{
    static char path[PATH_MAX];
    if (snprintf(path, sizeof path, "%s/%s", door->folder, name) >= (int)sizeof path) {
        end_with(door, name, "the path is too long");
    }
    return path;
}

static void open_stores(struct check_door *door)
{
    struct iso_fault fault = {.text = ""};
    char *ring = strdup(path_of(door, "g.db.keys")), *key = strdup(path_of(door, "g.db.key"));
    const struct iso_key_place place = {.ring = ring, .file = key};
    expect(door, iso_key_ring_open(&place, &door->ring, &fault), "key ring", &fault);
    free(ring);
    free(key);
    const struct iso_gallery_options gallery = {.path = path_of(door, "g.db"),
                                                .capacity = PEOPLE_MOST,
                                                .algorithm = PUPPET_ALGORITHM,
                                                .ring = door->ring};
    expect(door, iso_gallery_open(&gallery, &door->gallery, &fault), "gallery", &fault);
    const struct iso_audit_options audit = {.path = path_of(door, "a.log"),
                                            .sync = true,
                                            .segment_bytes = 4 << 20,
                                            .segments = 50,
                                            .ring = door->ring};
    expect(door, iso_audit_open(&audit, &door->borrowed.times, &door->audit, &fault), "log",
           &fault);
}

static int64_t boot_ns(void *context)
{
    const struct check_door *door = context;
    struct timespec now;
    (void)clock_gettime(CLOCK_BOOTTIME, &now);
    return now.tv_sec * ISO_NS_PER_S + now.tv_nsec + door->advanced_ns;
}

static struct iso_config config_of(void)
{
    struct iso_config config = iso_config_default();
    config.decision.threshold = 6; /* of the scores of the puppets */
    config.decision.margin = 1;
    config.motion.frozen_frames = 0; /* all frames of a puppet are equal */
    config.motion.lifeless_ms = 0;
    return config;
}

static void open_parts(struct check_door *door)
{
    struct iso_fault fault = {.text = ""};
    const struct iso_door_outputs unpowered = {{false}};
    door->config = config_of();
    door->borrowed.times = iso_times_system();
    door->borrowed.times.boottime = (struct iso_clock){boot_ns, door};
    door->sensor.clock = door->borrowed.times.monotonic;
    open_stores(door);
    expect(door,
           iso_door_io_open("null", NULL, 0, &door->borrowed.times.monotonic, &unpowered,
                            &door->door_io, &fault),
           "door", &fault);
    (void)snprintf(door->settings_path, sizeof door->settings_path, "%s",
                   path_of(door, "settings"));
    iso_live_settings_init(&door->settings, &door->config, door->settings_path, door->ring);
    door->borrowed.config = &door->config;
    door->borrowed.sensor = puppet_sensor_source(&door->sensor);
    door->borrowed.pipeline = puppet_pipeline(&door->puppet);
    door->borrowed.zones = &zones;
    door->borrowed.settings = &door->settings;
    door->borrowed.ring = door->ring;
    door->borrowed.gallery = door->gallery;
    door->borrowed.audit = door->audit;
    door->borrowed.door_io = door->door_io;
    door->borrowed.events = check_events(&door->heard);
    expect(door, iso_appliance_new(&door->borrowed, &door->appliance), "appliance", &fault);
    expect(door, iso_appliance_start(door->appliance, &fault), "appliance", &fault);
}

static void note(void *context, const char *line)
{
    const struct check_door *door = context;
    if (getenv("FLEET_DOORS_LOUD")) {
        fprintf(stderr, "%s: link: %s\n", door->folder, line);
    }
}

static void start_link(struct check_door *door)
{
    struct iso_fault fault = {.text = ""};
    if (!check_files_read(door->folder, &door->files)) {
        return;
    }
    struct link_setup setup = {
        .event = door->setup.event,
        .daemon = iso_fleet_direct(iso_appliance_fleet(door->appliance)),
        .http = door->setup.http,
        .broker = {.host = door->files.broker_host,
                   .port = door->files.broker_port,
                   .ca_file = door->files.ca,
                   .certificate_file = door->files.certificate,
                   .key_file = door->files.key,
                   .backoff_base_ms = 500,
                   .backoff_cap_ms = 4000,
                   .keepalive_s = 5},
        .hub_url = door->files.hub_url,
        .note_context = door,
        .note = note,
    };
    expect(door, check_update_start(door->folder, &setup, &door->update, &fault), "updates",
           &fault);
    expect(door, link_door_new(&setup, &door->heard.link, &fault), "link", &fault);
}

static void stop_link(struct check_door *door)
{
    link_door_free(door->heard.link);
    door->heard.link = NULL;
    link_update_free(door->update);
    door->update = NULL;
}

struct check_door *check_door_new(const struct check_door_setup *setup)
{
    struct check_door *door = calloc(1, sizeof *door);
    if (!door) {
        fprintf(stderr, "fleet_doors: out of memory\n");
        exit(4);
    }
    door->setup = *setup;
    (void)snprintf(door->folder, sizeof door->folder, "%s", setup->folder);
    door->heard.folder = door->folder;
    if (mkdir(door->folder, 0700) && errno != EEXIST) {
        end_with(door, "mkdir", strerror(errno));
    }
    open_parts(door);
    start_link(door);
    return door;
}

void check_door_free(struct check_door *door)
{
    stop_link(door);
    iso_appliance_free(door->appliance);
    iso_audit_close(door->audit);
    iso_gallery_close(door->gallery);
    iso_door_io_close(door->door_io);
    iso_key_ring_close(door->ring);
    free(door);
}

/* ---- at the door ---- */

void check_door_step(struct check_door *door)
{
    const int64_t now_ns = iso_monotonic_ns();
    for (int i = 0; i < 20 && iso_appliance_step(door->appliance) <= now_ns; i++) {
    }
}

void check_door_address(const struct check_door *door, char address[ISO_TRANSFER_ADDRESS_SIZE])
{
    iso_transfer_address(door->ring, address);
}

void check_door_join(struct check_door *door, const char *path, char *answer, size_t size)
{
    uint8_t bytes[1024];
    struct iso_fault fault = {.text = ""};
    FILE *in = fopen(path, "re");
    const size_t n = in ? fread(bytes, 1, sizeof bytes, in) : 0;
    if (in) {
        (void)fclose(in);
    }
    const int error = iso_fleet_join(iso_appliance_fleet(door->appliance), bytes, n, "check",
                                     &fault);
    if (!error && !door->heard.link) {
        start_link(door);
    }
    (void)snprintf(answer, size, "%s", error ? fault.text : "ok");
}

void check_door_link(struct check_door *door, bool runs)
{
    stop_link(door);
    if (runs) {
        start_link(door);
    }
}

void check_door_update(const struct check_door *door, char *answer, size_t size)
{
    if (door->update) {
        check_update_describe(door->update, answer, size);
    } else {
        (void)snprintf(answer, size, "none");
    }
}

/* Steps doors for some time, or until all have a verdict. */
static void step_for(struct check_door *const doors[], int n, int64_t ms, bool for_verdicts)
{
    const int64_t end_ns = iso_monotonic_ns() + ms * ISO_NS_PER_MS;
    for (int waiting = 1; waiting > 0 && iso_monotonic_ns() < end_ns;) {
        waiting = 0;
        for (int i = 0; i < n; i++) {
            check_door_step(doors[i]);
            waiting += !for_verdicts || !doors[i]->heard.visit[0];
        }
        (void)usleep(2000);
    }
}

void check_doors_show(struct check_door *const doors[], int n, int face)
{
    const int64_t now_ns = iso_monotonic_ns();
    int64_t wait_ns = 0;
    for (int i = 0; i < n; i++) {
        const int64_t left_ns = doors[i]->shown_ns + LEFT_MS * ISO_NS_PER_MS - now_ns;
        wait_ns = doors[i]->shown_ns && left_ns > wait_ns ? left_ns : wait_ns;
    }
    step_for(doors, n, wait_ns / ISO_NS_PER_MS, false);
    const int64_t begin_ns = iso_monotonic_ns();
    for (int i = 0; i < n; i++) {
        doors[i]->heard.visit[0] = '\0';
        doors[i]->shown_ns = begin_ns;
        for (int k = 1; k <= FRAMES; k++) {
            puppet_sensor_add(&doors[i]->sensor, begin_ns + 33 * k * ISO_NS_PER_MS, face,
                              ISO_CAPTURE_OK);
        }
    }
    step_for(doors, n, VISIT_MS, true);
}

const char *check_door_answer(const struct check_door *door)
{
    return door->heard.visit[0] ? door->heard.visit : "nothing";
}

void check_door_enrol(struct check_door *door, const char *name, int face, char *answer,
                      size_t size)
{
    struct iso_fault fault = {.text = ""};
    struct iso_person person = {.enrolled_s = time(NULL)};
    const struct iso_template tmpl = puppet_template(face, PUPPET_ALGORITHM);
    (void)snprintf(person.name, sizeof person.name, "%s", name);
    const int error = iso_gallery_add(door->gallery, &person, &tmpl, &fault);
    (void)snprintf(answer, size, "%s", error ? fault.text : "ok");
    if (door->heard.link) {
        link_door_work(door->heard.link, "requests");
    }
}

void check_door_advance(struct check_door *door, int64_t seconds)
{
    door->advanced_ns += seconds * ISO_NS_PER_S;
}

/* ---- its state ---- */

static int compare_ids(const void *a, const void *b)
{
    return memcmp(a, b, ISO_FLEET_ID_BYTES + 8);
}

/* A digest of who is here with which revision, whatever the order in the gallery. */
static size_t digest_people(const struct check_door *door, char text[17])
{
    enum { ROW = ISO_FLEET_ID_BYTES + 8 };
    size_t n = 0, rows = 0;
    uint8_t digest[8];
    const struct iso_person *people = iso_gallery_people(door->gallery, &n);
    uint8_t(*all)[ROW] = calloc(n ? n : 1, ROW);
    for (size_t i = 0; all && i < n; i++) {
        struct iso_credential_record record = iso_site_access_credential(door->gallery,
                                                                         people[i].id);
        if (record.fleet.zones) {
            memcpy(all[rows], record.fleet.person, ISO_FLEET_ID_BYTES);
            memcpy(all[rows++] + ISO_FLEET_ID_BYTES, &record.fleet.revision, 8);
        }
        iso_credential_record_wipe(&record);
    }
    if (all) {
        qsort(all, rows, ROW, compare_ids);
        (void)crypto_generichash(digest, sizeof digest, (const uint8_t *)all, rows * ROW, NULL, 0);
        (void)sodium_bin2hex(text, 17, digest, sizeof digest);
    }
    free(all);
    return rows;
}

void check_door_describe(struct check_door *door, char *answer, size_t size)
{
    char people[17] = "", zone[ISO_FLEET_ID_TEXT_SIZE], digest[9];
    struct iso_fleet_status status;
    struct iso_fault fault = {.text = ""};
    const size_t n = digest_people(door, people);
    const struct link_report report = door->heard.link ? link_door_report(door->heard.link)
                                                       : (struct link_report){.phase = LINK_AWAY};
    if (iso_fleet_get_status(iso_appliance_fleet(door->appliance), &status, &fault)) {
        (void)snprintf(answer, size, "none");
        return;
    }
    size_t used = (size_t)snprintf(
        answer, size,
        "%s people %zu %s lease %lld behind %d event %llu acked %llu refused %llu forged %llu",
        link_phase_word(report.phase), n, people, (long long)(status.lease_left_ns / ISO_NS_PER_S),
        status.behind, (unsigned long long)status.last_event, (unsigned long long)status.acked,
        (unsigned long long)report.refused, (unsigned long long)report.forged);
    for (size_t i = 0; i < status.n && used < size; i++) {
        (void)sodium_bin2hex(digest, sizeof digest, status.places[i].digest, 4);
        used += (size_t)snprintf(answer + used, size - used, " zone %s %llu %llu %s%s",
                                 iso_fleet_id_text(&status.places[i].zone, zone),
                                 (unsigned long long)status.places[i].epoch,
                                 (unsigned long long)status.places[i].sequence, digest,
                                 status.wants_snapshot[i] ? " wants-snapshot" : "");
    }
}
