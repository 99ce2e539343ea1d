/* The image, which installs a complete file: it is given the file by a rename, removes it in any
 * case, and says in the result file what became of it (board/image/programs/install-update). */
#include <errno.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/data_file.h"
#include "firmware/fleet/update/update_inner.h"

enum {
    LOOK_S = 2,
    MOST_S = 2 * 3600, /* the unit of the image ends after an hour */
    RESULT_BYTES_MAX = 8192,
};

static struct link_update_stamp stamp_of(const char *path)
{
    struct stat file;

    return stat(path, &file) == 0
               ? (struct link_update_stamp){.inode = file.st_ino, .changed = file.st_ctim}
               : (struct link_update_stamp){.inode = 0};
}

static bool is_same(const struct link_update_stamp *a, const struct link_update_stamp *b)
{
    return a->inode == b->inode && a->changed.tv_sec == b->changed.tv_sec &&
           a->changed.tv_nsec == b->changed.tv_nsec;
}

/* Whether the image has still to take the file, or has not done with it. */
static bool is_with_image(const struct link_update *u)
{
    return access(u->bundle, F_OK) == 0 || access(u->setup.taken_file, F_OK) == 0;
}

static void begin_to_wait(struct link_update *u)
{
    u->stamp = stamp_of(u->setup.result_file);
    u->handed_us = link_update_now_us(u);
}

bool link_update_is_handed_over(struct link_update *u)
{
    if (!is_with_image(u)) {
        return false;
    }
    begin_to_wait(u);
    return true;
}

int link_update_result_read(const char *path, char why[ISO_FLEET_UPDATE_FAULT_SIZE])
{
    void *bytes = NULL;
    size_t size = 0;
    const char *from = NULL, *message = NULL;
    int installed = 0;

    if (iso_data_file_read(path, RESULT_BYTES_MAX, &bytes, &size, NULL) < 0) {
        return -EBADMSG;
    }
    json_t *json = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, NULL);
    free(bytes);
    const bool is_read = json_unpack(json, "{s:s, s:{s?b, s?{s:s}}}", "from", &from, "result",
                                     "installed", &installed, "error", "message", &message) == 0 &&
                         strcmp(from, "hub") == 0 && (installed || message);
    if (is_read) {
        (void)snprintf(why, ISO_FLEET_UPDATE_FAULT_SIZE, "%s", installed ? "" : message);
    }
    json_decref(json);
    return is_read ? 0 : -EBADMSG;
}

/* The image has done with the file. */
static void take_result(struct link_update *u)
{
    const struct link_update_stamp now = stamp_of(u->setup.result_file);
    char why[ISO_FLEET_UPDATE_FAULT_SIZE];

    if (is_same(&now, &u->stamp) || link_update_result_read(u->setup.result_file, why) < 0) {
        link_update_fail(u, "the image has not said what became of the update");
    } else if (*why) {
        link_update_fail(u, why);
    } else {
        link_update_set(u, ISO_FLEET_UPDATE_INSTALLED, "");
        u->step = LINK_UPDATE_LOOK;
        link_update_in(u, 0);
    }
}

static void hand_over(struct link_update *u)
{
    begin_to_wait(u);
    if (rename(u->file, u->bundle) < 0) {
        link_update_fail(u, "the file of the update cannot be renamed");
        return;
    }
    link_update_in(u, LOOK_S * LINK_UPDATE_S_US);
}

void link_update_install(struct link_update *u)
{
    if (!u->handed_us) {
        hand_over(u);
    } else if (!is_with_image(u)) {
        take_result(u);
    } else if (link_update_now_us(u) - u->handed_us > MOST_S * LINK_UPDATE_S_US) {
        (void)unlink(u->bundle);
        link_update_fail(u, "the image does not take the update");
    } else {
        link_update_in(u, LOOK_S * LINK_UPDATE_S_US);
    }
}
