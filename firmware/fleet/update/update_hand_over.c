/* The image, which installs a complete file: it is given the file under a second name, removes this
 * name in any case, and says in the result file what became of it
 * (board/image/programs/install-update). The first name stays, so that a file that was refused for
 * a time needs not be fetched again. */
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
    return access(u->bundle, F_OK) == 0 || access(u->taken_file, F_OK) == 0;
}

bool link_update_is_handed_over(struct link_update *u)
{
    if (!is_with_image(u)) {
        return false;
    }
    u->handed_us = link_update_now_us(u);
    return true;
}

int link_update_result_read(const char *path, struct link_update_result *out)
{
    struct link_update_result read = {.code = ""};
    void *bytes = NULL;
    size_t size = 0;
    const char *from = NULL, *code = "", *message = NULL;
    int installed = 0;

    if (iso_data_file_read(path, RESULT_BYTES_MAX, &bytes, &size, NULL) < 0) {
        return -EBADMSG;
    }
    json_t *json = json_loadb(bytes, size, JSON_REJECT_DUPLICATES, NULL);
    free(bytes);
    const bool is_read = json_unpack(json, "{s:s, s:{s?b, s?{s?s, s:s}}}", "from", &from, "result",
                                     "installed", &installed, "error", "code", &code, "message",
                                     &message) == 0 &&
                         strcmp(from, "hub") == 0 && (installed || message);
    if (is_read) {
        read.installed = installed;
        (void)snprintf(read.code, sizeof read.code, "%s", code);
        (void)snprintf(read.why, sizeof read.why, "%s", installed ? "" : message);
        *out = read;
    }
    json_decref(json);
    return is_read ? 0 : -EBADMSG;
}

void link_update_take_result(struct link_update *u)
{
    const struct link_update_stamp now = stamp_of(u->result_file);
    struct link_update_result result;

    if (is_same(&now, &u->record.stamp) || link_update_result_read(u->result_file, &result) < 0 ||
        result.installed) {
        link_update_refused(u, "no-result", "the image has not said what became of the update");
    } else {
        link_update_refused(u, result.code, result.why);
    }
}

static void hand_over(struct link_update *u)
{
    char why[ISO_FLEET_UPDATE_FAULT_SIZE];

    u->record.stamp = stamp_of(u->result_file);
    u->handed_us = link_update_now_us(u);
    memcpy(why, u->record.fault, sizeof why); /* the last refusal, until it has succeeded */
    link_update_set(u, ISO_FLEET_UPDATE_INSTALLING, why);
    (void)unlink(u->bundle);
    if (link(u->file, u->bundle) < 0) {
        link_update_refused(u, "disk", "the file of the update cannot be given to the image");
        return;
    }
    link_update_in(u, LOOK_S * LINK_UPDATE_S_US);
}

void link_update_install(struct link_update *u)
{
    if (!u->handed_us) {
        hand_over(u);
    } else if (!is_with_image(u)) {
        u->step = LINK_UPDATE_LOOK; /* link_update_settle() */
        link_update_in(u, 0);
    } else if (link_update_now_us(u) - u->handed_us > MOST_S * LINK_UPDATE_S_US) {
        (void)unlink(u->bundle);
        link_update_refused(u, "not-taken", "the image does not take the update");
    } else {
        link_update_in(u, LOOK_S * LINK_UPDATE_S_US);
    }
}
