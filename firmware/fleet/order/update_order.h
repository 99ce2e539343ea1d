/* The hub orders a door to install an update of its image, and the door says how far it is. Pure.
 *
 *   UPDATE  door[16], nonce[16], rollout[16], size u64, SHA-256[32], spread u32, version text,
 * board text
 *
 * UPDATE comes behind the LEASE that answers a QUESTION, as long as the order holds, and repeats
 * the nonce of that QUESTION, so nobody can send an order again that was taken back. A door that
 * gets a LEASE without it stops what it does. The file comes over HTTPS in parts: a FETCH
 * (door_mail.h) with what = ISO_FLEET_WANT_UPDATE names the rollout in place of a zone, and after
 * how many bytes the next part begins. Size and digest say which file is meant. Whether it may be
 * installed is decided at the door, by the signature of the file itself.
 *
 * The report is in the health of each QUESTION (lease.h), in the members that are listed below. The
 * hub sends UPDATE to a door only if it finds a state among them. So a door or a hub of an earlier
 * release, which knows neither UPDATE nor the members, notices nothing. */
#ifndef ISO_FIRMWARE_FLEET_ORDER_UPDATE_ORDER_H
#define ISO_FIRMWARE_FLEET_ORDER_UPDATE_ORDER_H

#include "firmware/fleet/message/envelope.h"
#include "firmware/fleet/message/fleet_id.h"
#include "firmware/fleet/message/lease.h"

enum {
    ISO_FLEET_UPDATE_WORD_SIZE = 64, /* of a version or a board, with its NUL */
    ISO_FLEET_UPDATE_FAULT_SIZE = 192,
    ISO_FLEET_UPDATE_PART_BYTES = 4 << 20, /* of the file in one reply, at most */
};

#define ISO_FLEET_UPDATE_BYTES_MAX (UINT64_C(2) << 30) /* of the file */

struct iso_fleet_update {
    struct iso_fleet_id door;
    uint8_t nonce[ISO_FLEET_NONCE_BYTES]; /* of the QUESTION */
    struct iso_fleet_id rollout;
    uint64_t size; /* of the file: 1 to ISO_FLEET_UPDATE_BYTES_MAX */
    uint8_t sha256[32];
    uint32_t spread_s; /* the door begins after a random part of this time */
    char version[ISO_FLEET_UPDATE_WORD_SIZE], board[ISO_FLEET_UPDATE_WORD_SIZE];
};

/* Whether a text can be a version or a board: 1 to 63 letters, digits and "._+~:-" of ASCII. */
bool iso_fleet_update_word_is_good(const char *text);

/* -ENOMEM. */
int iso_fleet_make_update(const struct iso_fleet_update *update,
                          const struct iso_fleet_signer *signer, struct iso_fleet_bytes *out)
    __attribute__((warn_unused_result));

/* Errors of iso_fleet_verify(); -EBADMSG also a size or a text that is not allowed. */
int iso_fleet_read_update(const void *bytes, size_t size,
                          const uint8_t signer[ISO_FLEET_PUBLIC_BYTES],
                          struct iso_fleet_update *out) __attribute__((warn_unused_result));

/* How far a door is with the rollout that it was told last. */
enum iso_fleet_update_state {
    ISO_FLEET_UPDATE_NONE,       /* this machine takes no updates */
    ISO_FLEET_UPDATE_IDLE,       /* it was told nothing, or what it was told holds no more */
    ISO_FLEET_UPDATE_FETCHING,   /* it waits for its turn, or fetches the file */
    ISO_FLEET_UPDATE_INSTALLING, /* the file is being installed */
    ISO_FLEET_UPDATE_INSTALLED,  /* waits for a quiet moment to restart, or is being checked */
    ISO_FLEET_UPDATE_HEALTHY,    /* runs the version, which has passed its checks */
    ISO_FLEET_UPDATE_FAILED,     /* it could not be fetched or installed */
    ISO_FLEET_UPDATE_WENT_BACK,  /* it was started and failed, and the former version runs again */
    ISO_FLEET_UPDATE_STATES
};

/* "none", "idle", ...; and back: -EINVAL. */
const char *iso_fleet_update_state_word(enum iso_fleet_update_state state);
int iso_fleet_update_state_read(const char *word, enum iso_fleet_update_state *out)
    __attribute__((warn_unused_result));

/* What a door says about its image. All zero: nothing is known yet. */
struct iso_fleet_update_report {
    bool is_known; /* its members count */
    enum iso_fleet_update_state state;
    struct iso_fleet_id rollout;                                                 /* zeros: none */
    char version[ISO_FLEET_UPDATE_WORD_SIZE], board[ISO_FLEET_UPDATE_WORD_SIZE]; /* "": no image */
    char fault[ISO_FLEET_UPDATE_FAULT_SIZE]; /* one line for people; "": none */
};

/* Copies a line for people: control characters become '?', also those of C1, and a text that is too
 * long ends with a whole character. What is not valid UTF-8 ends the line. */
void iso_fleet_update_fault_copy(char out[ISO_FLEET_UPDATE_FAULT_SIZE], const char *text);

/* The members of the health. */
#define ISO_FLEET_UPDATE_STATE   "update-state"   /* a word */
#define ISO_FLEET_UPDATE_ROLLOUT "update-rollout" /* the id of the rollout; "": none */
#define ISO_FLEET_UPDATE_FAULT   "update-fault"   /* one line for people; "": none */
#define ISO_FLEET_UPDATE_VERSION "image-version"  /* the version that runs; "": no image */
#define ISO_FLEET_UPDATE_BOARD   "image-board"    /* for which board updates have to be */

#endif
