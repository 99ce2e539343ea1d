/* The stores that a configuration names: their places, their opening, and whether their states are
 * of the same time. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <systemd/sd-journal.h>

#include "firmware/daemon/components.h"
#include "firmware/visit/lockout_file.h"

size_t iso__components_directory_length(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? (size_t)(slash + 1 - path) : 0;
}

/* The service manager makes this directory at the start (StateDirectory= of the unit). */
static bool in_state_directory(const char *path)
{
    const struct iso_config standard = iso_config_default();
    const size_t length = iso__components_directory_length(standard.gallery.path);
    return iso__components_directory_length(path) == length &&
           strncmp(path, standard.gallery.path, length) == 0;
}

/* Checks the directory of a file that the daemon creates if it does not exist. */
static int check_place(const char *key, const char *path, struct iso_fault *fault)
{
    char directory[ISO_CONFIG_TEXT_SIZE + 8];
    struct stat status;
    const size_t length = iso__components_directory_length(path);
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

int iso_components_check_places(const struct iso_config *config, struct iso_fault *fault)
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

static int open_ring(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    char ring[ISO_CONFIG_TEXT_SIZE + 8], key[ISO_CONFIG_TEXT_SIZE + 8];
    const int pending = iso_components_check_reset(config, fault);
    if (pending) {
        return pending;
    }
    (void)snprintf(ring, sizeof ring, "%s.keys", config->gallery.path);
    (void)snprintf(key, sizeof key, "%s.key", config->gallery.path);
    const struct iso_key_place place = {
        .ring = ring,
        .file = *config->seal.key ? config->seal.key : key,
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
        .adapt = config->match.adapt,
        .ring = components->ring,
        .migrate = config->seal.migrate,
    };
    return iso_gallery_open(&options, &components->gallery, fault);
}

/* Places the lock-out file next to the audit log if the configuration names no path for it. */
static void place_lockout(struct iso_components *components)
{
    static const char name[] = "lockout";
    const struct iso_config *config = &components->config;
    const size_t length = iso__components_directory_length(config->log.path);
    if (*config->lockout.path) {
        (void)snprintf(components->lockout_path, sizeof components->lockout_path, "%s",
                       config->lockout.path);
    } else {
        (void)snprintf(components->lockout_path, sizeof components->lockout_path, "%.*s%s",
                       (int)length, config->log.path, name);
    }
}

/* Changed settings are always next to the audit log. */
static void place_settings(struct iso_components *components)
{
    const char *log = components->config.log.path;
    (void)snprintf(components->settings_path, sizeof components->settings_path, "%.*ssettings",
                   (int)iso__components_directory_length(log), log);
    iso_live_settings_init(&components->settings, &components->config, components->settings_path,
                           components->ring);
}

/* Reads what the lock-out file knows of the other stores, for the comparison. The appliance decides
 * later whether the file can be used, and lets nobody in if it cannot. */
static void look_at_lockout(const struct iso_components *components)
{
    struct iso_lockout_file file;
    struct iso_fault fault;
    (void)!iso_lockout_load(components->lockout_path, components->ring, &file, &fault);
}

/* After a factory reset the counter is ahead of the new stores. While nobody is enrolled, there is
 * nobody whom an earlier state could bring back. */
static int compare_counter(const struct iso_components *components, struct iso_fault *fault)
{
    struct iso_fault own = {.text = ""};
    size_t people = 0;
    const int error = iso_state_counter_check(components->counter, components->config.log.path,
                                              &own);
    (void)iso_gallery_people(components->gallery, &people);
    if (error == -ESTALE && people == 0 && iso_components_was_reset(&components->config)) {
        return 0;
    }
    return error ? iso_fault_set_code(fault, own.code, error, "%s", own.text) : 0;
}

/* Also detects a gallery that was put back together with its anchor: the log knows of more changes
 * than it has. */
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
    return components->counter ? compare_counter(components, fault) : 0;
}

int iso_components_open_each_store(struct iso_components *components, struct iso_fault *fault)
{
    place_lockout(components);
    int error = open_ring(components, fault);
    if (!error) {
        place_settings(components);
        look_at_lockout(components);
    }
    if (!error) {
        error = open_gallery(components, fault);
    }
    if (!error) {
        error = iso_components_open_counter(components, fault);
    }
    return error ? error : open_log(components, fault);
}

int iso_components_open_stores(struct iso_components *components, struct iso_fault *fault)
{
    const int error = iso_components_open_each_store(components, fault);
    return error ? error : iso_components_compare_stores(components, fault);
}

int iso_components_open_panel(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    char path[ISO_CONFIG_TEXT_SIZE + 8];
    (void)snprintf(path, sizeof path, "%s.panel", config->gallery.path);
    const struct iso_panel_options options = {
        .port = config->panel.port,
        .address = (uint8_t)config->panel.address,
        .baud = iso_config_panel_baud(config),
        .plain = config->panel.plain,
        .card_bits = iso_config_panel_card_bits(config),
        .path = path,
        .ring = components->ring,
        .clock = components->times.monotonic,
    };
    return *config->panel.port ? iso_panel_open(&options, &components->panel, fault) : 0;
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
    struct iso_components *components = iso_components_new(config, times);
    if (!components) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = open_ring(components, fault);
    if (!error) {
        error = open_log(components, fault);
    }
    if (!error) {
        error = print_log(components, out, fault);
    }
    iso_components_close(components);
    return error;
}
