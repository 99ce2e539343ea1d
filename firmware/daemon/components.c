#include "firmware/daemon/components.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-journal.h>

#include "drivers/base/shipped.h"
#include "drivers/counter/tpm2_counter.h"
#include "drivers/vision/face_detector.h"
#include "firmware/config/door_options.h"
#include "firmware/visit/lockout_file.h"

static const char *or_shipped(const char *path, const char *shipped)
{
    return *path ? path : shipped;
}

/* The file that a method was trained to: the one that [model] names, or the installed one. */
static const char *data_path_of(const struct iso_config *config,
                                const struct iso_method_ops *method)
{
    for (size_t i = 0; method->data_key && i < iso_config_n_keys; i++) {
        const struct iso_config_key *key = &iso_config_keys[i];
        if (strcmp(key->section, "model") == 0 && strcmp(key->name, method->data_key) == 0) {
            return or_shipped((const char *)config + key->offset, method->installed_data());
        }
    }
    return "";
}

static int open_pipeline(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    struct iso_pipeline_options options = {
        .head_path = or_shipped(config->model.head, iso_shipped_model()),
        .method = config->match.method,
        .data_path = data_path_of(config, iso_method_at(config->match.method)),
        .extract = iso_extract_options_default(),
        .match = iso_match_options_default(),
        .clock = components->times.monotonic,
        .image = config->recognition.intensity,
        .cascade_path = config->recognition.cascade,
    };
    options.extract.distance_min_mm = config->sensor.distance_min_mm;
    options.extract.distance_max_mm = config->sensor.distance_max_mm;
    options.extract.track = true;
    options.match.trim = config->match.trim;
    options.match.icp_iterations = config->match.icp_iterations;
    options.match.transform = config->match.transform;
    return iso_pipeline_open(&options, &components->pipeline, fault);
}

/* What may be different later: the chip is plugged in, udev has set the permissions, another
 * process has let the line go. */
static bool passes(int error)
{
    return error == -ENODEV || error == -EBUSY || error == -EACCES || error == -EIO;
}

static int check_sensor(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    const size_t n = iso_config_sensor_options(config, options);
    return iso_sensor_check(config->sensor.backend, options, n, fault);
}

static int check_door(const struct iso_config *config, struct iso_fault *fault)
{
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    const size_t n = iso_config_door_options(config, options);
    return iso_door_io_check(config->door.backend, options, n, fault);
}

/* The length of a path's directory with its last slash; 0: the working directory. */
static size_t directory_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

/* The service manager makes this directory at the start (StateDirectory= of the unit). */
static bool in_state_directory(const char *path)
{
    const struct iso_config standard = iso_config_default();
    const size_t length = directory_length(standard.gallery.path);
    return directory_length(path) == length && strncmp(path, standard.gallery.path, length) == 0;
}

/* The directory of a file that the daemon makes if need be. */
static int check_place(const char *key, const char *path, struct iso_fault *fault)
{
    char directory[ISO_CONFIG_TEXT_SIZE + 8];
    struct stat status;
    const size_t length = directory_length(path);
    if (length == 0 || in_state_directory(path)) {
        return 0;
    }
    (void)snprintf(directory, sizeof directory, "%.*s", (int)length, path);
    if (stat(directory, &status) == 0) {
        return 0;
    }
    const int error = errno == ENOTDIR ? -ENOENT : -errno;
    return iso_fault_set_code(
        fault, error == -EACCES ? ISO_FAULT_FILE_DENIED : ISO_FAULT_FILE_MISSING, error,
        "%s %s: the directory %s: %s", key, path, directory, strerror(-error));
}

static int check_places(const struct iso_config *config, struct iso_fault *fault)
{
    const struct {
        const char *key, *path;
    } places[] = {
        {"[gallery] path", config->gallery.path},
        {"[seal] key", config->seal.key},
        {"[log] path", config->log.path},
        {"[lockout] path", config->lockout.path},
    };
    int error = 0;
    for (size_t i = 0; !error && i < sizeof places / sizeof *places; i++) {
        error = check_place(places[i].key, places[i].path, fault);
    }
    return error;
}

/* Everything that needs neither a device nor a store. */
static int open_files(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    int error = open_pipeline(components, fault);
    if (!error && *config->door.cards) {
        error = iso_cards_load(config->door.cards, &components->cards, fault);
    }
    error = error ? error : check_sensor(config, fault);
    error = error ? error : check_door(config, fault);
    error = error ? error : iso_components_check_counter(config, fault);
    return error ? error : check_places(config, fault);
}

static int new_door(const struct iso_config *config, const struct iso_times *times,
                    struct iso_door_io **out, struct iso_fault *fault)
{
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    const size_t n = iso_config_door_options(config, options);
    return iso_door_io_new(config->door.backend, options, n, &times->monotonic, out, fault);
}

static const struct iso_door_outputs unpowered;

/* Lines that are not there yet are no reason not to start: the door is at fault until they are. */
static int open_door(struct iso_components *components, struct iso_fault *fault)
{
    int error = new_door(&components->config, &components->times, &components->door_io, fault);
    if (!error) {
        error = iso_door_io_reopen(components->door_io, &unpowered, fault);
    }
    return passes(error) ? 0 : error;
}

