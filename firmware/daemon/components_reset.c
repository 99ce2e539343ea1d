/* The factory reset of the stores that a configuration names. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <time.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "firmware/daemon/components.h"
#include "firmware/reset/reset.h"
#include "firmware/reset/reset_button.h"

/* "DIRECTORY/NAME" in the directory of another file. */
static void place_beside(char to[ISO_RESET_PATH_SIZE], const char *path, const char *name)
{
    (void)snprintf(to, ISO_RESET_PATH_SIZE, "%.*s%s", (int)iso__components_directory_length(path),
                   path, name);
}

/* A counter of the state does not begin anew, so it has to be told that the stores do. */
static void place_done(const struct iso_config *config, char done[ISO_RESET_PATH_SIZE])
{
    done[0] = '\0';
    if (config->seal.counter != ISO_COUNTER_NONE) {
        place_beside(done, config->gallery.path, "factory-reset.done");
    }
}

static void place_marker(const struct iso_config *config, char marker[ISO_RESET_PATH_SIZE])
{
    place_beside(marker, config->gallery.path, "factory-reset");
}

static void copy(char to[ISO_RESET_PATH_SIZE], const char *path, const char *end)
{
    (void)snprintf(to, ISO_RESET_PATH_SIZE, "%s%s", path, end);
}

_Static_assert(ISO_CONFIG_TEXT_SIZE + 16 <= ISO_RESET_PATH_SIZE, "a path of a place fits");

static void find_places(const struct iso_config *config, struct iso_reset_places *out)
{
    *out = (struct iso_reset_places){.marker = ""};
    place_marker(config, out->marker);
    place_done(config, out->done);
    if (*config->seal.key) {
        copy(out->keys[0], config->seal.key, "");
    } else {
        copy(out->keys[0], config->gallery.path, ".key");
    }
    copy(out->keys[1], config->reset.credential, "");
    copy(out->keys[2], config->gallery.path, ".keys");
    copy(out->stores[0], config->gallery.path, "");
    copy(out->stores[1], config->log.path, "");
    if (*config->lockout.path) {
        copy(out->stores[2], config->lockout.path, "");
    } else {
        place_beside(out->stores[2], config->log.path, "lockout");
    }
    place_beside(out->stores[3], config->log.path, "settings");
    copy(out->folders[0], config->reset.web, "");
    copy(out->folders[1], config->reset.link, "");
}

int iso_components_check_reset(const struct iso_config *config, struct iso_fault *fault)
{
    char marker[ISO_RESET_PATH_SIZE];
    place_marker(config, marker);
    return iso_reset_is_pending(marker)
               ? iso_fault_set(
                     fault, -EBUSY,
                     "%.200s: a factory reset was begun; isothermd --finish-reset ends it", marker)
               : 0;
}

bool iso_components_was_reset(const struct iso_config *config)
{
    char done[ISO_RESET_PATH_SIZE];
    place_done(config, done);
    return *done && access(done, F_OK) == 0;
}

void iso_components_forget_reset(const struct iso_config *config)
{
    char done[ISO_RESET_PATH_SIZE];
    place_done(config, done);
    if (*done) {
        (void)unlink(done);
    }
}

/* Takes the lock that a daemon holds while it runs (audit.c). *fd: -1 if there is no log, and
 * therefore no daemon. */
static int lock_log(const char *path, int *fd, struct iso_fault *fault)
{
    *fd = -1;
    const int error = iso_file_open(path, O_RDWR, ISO_FILE_ANY_SIZE, fd, fault);
    if (error) {
        return error == -ENOENT ? 0 : error;
    }
    if (flock(*fd, LOCK_EX | LOCK_NB)) {
        (void)close(*fd);
        *fd = -1;
        return iso_fault_set_code(fault, ISO_FAULT_STORE_BUSY, -EBUSY,
                                  "%s: a daemon runs: stop it first", path);
    }
    return 0;
}

int iso_components_reset(const struct iso_config *config, FILE *out, struct iso_fault *fault)
{
    struct iso_reset_places places;
    int lock = -1;
    find_places(config, &places);
    int error = lock_log(config->log.path, &lock, fault);
    if (!error && !iso_reset_is_pending(places.marker)) {
        error = iso_reset_begin(&places, fault);
    }
    if (!error) {
        error = iso_reset_finish(&places, fault);
    }
    if (lock >= 0) {
        (void)close(lock);
    }
    if (!error) {
        fputs("the appliance is reset: it knows nobody, and its log is empty\n", out);
    }
    return error;
}

static void wait_a_moment(void *context, int64_t ns)
{
    const struct timespec time = {.tv_nsec = ns};
    (void)context;
    (void)nanosleep(&time, NULL);
}

static bool is_button_held(const struct iso_config *config, const struct iso_times *times,
                           struct iso_fault *remark)
{
    const struct iso_reset_button button = {
        .line = config->reset.button, .clock = times->monotonic, .wait = wait_a_moment};
    bool held = false;
    return *config->reset.button && iso_reset_button_read(&button, &held, remark) == 0 && held;
}

int iso_components_finish_reset(const struct iso_config *config, const struct iso_times *times,
                                FILE *out, struct iso_fault *remark, struct iso_fault *fault)
{
    char marker[ISO_RESET_PATH_SIZE];
    place_marker(config, marker);
    /* A button that is still held, or stuck, after a reset must not keep the unit from its start.
     */
    const bool is_used = access(config->gallery.path, F_OK) == 0;
    const bool wanted = iso_reset_is_pending(marker) ||
                        (is_used && is_button_held(config, times, remark));
    const int error = wanted ? iso_components_reset(config, out, fault) : 0;
    return error ? error : wanted;
}
