#include "firmware/daemon/components.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "drivers/base/shipped.h"
#include "drivers/counter/tpm2_counter.h"
#include "drivers/vision/face_detector.h"
#include "firmware/config/door_options.h"
#include "firmware/policy/zones/zone_file.h"
#include "firmware/reset/reset_button.h"

static const char *or_shipped(const char *path, const char *shipped)
{
    return *path ? path : shipped;
}

/* The file with the trained data of a method: the one that [model] names, or the installed one. */
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

int iso_components_open_pipeline(struct iso_components *components, struct iso_fault *fault)
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

/* Whether an error may go away by itself: a chip is plugged in later, udev sets the permissions,
 * another process releases the line. */
static bool is_passing_error(int error)
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

/* Opens everything that needs neither a device nor a store. */
static int open_files(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_config *config = &components->config;
    int error = iso_components_open_pipeline(components, fault);
    if (!error && *config->door.cards) {
        error = iso_cards_load(config->door.cards, &components->cards, fault);
    }
    if (!error) {
        error = check_sensor(config, fault);
    }
    if (!error) {
        error = check_door(config, fault);
    }
    if (!error) {
        error = iso_components_check_counter(config, fault);
    }
    if (!error) {
        error = iso_components_check_reader(config, fault);
    }
    if (!error && *config->reset.button) {
        error = iso_reset_button_check(config->reset.button, fault);
    }
    return error ? error : iso_components_check_places(config, fault);
}

static int new_door(const struct iso_config *config, const struct iso_times *times,
                    struct iso_door_io **out, struct iso_fault *fault)
{
    struct iso_option options[ISO_CONFIG_OPTIONS_MAX];
    const size_t n = iso_config_door_options(config, options);
    return iso_door_io_new(config->door.backend, options, n, &times->monotonic, out, fault);
}

static const struct iso_door_outputs unpowered;

/* Missing lines do not prevent the daemon from starting. The door is at fault until they appear. */
static int open_door(struct iso_components *components, struct iso_fault *fault)
{
    int error = new_door(&components->config, &components->times, &components->door_io, fault);
    if (!error) {
        error = iso_door_io_reopen(components->door_io, &unpowered, fault);
    }
    return is_passing_error(error) ? 0 : error;
}

static int start_door(struct iso_components *components, struct iso_fault *fault)
{
    const struct iso_door_guard_options options = iso_door_options_of(
        &components->config.door, &components->times, components->door_io, true);
    int error = iso_door_guard_new(&options, &components->door);
    if (!error) {
        error = iso_door_guard_start(components->door);
    }
    return error ? iso_fault_set(fault, error, "the door has no thread: %s", strerror(-error)) : 0;
}

static void stop_door(struct iso_components *components)
{
    if (components->door) {
        iso_door_guard_stop(components->door);
        iso_door_guard_free(components->door);
    }
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

struct iso_components *iso_components_new(const struct iso_config *config,
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
    struct iso_components *components = iso_components_new(config, times);
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
    struct iso_components *components = iso_components_new(config, times);
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
    if (!error && threads) {
        error = iso_components_open_panel(components, fault);
    }
    if (!error && threads) {
        error = iso_components_open_reader(components, fault);
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
    struct iso_components *components = iso_components_new(config, times);
    if (!components) {
        return iso_fault_set(fault, -ENOMEM, "out of memory");
    }
    int error = open_files(components, fault);
    if (!error) {
        error = iso_components_accept_stores(components, &why, fault);
    }
    if (!error) {
        fprintf(out, "%s\n", why.text[0] ? "accepted and put on record" : "nothing to accept");
    }
    iso_components_close(components);
    return error;
}

void iso_components_close(struct iso_components *components)
{
    if (components) {
        stop_door(components);
        iso_components_close_reader(components);
        iso_panel_close(components->panel);
        iso_door_io_close(components->door_io);
        iso_cards_free(components->cards);
        if (components->counter) {
            /* The last anchor of the log writes this change to the disk. */
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

static const struct iso_zone_source zones = {iso_zone_file_read, ISO_ZONE_FOLDER};

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
        .panel = components->panel,
        .reader = iso_components_card_source(components),
        .ring = components->ring,
        .counter = components->counter,
        .zones = &zones,
        .settings = &components->settings,
        .lockout_path = components->lockout_path,
        .gallery = components->gallery,
        .audit = components->audit,
        .events = *events,
    };
}
