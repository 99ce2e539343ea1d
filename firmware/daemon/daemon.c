#include "firmware/daemon/daemon.h"

#include <errno.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <syslog.h>
#include <systemd/sd-daemon.h>
#include <systemd/sd-event.h>

#include "drivers/file/file.h"
#include "firmware/bus/bus.h"
#include "firmware/contract/fault_tag.h"
#include "firmware/daemon/components.h"
#include "firmware/daemon/confine.h"
#include "firmware/daemon/life_sign.h"
#include "firmware/daemon/quit_signal.h"
#include "firmware/fleet/message/fleet_id.h"
#include "firmware/keys/stack_wipe.h"

/* A descriptor that wakes up the event loop when it can be read, and has no other effect. */
struct watched_fd {
    int fd;
    sd_event_source *source;
};

/* The first and the longest delay before the daemon connects to a lost bus again. */
static const int64_t bus_retry_ns = 200 * ISO_NS_PER_MS, bus_retry_max_ns = 10 * ISO_NS_PER_S;

struct daemon {
    sd_event *event;
    struct iso_bus *bus;
    struct iso_components *components;
    struct iso_appliance_borrowed lent;
    struct iso_appliance *appliance;
    struct watched_fd sensor, door, panel, reader;
    bool quit;
    void *room;                  /* reserved for iso_confine_calls; NULL after it */
    struct iso_fault unlocked;   /* why memory is not locked; "" if it is */
    struct iso_fault unconfined; /* why the process is not confined; "" if it is */
    bool bus_lost;               /* the log says that the bus is gone */
    int64_t bus_try_ns;          /* when to connect next while the bus is lost */
    int64_t bus_wait_ns;         /* the delay after the next failure */
    struct iso_life_sign *life;  /* NULL: there is no service manager */
    uint64_t watchdog_us;        /* 0: there is no watchdog */
    uint64_t progress;           /* the progress when the watchdog was last notified */
    int64_t fed_ns;              /* the time of that notification */
};

static void on_message(void *context, int priority, const char *text)
{
    (void)context;
    iso_daemon_say(priority, text);
}

/* ---- set-up ---- */

static int fail_at(int error, const char *what, struct iso_fault *fault)
{
    return iso_fault_set(fault, error, "%s: %s", what, strerror(-error));
}

/* SIGXFSZ is ignored, so that a file at its size limit is an error (EFBIG), like a full disk, and
 * does not end the daemon. */
static int prepare_process(struct daemon *daemon, struct iso_fault *fault)
{
    daemon->room = malloc(ISO_CONFINE_CALLS_BYTES);
    if (!daemon->room) {
        return fail_at(-ENOMEM, "start", fault);
    }
    (void)signal(SIGPIPE, SIG_IGN);
    (void)signal(SIGXFSZ, SIG_IGN);
    if (iso_confine_memory(&daemon->unlocked) == 0) {
        daemon->unlocked.text[0] = '\0';
    }
    int r = sd_event_new(&daemon->event);
    if (r >= 0) {
        r = iso_quit_signal_catch(daemon->event, &daemon->quit);
    }
    return r < 0 ? fail_at(r, "event loop", fault) : 0;
}

static void notify_manager(void *context, const char *text)
{
    (void)context;
    (void)sd_notify(0, text);
}

/* The interval between messages to the service manager while the main thread waits for the disk. */
static const int64_t life_tick_ns = 5 * ISO_NS_PER_S;

static int start_life_sign(struct daemon *daemon, struct iso_fault *fault)
{
    if (sd_watchdog_enabled(0, &daemon->watchdog_us) <= 0) {
        daemon->watchdog_us = 0;
    }
    const int64_t quarter_ns = (int64_t)(daemon->watchdog_us / 4) * 1000;
    const struct iso_life_sign_options options = {
        .tick_ns = quarter_ns > 0 && quarter_ns < life_tick_ns ? quarter_ns : life_tick_ns,
        .limit_ns = ISO_LIFE_SIGN_LIMIT_S * ISO_NS_PER_S,
        .watchdog = daemon->watchdog_us > 0,
        .send = notify_manager,
    };
    if (!getenv("NOTIFY_SOCKET")) {
        return 0;
    }
    const int error = iso_life_sign_new(&options, &daemon->life);
    return error ? fail_at(error, "life sign", fault) : 0;
}

/* Reads the id of this boot, by which a lease of a fleet goes on over a restart of the daemon. If
 * it cannot be read, each start counts as a boot of its own. */
static void read_boot_id(uint8_t id[ISO_FLEET_ID_BYTES])
{
    char text[ISO_FLEET_ID_TEXT_SIZE] = "";
    struct iso_fleet_id boot = iso_fleet_id_random();
    FILE *stream = NULL;
    if (iso_file_stream("/proc/sys/kernel/random/boot_id", ISO_FILE_ANY_SIZE, &stream, NULL) == 0) {
        if (fgets(text, sizeof text, stream)) {
            (void)!iso_fleet_id_read(text, &boot);
        }
        (void)fclose(stream);
    }
    memcpy(id, boot.bytes, sizeof boot.bytes);
}