static int start_door(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_door_guard_options options = iso_door_options_of(
        &components->config.door, &components->times, components->door_io, true);
    int error = iso_door_guard_new(&options, &components->door);
    error = error ? error : iso_door_guard_start(components->door);
    return error ? iso_fault_set(fault, error, "the door has no thread: %s", strerror(-error)) : 0;
}

static void stop_door(struct iso_components *components)
{
    if (components->door) {
        iso_door_guard_stop(components->door);
        iso_door_guard_free(components->door);
    }
}

static int open_ring(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    char ring[ISO_CONFIG_TEXT_SIZE + 8], key[ISO_CONFIG_TEXT_SIZE + 8];
    (void)snprintf(ring, sizeof ring, "%s.keys", config->gallery.path);
    (void)snprintf(key, sizeof key, "%s.key", config->gallery.path);
    const struct iso_key_place place = {
        .ring = ring,
        .file = or_shipped(config->seal.key, key),
        .credentials = config->seal.credentials,
    };
    return iso_key_ring_open(&place, &components->ring, fault);
}

enum { LOG_SEGMENTS = 8 };

static int open_log(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    const int error = config->log.journal ? iso_journal_new(sd_journal_sendv, &components->journal)
                                          : 0;
    if (error) {
        return iso_fault_set(fault, error, "the journal: %s", strerror(-error));
    }
    const struct iso_audit_options options = {
        .path = config->log.path,
        .sync = config->log.sync,
        .segment_bytes = (uint64_t)config->log.max_mib * (1 << 20) / LOG_SEGMENTS,
        .segments = LOG_SEGMENTS - 1,
        .migrate = config->seal.migrate,
        .ring = components->ring,
        .counter = components->counter,
        .written = components->journal ? iso_journal_record : NULL,
        .context = components->journal,
    };
    return iso_audit_open(&options, &components->times, &components->audit, fault);
}

static int open_gallery(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    const struct iso_pipeline *pipeline = &components->pipeline;
    const struct iso_gallery_options options = {
        .path = config->gallery.path,
        .capacity = config->gallery.capacity,
        .algorithm = pipeline->ops->algorithm(pipeline->self),
        .metric = pipeline->ops->metric ? pipeline->ops->metric(pipeline->self) : NULL,
        .ring = components->ring,
        .migrate = config->seal.migrate,
    };
    return iso_gallery_open(&options, &components->gallery, fault);
}

/* The lock-out's memory is beside the audit log, if it has no place of its own. */
static void place_lockout(struct iso_components *components)
{
    static const char name[] = "lockout";
    const struct iso_config *config = &components->config;
    const size_t length = directory_length(config->log.path);
    if (*config->lockout.path) {
        (void)snprintf(components->lockout_path, sizeof components->lockout_path, "%s",
                       config->lockout.path);
    } else {
        (void)snprintf(components->lockout_path, sizeof components->lockout_path, "%.*s%s",
                       (int)length, config->log.path, name);
    }
}

/* What the lock-out file knows of the other stores is compared with theirs. Whether it can be used
 * is for the appliance to say, which shuts the door if not. */
static void look_at_lockout(const struct iso_components *components)
{
    struct iso_lockout_file file;
    struct iso_fault fault;
    (void)!iso_lockout_load(components->lockout_path, components->ring, &file, &fault);
}

/* A gallery that is put back with its anchor is behind what the log says of it. */
int iso_components_compare_stores(const struct iso_components *components, struct iso_fault *fault)
{
    const int error = iso_heads_check(iso_key_ring_board(components->ring), fault);
    if (error) {
        return error;
    }
    const struct iso_gallery_version version = iso_gallery_version(components->gallery);
    const uint64_t known = iso_audit_gallery_changes(components->audit, version.gallery);
    if (version.changes < known) {
        return iso_fault_set_code(
            fault, ISO_FAULT_GALLERY_OLD, -ESTALE,
            "%s: an old gallery, the log knows %llu changes more; put the newest in its place",
            components->config.gallery.path, (unsigned long long)(known - version.changes));
    }
    return components->counter
               ? iso_state_counter_check(components->counter, components->config.log.path, fault)
               : 0;
}

int iso_components_open_each_store(struct iso_components *components, struct iso_fault *fault)
{
    place_lockout(components);
    int error = open_ring(components, fault);
    if (!error) {
        look_at_lockout(components);
    }
    error = error ? error : open_gallery(components, fault);
    error = error ? error : iso_components_open_counter(components, fault);
    return error ? error : open_log(components, fault);
}

int iso_components_open_stores(struct iso_components *components, struct iso_fault *fault)
{
    const int error = iso_components_open_each_store(components, fault);
    return error ? error : iso_components_compare_stores(components, fault);
}

int iso_components_rest_door(const struct iso_config *config, const struct iso_times *times,
                             struct iso_fault *fault)
{
    struct iso_door_io *io = NULL;
    int error = new_door(config, times, &io, fault);
    if (!error) {
        error = iso_door_io_reopen(io, &unpowered, fault);
    }
    iso_door_io_close(io);
    return error;
}

