/* The file of an update: its parts, and its digest. */
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "drivers/file/disk_room.h"
#include "drivers/file/file.h"
#include "firmware/fleet/update/update_inner.h"

enum {
    BUSY_S = 5,         /* between two looks whether the door is free again */
    PART_TIME_S = 600,  /* for one part */
    FAILURES_MOST = 20, /* in a row; about an hour and a half */
    BACKOFF_BASE_MS = 2000,
    BACKOFF_CAP_MS = 600000,
    COPY_BYTES = 1 << 13,
    CHECK_BYTES = 1 << 20, /* that are read in one turn of the event loop */
    STATUS_OK = 200,
    STATUS_FORBIDDEN = 403,
};

void link_update_fetch_end(struct link_update *u)
{
    link_http_cancel(u->request);
    u->request = NULL;
    if (u->fd >= 0) {
        (void)close(u->fd);
    }
    u->fd = -1;
}

/* Whether the disk has room for the rest of the file. */
static bool has_room(const struct link_update *u)
{
    return iso_disk_room(u->file) >= u->order.size - u->have;
}

/* Others may use the room for a time. */
static void refuse_for_room(struct link_update *u)
{
    const bool is_too_small = iso_disk_size(u->file) < u->order.size;

    link_update_refused(u, is_too_small ? "too-small" : "no-room",
                        is_too_small ? "the disk is too small for the update"
                                     : "the disk has no room for the update");
}

/* RAUC makes root the owner of a file that it reads, so that nobody changes it meanwhile; then it
 * has to be fetched again. */
static int open_part(struct link_update *u, struct iso_fault *fault)
{
    return iso_file_open(u->file, O_RDWR | O_CREAT, ISO_FLEET_UPDATE_BYTES_MAX, &u->fd, fault);
}

bool link_update_has_file(const struct link_update *u)
{
    struct stat file;
    int fd = -1;

    if (iso_file_open(u->file, O_RDWR, ISO_FLEET_UPDATE_BYTES_MAX, &fd, NULL) < 0) {
        return false;
    }
    const bool is_whole = fstat(fd, &file) == 0 && (uint64_t)file.st_size == u->order.size;
    (void)close(fd);
    return is_whole;
}

void link_update_fetch_begin(struct link_update *u)
{
    struct iso_fault fault = {.text = ""};
    struct stat file;

    link_update_fetch_end(u);
    int r = open_part(u, &fault);
    if (r < 0 && unlink(u->file) == 0) {
        r = open_part(u, &fault);
    }
    if (r < 0) {
        link_update_refused(u, "disk", fault.text);
        return;
    }
    u->have = fstat(u->fd, &file) == 0 ? (uint64_t)file.st_size : 0;
    if (u->have > u->order.size) {
        r = ftruncate(u->fd, 0);
        u->have = 0;
    }
    if (r < 0 || !has_room(u)) {
        refuse_for_room(u);
        return;
    }
    u->backoff = (struct link_backoff){.base_ms = BACKOFF_BASE_MS, .cap_ms = BACKOFF_CAP_MS};
    u->step = LINK_UPDATE_FETCH;
    link_update_in(u, 0);
}

/* Asks for the part again later. A hub that is away orders the update again when it is back; one
 * that orders it and gives no part of it refuses it. */
static void again(struct link_update *u, const char *why)
{
    char fault[ISO_FLEET_UPDATE_FAULT_SIZE];
    uint64_t random;

    if (u->backoff.failures + 1 >= FAILURES_MOST) {
        (void)snprintf(fault, sizeof fault, "it could not be fetched: %.150s", why);
        if (link_update_now_us(u) < u->holds_until_us) {
            link_update_refused(u, "not-fetched", fault);
        } else {
            link_update_note(u, fault);
            link_update_cancel(u, true);
        }
        return;
    }
    link_update_note(u, why);
    randombytes_buf(&random, sizeof random);
    link_update_in(u, link_backoff_next_us(&u->backoff, random));
}

/* Appends a reply to the file. */
static int append(struct link_update *u, int from, uint64_t size)
{
    uint8_t piece[COPY_BYTES];

    for (uint64_t at = 0; at < size;) {
        const ssize_t n = pread(from, piece, sizeof piece, (off_t)at);
        if (n <= 0) {
            return n < 0 ? -errno : -EIO;
        }
        for (ssize_t done = 0; done < n;) {
            const ssize_t w = pwrite(u->fd, piece + done, (size_t)(n - done),
                                     (off_t)(u->have + at) + done);
            if (w < 0 && errno != EINTR) {
                return -errno;
            }
            done += w > 0 ? w : 0;
        }
        at += (uint64_t)n;
    }
    return 0;
}