static int start_appliance(struct daemon *daemon, struct iso_fault *fault)
{
    const struct iso_appliance_events events = iso_bus_events(daemon->bus, on_message);
    int error = iso_components_begin_counter(daemon->components, true, fault);
    if (error) {
        return error;
    }
    daemon->lent = iso_components_lend(daemon->components, &events);
    read_boot_id(daemon->lent.boot_id);
    error = iso_appliance_new(&daemon->lent, &daemon->appliance);
    return error ? fail_at(error, "appliance", fault)
                 : iso_appliance_start(daemon->appliance, fault);
}

/* The daemon starts also on a kernel that cannot confine it. It then warns of this when it is
 * ready. */
static int take_confinement(struct daemon *daemon, int error, const struct iso_fault *why,
                            struct iso_fault *fault)
{
    if (error == -ENOSYS || error == -ENOTSUP) {
        daemon->unconfined = *why;
        return 0;
    }
    return error ? iso_fault_set_code(fault, why->code, error, "%s", why->text) : 0;
}

static int confine_files(struct daemon *daemon, const struct iso_config *config,
                         struct iso_fault *fault)
{
    struct iso_fault why = {.text = "not confined, as [process] confine says",
                            .code = ISO_FAULT_NOT_CONFINED};
    const int error = config->process.confine ? iso_confine_files(config, &why) : -ENOTSUP;
    return take_confinement(daemon, error, &why, fault);
}

static int confine_calls(struct daemon *daemon, const struct iso_config *config,
                         struct iso_fault *fault)
{
    struct iso_fault why = {.text = ""};
    if (!config->process.confine) {
        return 0;
    }
    free(daemon->room);
    daemon->room = NULL;
    const int error = iso_confine_calls(&why);
    return take_confinement(daemon, error, &why, fault);
}

static void say_fault(const struct iso_fault *fault)
{
    char line[sizeof fault->text + ISO_FAULT_TAG_SIZE], tag[ISO_FAULT_TAG_SIZE];
    if (fault->text[0]) {
        (void)snprintf(line, sizeof line, "%s%s", fault->text, iso_fault_tag(fault->code, tag));
        iso_daemon_say(LOG_WARNING, line);
    }
}

static void say_what_is_open(const struct daemon *daemon)
{
    say_fault(&daemon->unlocked);
    say_fault(&daemon->unconfined);
}

static int set_up(struct daemon *daemon, const struct iso_config *config, struct iso_fault *fault)
{
    const struct iso_times times = iso_times_system();
    int error = prepare_process(daemon, fault);
    if (!error) {
        error = iso_components_load_modules(config, fault);
    }
    if (!error) {
        error = confine_files(daemon, config, fault);
    }
    if (!error) {
        error = iso_bus_check_address(config->bus.address, fault);
    }
    if (!error) {
        error = start_life_sign(daemon, fault);
    }
    if (!error) {
        error = iso_components_open(config, &times, true, &daemon->components, fault);
    }
    if (!error) {
        error = iso_bus_open(config->bus.address, &daemon->bus, fault);
    }
    if (!error) {
        error = start_appliance(daemon, fault);
    }
    if (!error) {
        error = iso_bus_serve(daemon->bus, daemon->appliance, &daemon->lent, daemon->event, fault);
    }
    if (!error) {
        error = confine_calls(daemon, config, fault);
    }
    return error;
}

/* ---- event loop ---- */

static int on_readable(sd_event_source *source, int fd, uint32_t events, void *context)
{
    (void)source;
    (void)fd;
    (void)events;
    (void)context;
    return 0;
}

/* -EAGAIN: the descriptor is the same and is not watched for now. */
static void watch_fd(struct daemon *daemon, struct watched_fd *watched, int fd)
{
    const bool same = fd == watched->fd || fd == -EAGAIN;
    if (same && watched->source) {
        (void)sd_event_source_set_enabled(watched->source, fd >= 0 ? SD_EVENT_ON : SD_EVENT_OFF);
        return;
    }
    watched->source = sd_event_source_disable_unref(watched->source);
    watched->fd = fd;
    if (fd >= 0) {
        (void)sd_event_add_io(daemon->event, &watched->source, fd, EPOLLIN, on_readable, NULL);
    }
}

static void tell_service_manager(struct daemon *daemon, int64_t now_ns)
{
    const uint64_t progress = iso_appliance_progress(daemon->appliance);
    const int64_t period_ns = (int64_t)(daemon->watchdog_us / 4) * 1000;
    if (daemon->watchdog_us && progress != daemon->progress &&
        now_ns - daemon->fed_ns >= period_ns) {
        (void)sd_notify(0, "WATCHDOG=1");
        iso_life_sign_renew(daemon->life);
        daemon->progress = progress;
        daemon->fed_ns = now_ns;
    }
}

/* Connects again if the bus is lost. The door works without the bus meanwhile. Returns the time of
 * the next attempt. */
