/* The parts of an update at a door (update.h), for its own sources. */
#ifndef ISO_FIRMWARE_FLEET_UPDATE_UPDATE_INNER_H
#define ISO_FIRMWARE_FLEET_UPDATE_UPDATE_INNER_H

#include <limits.h>
#include <sodium.h>
#include <sys/types.h>

#include "firmware/fleet/link/link_backoff.h"
#include "firmware/fleet/update/update.h"

#define LINK_UPDATE_S_US UINT64_C(1000000)

enum {
    LINK_UPDATE_REASONS = 20,        /* for which an order is refused (update_refuse.c) */
    LINK_UPDATE_QUIET_LOOK_S = 5,    /* between two looks whether somebody is at the door */
    LINK_UPDATE_KEEPS_S = 24 * 3600, /* the file of an order that does not come again */
};

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

/* Tells one content of the result file from another; zeros: there is none. */
struct link_update_stamp {
    ino_t inode;
    struct timespec changed;
};

/* What became of the last rollout; update.record. */
struct link_update_record {
    struct iso_fleet_id rollout; /* zeros: none */
    char version[ISO_FLEET_UPDATE_WORD_SIZE];
    char former[ISO_FLEET_UPDATE_WORD_SIZE]; /* that ran when it began; "": not known */
    uint8_t sha256[32];                      /* of the file that is in bundle.part, or was */
    enum iso_fleet_update_state state;
    char fault[ISO_FLEET_UPDATE_FAULT_SIZE];
    unsigned tries[LINK_UPDATE_REASONS]; /* how often it was refused for each reason */
    struct link_update_stamp stamp;      /* of the result file when the image was given the file */
};

/* What `isotherm update --json` says. */
struct link_update_slots {
    char version[ISO_FLEET_UPDATE_WORD_SIZE], board[ISO_FLEET_UPDATE_WORD_SIZE];
    char other[ISO_FLEET_UPDATE_WORD_SIZE]; /* the version of the other slot; "": not known */
    bool good;    /* the running version can be started; it may be on trial */
    bool proven;  /* it has passed its checks: the boot loader does not leave it by itself */
    bool waiting; /* the other slot starts next */
};

/* What the image has said in the result file. */
struct link_update_result {
    bool installed;
    char code[32]; /* of the refusal; "": it has none */
    char why[ISO_FLEET_UPDATE_FAULT_SIZE];
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
    char taken_file[PATH_MAX];  /* the name of the file while the image installs it */
    char result_file[PATH_MAX]; /* what the image has said of the last file of the hub */
    sd_event_source *timer;
    enum link_update_step step;
    struct link_update_slots slots;
    struct link_update_record record;
    struct iso_fleet_update_report report;
    struct iso_fleet_update order;
    bool holds;              /* the order */
    uint64_t holds_until_us; /* without answers; the machine does not restart later */
    unsigned without;        /* answers since it came: the last one may bring it yet */
    bool busy;               /* somebody is at the door */
    uint64_t quiet_since_us; /* 0: not quiet */
    uint64_t handed_us;      /* when the image was given the file; 0: not yet */
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

/* A random part of the time within which the doors of a stage begin to fetch. */
uint64_t link_update_turn_us(const struct link_update *u);
uint64_t link_update_now_us(const struct link_update *u);

/* Sets the state of the record, stores it, and tells the daemon. */
void link_update_set(struct link_update *u, enum iso_fleet_update_state state, const char *fault);

/* Tells the daemon, and learns whether somebody is at the door. */
void link_update_tell(struct link_update *u);

/* Ends what is under way: the order cannot be carried out, and is not tried again. */
void link_update_fail(struct link_update *u, const char *fault);

/* Ends what is under way, without a failure. The order may come again; the file is kept for a day
 * if the hub is only away. */
void link_update_cancel(struct link_update *u, bool keeps_file);

/* ---- update_refuse.c ---- */

/* The number of a reason, less than LINK_UPDATE_REASONS; codes that the table does not have are one
 * reason. */
size_t link_update_reason(const char *code);

/* Its code; NULL: there is no such reason. */
const char *link_update_reason_code(size_t reason);

/* How often an order is tried in all if this is why it is refused: 1 if the same cannot succeed
 * later. The table is in isotherm-link(8), too. */
unsigned link_update_tries(const char *code);

/* Something has refused the order. It is tried again after a time that grows, or has failed. If the
 * file has to be fetched again, the door waits for its turn, too. */
void link_update_refused(struct link_update *u, const char *code, const char *why);

/* ---- update_settle.c ---- */

/* The slots are known: what became of the last rollout. */
void link_update_settle(struct link_update *u);

/* Whether nothing is to be done but to wait for the end of the checks of the running version,
 * whoever has brought it; a part of the step INSTALLED. */
bool link_update_is_on_trial(const struct link_update *u);

/* ---- update_fetch.c ---- */

void link_update_fetch_begin(struct link_update *u);
void link_update_fetch_next(struct link_update *u); /* step FETCH */
void link_update_check_next(struct link_update *u); /* step CHECK */
void link_update_fetch_end(struct link_update *u);  /* closes everything; the file stays */

/* Whether nothing is to be fetched: the file has the size of the order and can be opened. */
bool link_update_has_file(const struct link_update *u);

/* ---- update_hand_over.c ---- */

/* Goes on waiting for the image after a restart of the link. False: it has no file of ours. */
bool link_update_is_handed_over(struct link_update *u);

/* Gives the image the file, or looks whether it has taken it; step INSTALL. */
void link_update_install(struct link_update *u);

/* Takes the result file, if the image has written it since it was given the file, and settles. */
void link_update_take_result(struct link_update *u);

/* Reads the result file. -EBADMSG: there is none, or it is not about a file of the hub. */
int link_update_result_read(const char *path, struct link_update_result *out)
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
