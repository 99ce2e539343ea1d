/* The machine waits for a quiet moment to restart, or the new version for the end of its checks. */
#include <fcntl.h>
#include <time.h>
#include <unistd.h>

#include "drivers/file/file.h"
#include "firmware/fleet/update/update_inner.h"

static bool is_in_window(const struct link_update *u)
{
    const time_t now = time(NULL);
    struct tm local;

    return u->setup.restart.from == u->setup.restart.until ||
           (localtime_r(&now, &local) && iso_restart_hours_have(&u->setup.restart, local.tm_hour));
}

/* The image restarts the machine when the file is there, and removes it before. */
static void restart(struct link_update *u)
{
    struct iso_fault fault = {.text = ""};
    int fd = -1;

    link_update_note(u, "the machine restarts for an update");
    if (iso_file_open(u->restart_file, O_WRONLY | O_CREAT, ISO_FILE_ANY_SIZE, &fd, &fault)) {
        link_update_note(u, fault.text);
    } else {
        (void)close(fd);
    }
}

void link_update_wait(struct link_update *u)
{
    const uint64_t now = link_update_now_us(u);

    link_update_tell(u);
    if (link_update_is_on_trial(u)) {
        u->step = LINK_UPDATE_LOOK;
        link_update_in(u, 0);
        return;
    }
    u->quiet_since_us = u->busy ? 0 : u->quiet_since_us ? u->quiet_since_us : now;
    if (u->holds && now < u->holds_until_us && u->quiet_since_us &&
        now - u->quiet_since_us >= u->setup.quiet_s * LINK_UPDATE_S_US && is_in_window(u)) {
        restart(u);
        u->quiet_since_us = 0;
    }
    link_update_in(u, LINK_UPDATE_QUIET_LOOK_S * LINK_UPDATE_S_US);
}