static int64_t mend_bus(struct daemon *daemon, int64_t now_ns)
{
    struct iso_fault fault = {.text = ""};
    if (!iso_bus_is_gone(daemon->bus)) {
        if (daemon->bus_lost && iso_bus_is_serving(daemon->bus)) {
            iso_daemon_say(LOG_NOTICE, "the bus is back");
            daemon->bus_lost = false;
        }
        return ISO_NEVER_NS;
    }
    if (!daemon->bus_lost) {
        iso_daemon_say(LOG_ERR, "the bus is gone");
        daemon->bus_lost = true;
        daemon->bus_try_ns = now_ns;
        daemon->bus_wait_ns = bus_retry_ns;
    }
    if (now_ns >= daemon->bus_try_ns) {
        if (iso_bus_mend(daemon->bus, &fault)) {
            fault.text[0] = '\0'; /* the log already says that the bus is gone */
        }
        daemon->bus_try_ns = now_ns + daemon->bus_wait_ns;
        daemon->bus_wait_ns = 2 * daemon->bus_wait_ns < bus_retry_max_ns ? 2 * daemon->bus_wait_ns
                                                                         : bus_retry_max_ns;
    }
    return daemon->bus_try_ns;
}

/* Waits for an event, or until the appliance has something to do. */
static int wait_until(struct daemon *daemon, int64_t wake_ns, struct iso_fault *fault)
{
    const int64_t now_ns = iso_times_now_ns(&daemon->components->times);
    uint64_t timeout_us = UINT64_MAX;
    if (wake_ns != ISO_NEVER_NS) {
        timeout_us = wake_ns > now_ns ? (uint64_t)(wake_ns - now_ns + 999) / 1000 : 0;
    }
    const int r = sd_event_run(daemon->event, timeout_us);
    return r < 0 && r != -EINTR ? fail_at(r, "event loop", fault) : 0;
}

static int run_loop(struct daemon *daemon, struct iso_fault *fault)
{
    while (!daemon->quit) {
        const int64_t step_ns = iso_appliance_step(daemon->appliance);
        const int64_t mend_ns = mend_bus(daemon, iso_times_now_ns(&daemon->components->times));
        watch_fd(daemon, &daemon->sensor, iso_appliance_sensor_fd(daemon->appliance));
        watch_fd(daemon, &daemon->door, iso_appliance_door_fd(daemon->appliance));
        watch_fd(daemon, &daemon->panel, iso_appliance_panel_fd(daemon->appliance));
        watch_fd(daemon, &daemon->reader, iso_appliance_reader_fd(daemon->appliance));
        tell_service_manager(daemon, iso_times_now_ns(&daemon->components->times));
        const int error = wait_until(daemon, step_ns < mend_ns ? step_ns : mend_ns, fault);
        iso_stack_wipe();
        if (error) {
            return error;
        }
    }
    return 0;
}

static void warn_of_key(const struct iso_config *config, const struct iso_components *components)
{
    if (!iso_key_ring_has_credential(components->ring) && !*config->seal.key) {
        iso_daemon_say(LOG_WARNING, "the key is stored next to the gallery; anyone who copies both "
                                    "can read it: see KEYS in isothermd(8)");
    }
}

static void warn_of_reader(const struct iso_config *config)
{
    if (*config->reader.osdp_port && !*config->reader.osdp_key) {
        iso_daemon_say(LOG_WARNING, "[reader] osdp_key is empty: anyone on the wire of the card "
                                    "reader can read and forge cards and keys");
    }
}

static void tear_down(struct daemon *daemon)
{
    if (daemon->appliance) {
        iso_appliance_stop(daemon->appliance);
    }
    watch_fd(daemon, &daemon->sensor, -1);
    watch_fd(daemon, &daemon->door, -1);
    watch_fd(daemon, &daemon->panel, -1);
    watch_fd(daemon, &daemon->reader, -1);
    iso_bus_close(daemon->bus);
    iso_appliance_free(daemon->appliance);
    iso_components_close(daemon->components);
    iso_life_sign_free(daemon->life);
    sd_event_unref(daemon->event);
    free(daemon->room);
    iso_quit_signal_release();
}

int iso_daemon_check(const struct iso_config *config, struct iso_fault *fault)
{
    const struct iso_times times = iso_times_system();
    int error = iso_components_load_modules(config, fault);
    if (!error) {
        error = iso_bus_check_address(config->bus.address, fault);
    }
    return error ? error : iso_components_check(config, &times, fault);
}

int iso_daemon_run(const struct iso_config *config, struct iso_fault *fault)
{
    struct daemon daemon = {.sensor.fd = -1, .door.fd = -1, .panel.fd = -1, .reader.fd = -1};
    int error = set_up(&daemon, config, fault);
    if (!error) {
        warn_of_key(config, daemon.components);
        warn_of_reader(config);
        say_what_is_open(&daemon);
        iso_daemon_say(LOG_INFO, "ready");
        iso_life_sign_enter(daemon.life, ISO_LIFE_RUNNING);
        (void)sd_notify(0, "READY=1\nSTATUS=Watching the door");
        error = run_loop(&daemon, fault);
        (void)sd_notify(0, "STOPPING=1");
        iso_life_sign_enter(daemon.life, ISO_LIFE_STOPPING);
    }
    tear_down(&daemon);
    return error;
}