static void take_part(struct link_update *u, const struct link_http_reply *reply)
{
    if (reply->size == 0 || reply->size > u->order.size - u->have) {
        again(u, "the hub has another file than it has ordered");
        return;
    }
    /* Others may have filled the disk meanwhile, and the log needs it. */
    const int r = has_room(u) ? append(u, reply->fd, reply->size) : -ENOSPC;
    if (r == -ENOSPC || r == -EDQUOT) {
        refuse_for_room(u);
        return;
    }
    if (r < 0) {
        struct iso_fault fault = {.text = ""};
        (void)iso_file_fault(u->file, r, &fault);
        again(u, fault.text);
        return;
    }
    u->have += reply->size;
    link_backoff_reset(&u->backoff);
    link_update_tell(u);
    link_update_in(u, 0);
}

static void on_reply(void *context, const struct link_http_reply *reply)
{
    struct link_update *u = context;
    char why[160];

    u->request = NULL;
    if (reply->error == 0 && reply->status == STATUS_OK) {
        take_part(u, reply);
    } else if (reply->error == 0 && reply->status == STATUS_FORBIDDEN) {
        link_update_note(u, "the hub does not order the update any more");
        link_update_cancel(u, false);
    } else {
        (void)snprintf(why, sizeof why, "%.120s (status %d)",
                       reply->error ? reply->why : "the hub refuses a part of the update",
                       reply->status);
        again(u, why);
    }
    if (reply->fd >= 0) {
        (void)close(reply->fd);
    }
}

static int post(struct link_update *u, struct iso_fault *fault)
{
    struct iso_fleet_bytes body = {.bytes = NULL};
    char url[512];
    int r = u->setup.daemon.fetch_update(u->setup.daemon.context, &u->order.rollout, u->have, &body,
                                         fault);

    if (r < 0) {
        return r;
    }
    (void)snprintf(url, sizeof url, "%s/fleet/v1/fetch", u->setup.hub_url);
    const struct link_http_setup setup = {.url = url,
                                          .ca_file = u->setup.ca_file,
                                          .type = "application/octet-stream",
                                          .body = body.bytes,
                                          .size = body.size,
                                          .most_bytes = ISO_FLEET_UPDATE_PART_BYTES,
                                          .time_s = PART_TIME_S,
                                          .folder = u->setup.folder};
    r = link_http_post(u->setup.http, &setup, on_reply, u, &u->request, fault);
    iso_fleet_bytes_free(&body);
    return r;
}

/* The line belongs to the door while somebody is there. */
void link_update_fetch_next(struct link_update *u)
{
    struct iso_fault fault = {.text = ""};

    if (u->have == u->order.size) {
        u->step = LINK_UPDATE_CHECK;
        u->have = 0;
        (void)crypto_hash_sha256_init(&u->digest);
        link_update_in(u, 0);
        return;
    }
    if (u->busy) {
        link_update_tell(u);
        link_update_in(u, BUSY_S * LINK_UPDATE_S_US);
        return;
    }
    if (post(u, &fault) < 0) {
        again(u, fault.text);
    }
}

static void finish_check(struct link_update *u)
{
    uint8_t digest[32];

    (void)crypto_hash_sha256_final(&u->digest, digest);
    if (memcmp(digest, u->order.sha256, sizeof digest) != 0) {
        link_update_refused(u, "damaged", "the file is not the one that the hub has ordered");
        return;
    }
    if (fsync(u->fd)) {
        link_update_refused(u, "disk", "the disk has not stored the file");
        return;
    }
    link_update_fetch_end(u);
    u->step = LINK_UPDATE_INSTALL;
    u->handed_us = 0;
    link_update_in(u, 0);
}

void link_update_check_next(struct link_update *u)
{
    uint8_t piece[COPY_BYTES];

    for (size_t read = 0; read < CHECK_BYTES && u->have < u->order.size;) {
        const ssize_t n = pread(u->fd, piece, sizeof piece, (off_t)u->have);
        if (n <= 0) {
            link_update_refused(u, "damaged", "the file cannot be read again");
            return;
        }
        (void)crypto_hash_sha256_update(&u->digest, piece, (unsigned long long)n);
        u->have += (uint64_t)n;
        read += (size_t)n;
    }
    if (u->have < u->order.size) {
        link_update_in(u, 0);
    } else {
        finish_check(u);
    }
}