int iso_components_load_modules(const struct iso_config *config, struct iso_fault *fault)
{
    int error = iso_sensor_load(config->sensor.backend, fault);
    if (!error && config->seal.counter == ISO_COUNTER_TPM2) {
        error = iso_tpm2_counter_load(fault);
    }
    if (error || config->recognition.intensity == ISO_IMAGE_OFF) {
        return error;
    }
    const int lacking = iso_face_detector_load(fault);
    return lacking == -ENOENT && !*config->recognition.cascade ? 0 : lacking;
}

/* Nothing is open yet. NULL for want of memory; iso_components_close ends it. */
static struct iso_components *new_parts(const struct iso_config *config,
                                        const struct iso_times *times)
{
    struct iso_components *components = calloc(1, sizeof *components);
    if (components) {
        components->config = *config;
        components->times = *times;
    }
    return components;
}

int iso_components_check(const struct iso_config *config, const struct iso_times *times,
                         struct iso_fault *fault)
{
    struct iso_components *components = new_parts(config, times);
    if (!components) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    const int error = open_files(components, fault);
    iso_components_close(components);
    return error;
}

int iso_components_open(const struct iso_config *config, const struct iso_times *times,
                        bool threads, struct iso_components **out, struct iso_fault *fault)
{
    struct iso_components *components = new_parts(config, times);
    if (!components) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    components->threads = threads;
    int error = open_files(components, fault);
    if (!error) {
        error = open_door(components, fault);
    }
    if (!error && threads) {
        error = start_door(components, fault);
    }
    if (!error) {
        error = iso_components_open_stores(components, fault);
    }
    if (error) {
        iso_components_close(components);
        return error;
    }
    *out = components;
    return 0;
}

int iso_components_accept(const struct iso_config *config, const struct iso_times *times, FILE *out,
                          struct iso_fault *fault)
{
    struct iso_fault why;
    struct iso_components *components = new_parts(config, times);
    if (!components) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = open_files(components, fault);
    error = error ? error : iso_components_accept_stores(components, &why, fault);
    if (!error) {
        fprintf(out, "%s\n", why.text[0] ? "accepted and put on record" : "nothing to accept");
    }
    iso_components_close(components);
    return error;
}

static int print_line(void *context, const char *line)
{
    return fprintf(context, "%s\n", line) < 0 ? -EIO : 0;
}

static int print_log(struct iso_components *components, FILE *out, struct iso_fault *fault)
{
    struct iso_audit_report report;
    int error = iso_audit_verify(components->audit, 0, NULL, NULL, &report, fault);
    if (!error && !report.sound) {
        error = iso_fault_set_code(fault, ISO_FAULT_LOG_DAMAGED, -EBADMSG, "%s: %s",
                                   components->config.log.path, report.flaw);
    }
    if (!error && iso_audit_read(components->audit, 1, UINT32_MAX, print_line, out)) {
        error = iso_fault_set(fault, -EIO, "%s: cannot be read", components->config.log.path);
    }
    return error;
}

int iso_components_print_log(const struct iso_config *config, const struct iso_times *times,
                             FILE *out, struct iso_fault *fault)
{
    struct iso_components *components = new_parts(config, times);
    if (!components) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = open_ring(components, fault);
    error = error ? error : open_log(components, fault);
    error = error ? error : print_log(components, out, fault);
    iso_components_close(components);
    return error;
}

void iso_components_close(struct iso_components *components)
{
    if (components) {
        stop_door(components);
        iso_door_io_close(components->door_io);
        iso_cards_free(components->cards);
        if (components->counter) {
            /* Comes to the disk with the last anchor of the log. */
            iso_state_counter_changed(components->counter, ISO_STATE_ADMINISTRATOR);
        }
        iso_audit_close(components->audit);
        iso_journal_free(components->journal);
        iso_state_counter_free(components->counter);
        iso_gallery_close(components->gallery);
        iso_key_ring_close(components->ring);
        iso_pipeline_close(&components->pipeline);
        free(components);
    }
}

static int open_sensor(void *context, struct iso_sensor **out, struct iso_fault *fault)
{
    const struct iso_components *components = context;
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    const size_t n = iso_config_sensor_options(&components->config, options);
    return iso_sensor_open(components->config.sensor.backend, options, n,
                           &components->times.monotonic, out, fault);
}

struct iso_appliance_borrowed iso_components_lend(struct iso_components *components,
                                                  const struct iso_appliance_events *events)
{
    return (struct iso_appliance_borrowed){
        .config = &components->config,
        .times = components->times,
        .sensor = {open_sensor, components},
        .pipeline = components->pipeline,
        .door_io = components->door_io,
        .door = components->door,
        .threads = components->threads,
        .cards = components->cards,
        .ring = components->ring,
        .counter = components->counter,
        .lockout_path = components->lockout_path,
        .gallery = components->gallery,
        .audit = components->audit,
        .events = *events,
    };
}
