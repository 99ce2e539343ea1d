/* The parts of an update at a door (update.h), for its own sources. */
#ifndef ISO_FIRMWARE_FLEET_UPDATE_UPDATE_INNER_H
#define ISO_FIRMWARE_FLEET_UPDATE_UPDATE_INNER_H

#include <limits.h>
#include <sodium.h>
#include <sys/types.h>

#include "firmware/fleet/link/link_backoff.h"
#include "firmware/fleet/update/update.h"

#define LINK_UPDATE_S_US UINT64_C(1000000)

enum { LINK_UPDATE_QUIET_LOOK_S = 5 }; /* between two looks whether somebody is at the door */

enum link_update_step {
    LINK_UPDATE_LOOK,
    LINK_UPDATE_OFF,
    LINK_UPDATE_IDLE,
    LINK_UPDATE_WAIT,
    LINK_UPDATE_FETCH,
    LINK_UPDATE_CHECK,
    LINK_UPDATE_INSTALL,
    LINK_UPDATE_INSTALLED,
};

/* What became of the last rollout; update.record. */
struct link_update_record {
    struct iso_fleet_id rollout; /* zeros: none */
    char version[ISO_FLEET_UPDATE_WORD_SIZE];
    uint8_t sha256[32]; /* of the file that is in bundle.part, or was */
    enum iso_fleet_update_state state;
    char fault[ISO_FLEET_UPDATE_FAULT_SIZE];
};

/* What `isotherm update --json` says. */
struct link_update_slots {
    char version[ISO_FLEET_UPDATE_WORD_SIZE], board[ISO_FLEET_UPDATE_WORD_SIZE];
    bool good;    /* the running version has passed its checks */
    bool waiting; /* the other slot starts next */
};

/* Tells one content of the result file from another; zeros: there is none. */
struct link_update_stamp {
    ino_t inode;
    struct timespec changed;
};

/* A program that runs, and what it prints. */
struct link_update_child {
    pid_t pid; /* 0: none */
    int pid_fd, out_fd;
    sd_event_source *source;
};

struct link_update {
    struct link_update_setup setup; /* its texts belong to the object */
    char file[PATH_MAX], bundle[PATH_MAX], restart_file[PATH_MAX], record_file[PATH_MAX];
    sd_event_source *timer;
    enum link_update_step step;
    struct link_update_slots slots;
    struct link_update_record record;
    struct iso_fleet_update_report report;
    struct iso_fleet_update order;
    bool holds;                     /* the order */
    bool comes;                     /* it has come since the last answer */
    uint64_t holds_until_us;        /* without answers; the machine does not restart later */
    bool busy;                      /* somebody is at the door */
    uint64_t quiet_since_us;        /* 0: not quiet */
    uint64_t handed_us;             /* when the image was given the file; 0: not yet */
    struct link_update_stamp stamp; /* of the result file at that time */
    struct link_update_child child;
    struct link_http_request *request;
    int fd;        /* of the file; -1 */
    uint64_t have; /* bytes of it, or how many are checked */
    crypto_hash_sha256_state digest;
    struct link_backoff backoff;
};

/* ---- update.c ---- */

void link_update_note(const struct link_update *u, const char *line);

/* Acts again after this time. */
void link_update_in(struct link_update *u, uint64_t delay_us);
uint64_t link_update_now_us(const struct link_update *u);

/* Sets the state of the record, stores it, and tells the daemon. */
void link_update_set(struct link_update *u, enum iso_fleet_update_state state, const char *fault);

/* Tells the daemon, and learns whether somebody is at the door. */
void link_update_tell(struct link_update *u);

/* Ends what is under way: the order cannot be carried out. */
void link_update_fail(struct link_update *u, const char *fault);

/* Ends what is under way, without a failure. */
void link_update_cancel(struct link_update *u);

/* ---- update_fetch.c ---- */

void link_update_fetch_begin(struct link_update *u);
void link_update_fetch_next(struct link_update *u); /* step FETCH */
void link_update_check_next(struct link_update *u); /* step CHECK */
void link_update_fetch_end(struct link_update *u);  /* closes everything; the file stays */

/* ---- update_hand_over.c ---- */

/* Goes on waiting for the image after a restart of the link. False: it has no file of ours. */
bool link_update_is_handed_over(struct link_update *u);

/* Gives the image the file, or looks whether it has taken it; step INSTALL. */
void link_update_install(struct link_update *u);

/* Reads the result file: `why` is "" if the image has installed the file, or the reason why not.
 * -EBADMSG: it is not about a file of the hub. */
int link_update_result_read(const char *path, char why[ISO_FLEET_UPDATE_FAULT_SIZE])
    __attribute__((warn_unused_result));

/* ---- update_restart.c ---- */

void link_update_wait(struct link_update *u); /* step INSTALLED */

/* ---- update_program.c ---- */

/* Starts `PROGRAM update --json`. `on_end` is called from the event loop when it has ended, and
 * calls link_update_ended(). */
int link_update_run(struct link_update *u,
                    int (*on_end)(sd_event_source *source, int fd, uint32_t events, void *context));

/* The exit code of the program that has ended and what it has printed, cut to fit; 255: it was
 * killed. */
int link_update_ended(struct link_update *u, char *text, size_t size);
void link_update_child_free(struct link_update_child *child);

/* Reads what `isotherm update --json` has printed. -EBADMSG. */
int link_update_slots_read(const char *text, struct link_update_slots *out)
    __attribute__((warn_unused_result));

/* ---- update_record.c ---- */

/* A file that is missing or damaged is as none. */
void link_update_record_read(const char *path, struct link_update_record *out);
int link_update_record_write(const char *path, const struct link_update_record *record,
                             struct iso_fault *fault) __attribute__((warn_unused_result));

#endif
